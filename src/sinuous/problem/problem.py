"""The question: a robot, its targets, what stands around, how exactly they must be met; and a first look at it.

A first look says what is proved of the base before anything is tried. Of a robot under load the question is put to its
body, a robot of arcs.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple, Self, TypedDict, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number
from sinuous.base.checks import Floats
from sinuous.base.frozen import Frozen, text
from sinuous.kernels import packing
from sinuous.kernels.packing import read_only
from sinuous.kernels.statics import layout as t
from sinuous.kernels.tables import ROUNDOFF
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Targets, Tolerance, as_tolerance, target_list, target_table
from sinuous.scene.mesh import Mesh
from sinuous.scene.scene import Scene, SceneLike, as_snapshot
from sinuous.scene.snapshot import Snapshot
from sinuous.statics.body import body_of, rolled
from sinuous.statics.equilibrium import Equilibrium


@dataclass(frozen=True, init=False, repr=False)
class Preferences(Frozen):
    """What to like better among all solutions; feasibility comes first, always.

    Parameters
    ----------
    start : float
        Weight of staying close to the start (bends in rad, lengths relative to their mean).
    bends : float
        Weight of small bends.
    clearance : float
        Clearance that is wished for, in the length unit; less than that is disliked.
    """

    start: float
    bends: float
    clearance: float

    def __init__(self, start: Number = 0.0, bends: Number = 0.0, clearance: Number = 0.0) -> None:
        for key, value in (("start", start), ("bends", bends), ("clearance", clearance)):
            self._set(**{key: checks.number(key, value, low=0.0)})

    def __bool__(self) -> bool:
        return self.start > 0.0 or self.bends > 0.0 or self.clearance > 0.0

    def beyond(self, demanded: float) -> Self:
        """Return the same where clearances count from the one that is demanded."""
        if demanded == 0.0 or self.clearance == 0.0:
            return self
        return type(self)(self.start, self.bends, max(0.0, self.clearance - demanded))

    def satisfied(self, clearance: float) -> bool:
        """Say whether a solution with this clearance cannot be better: there is enough, and nothing else is wished."""
        return self.start == self.bends == 0.0 and clearance >= self.clearance


class ProblemArguments(TypedDict, total=False):
    """Arguments of `Problem`."""

    robot: Robot
    targets: Targets
    scene: SceneLike | Snapshot | None
    tolerance: Tolerance | None


class _Open:
    """A problem while it is put together."""

    __slots__ = ("_rows", "robot", "scene", "targets", "tolerance")

    robot: Robot
    _rows: Floats
    scene: Snapshot
    targets: tuple[Target, ...]
    tolerance: Tolerance


class Problem(Frozen, _Open):
    """A robot, the targets to be met at once, a scene and tolerances; frozen.

    Parameters
    ----------
    robot : Robot
    targets : Target or list of Target
    scene : Scene, Snapshot or list of obstacles, optional
    tolerance : Tolerance, optional

    Attributes
    ----------
    robot : Robot
    targets : tuple of Target
    scene : Snapshot
        The obstacles as they were when the problem was made.
    tolerance : Tolerance
        With numbers for all that is not said.
    rows : ndarray (t, 15)
        The targets as kernels read them, read-only.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    __slots__ = ()

    _tables: ClassVar[frozenset[str]] = frozenset({"_rows"})

    def __init__(
        self,
        robot: Robot,
        targets: Targets,
        scene: SceneLike | Snapshot | None = None,
        tolerance: Tolerance | None = None,
    ) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        place = as_snapshot(scene)
        listed = target_list("targets", targets, robot)
        self._set(
            robot=robot,
            scene=place,
            tolerance=as_tolerance(tolerance).for_robot(robot),
            targets=listed,
            _rows=target_table(robot, listed),
        )
        check_sizes(robot, place)

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.robot.segments)} segments"
        yield text(self.targets[0]) if len(self.targets) == 1 else f"{len(self.targets)} targets"
        yield f"{len(self.scene)} obstacles"

    def changed(self, **values: Unpack[ProblemArguments]) -> "Problem":
        """Return the same problem with other values of some parameters."""
        return self._changed(values)

    def _content(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("robot", "targets", "scene", "tolerance")}

    @property
    def rows(self) -> Floats:
        """The targets as kernels read them (t, 15), read-only."""
        return read_only(self._rows)

    @classmethod
    def prepared(cls, robot: Robot, targets: tuple[Target, ...], scene: Snapshot, tolerance: Tolerance) -> "Problem":
        """Put together parts that are checked already: the quick way of a `Solver`."""
        problem: Any = _Open()
        problem.robot = robot
        problem.targets = targets
        problem.scene = scene
        problem.tolerance = tolerance
        problem._rows = target_table(robot, targets)
        problem.__class__ = cls  # closes it; five calls of `object.__setattr__` would cost 0.2 us
        return problem


def check_sizes(robot: Robot, scene: Scene | Snapshot) -> None:
    """Refuse a scene with a mesh that must be in another length unit than the robot, as `Mesh.check_size` says."""
    for i, obstacle in enumerate(scene.obstacles):
        if isinstance(obstacle, Mesh):
            with checks.inside(f"scene[{i}].mesh"):
                obstacle.check_size(robot.mean_length)


def settings_group(
    robot: Robot, tolerance: Tolerance, prefer: Preferences | None = None, options: Sequence[float] | Floats = ()
) -> Floats:
    """Return the settings of a solve as kernels read them, a new array; see `kernels.packing.settings_group`."""
    wishes = Preferences() if prefer is None else prefer.beyond(robot._least_clearances[0])
    return packing.settings_group(
        mount=robot.mount,
        unit=robot.mean_length,
        position_tolerance=tolerance.position,
        angle_tolerance=tolerance.angle,
        start_weight=wishes.start,
        bends_weight=wishes.bends,
        clearance_wish=wishes.clearance,
        options=options,
    )


class BodyQuestion(NamedTuple):
    """A body of arcs at rest, and what is asked of it.

    Attributes
    ----------
    body : Robot
        One segment an arc; where nothing pulls, the robot itself.
    arcs : ndarray (N, 3)
        Its configuration.
    targets : tuple of Target
    owners : sequence of int or str (N)
        Which segment of the robot each arc belongs to, 1 = first; see `Robot.labels`.
    shape : Equilibrium or None
        Under load.
    """

    body: Robot
    arcs: Floats
    targets: tuple[Target, ...]
    owners: Sequence[Any]
    shape: Equilibrium | None = None

    def segment(self, arc: Any) -> Any:
        """Segment of the robot that an arc (1 = first) belongs to; see `Robot.labels`."""
        return None if arc is None else self.owners[arc - 1]


def ask_body(robot: Robot, q: Floats, targets: Sequence[Target]) -> BodyQuestion:
    """Return the question of targets in a configuration (n, 3) of the drive."""
    if not robot.has_external_load:
        return BodyQuestion(robot, q, tuple(targets), robot.labels)
    own, found = body_of(robot), robot.shape(q)
    rolls = np.cumsum(found.states[:, t.TWIST])
    asked = [_turned(target, robot, int(own.ends[robot.end_row(target.segment) - 1]), rolls) for target in targets]
    return BodyQuestion(found.body, found.arcs, tuple(asked), [robot.labels[k] for k in own.owners], found)


def _turned(target: Target, robot: Robot, end: int, rolls: Floats) -> Target:
    """The same target for the arc `end`, whose frame has not rolled; that of the tip is in the tool."""
    number = end + 1 - robot.drive.before
    if target.segment is None or target.segment == len(robot.segments):
        return target.changed(segment=None)
    if target.rotation is None:
        return target.changed(segment=number)
    return target.changed(segment=number, rotation=target.rotation @ rolled(-float(rolls[end]))[:3, :3])


ROUNDING = 1e-9
"""Overlap that a proof needs beyond the bound, in mean lengths of the robot."""

Ramp = tuple[float, float, float]
"""How the angle of the tangent may grow: the arc length where it begins, rad per length unit, and the largest, rad."""


def base_blocked(robot: Robot, scene: Snapshot) -> bool:
    """Prove that the body is too near to an obstacle where it leaves its mount, whatever the configuration.

    Where the whole robot may be shorter than its mount, nothing is proved. The backbone at arc length `mount` is
    within `bound_sway` of the straight line.
    """
    if len(scene) == 0 or robot.joints:
        return False
    leaves = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    rounding = ROUNDING * robot.mean_length + float(scene.table[:, ROUNDOFF].max())
    distance = float(scene.at_most(leaves))
    if distance >= max(robot.needed_radii) - rounding:
        return False
    reached, radius = 0.0, robot.needed_radii[0]
    ramps: list[Ramp] = []
    if robot.mount > 0.0:
        of_each = robot.rows, robot.needed_radii, robot.curvatures, robot.largest_bends
        for segment, own, curvature, bend in zip(*of_each, strict=True):
            # Lengths vary: this may be the segment that leaves the mount, and so may any before it.
            radius = min(radius, own)
            low, high = segment.length
            tightest = min(curvature, bend / low if low > 0.0 else math.inf)
            ramps.append((reached, tightest, min(bend, curvature * high, math.pi)))
            reached += low
            if reached > robot.mount:
                break
        else:
            return False
    return bool(distance + bound_sway(robot.mount, ramps) < radius - rounding)


def bound_sway(mount: float, ramps: Sequence[Ramp]) -> float:
    """Bound how far the backbone at arc length `mount` can be from where it would be without any bend.

    A tangent that has turned by the angle a differs from the straight one by at most 2 sin(a / 2). The bound is the
    integral of that up to `mount`, where every segment begins as early, and bends as tightly, as its limits allow.
    """
    ramps = [ramp for ramp in ramps if ramp[1] > 0.0 and ramp[2] > 0.0]
    ends = {begin + most / rate for begin, rate, most in ramps} | {begin for begin, _, _ in ramps}
    places = [0.0, *sorted(place for place in ends if 0.0 < place < mount), mount]
    total = 0.0
    for before, after in pairwise(places):
        middle = 0.5 * (before + after)
        rate = sum(rate for begin, rate, most in ramps if begin <= middle <= begin + most / rate)
        angle = sum(
            most if begin + most / rate <= before else rate * (before - begin)
            for begin, rate, most in ramps
            if begin <= before
        )
        total += _chord_area(angle, rate, after - before)
    return total


def _chord_area(angle: float, rate: float, length: float) -> float:
    """Integral of 2 sin(min(a, pi) / 2) over `length`, for an angle a that begins at `angle` and grows by `rate`."""
    rising = length if rate == 0.0 else min(length, max(0.0, math.pi - angle) / rate)
    begin, end = 0.5 * min(angle, math.pi), 0.5 * min(angle + rate * rising, math.pi)
    # 2 sin of the mean, times sin(x) / x of half the difference: exact, also where the angle hardly grows
    half = 0.5 * (end - begin)
    mean = 2.0 * math.sin(0.5 * (begin + end)) * (math.sin(half) / half if half > 0.0 else 1.0)
    return mean * rising + 2.0 * (length - rising)
