"""The question: a robot, its targets, what stands around, how exactly they must be met; and a first look at it.

A first look says what is proved of the base before anything is tried. Of a robot under load the question is put to its
body, a robot of arcs. What may be meant but hardly is (lengths in units that do not fit together, degrees for radians)
is said in a line each; every length is compared with that of the robot, and nothing is changed.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple, Self, TypedDict, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number
from sinuous.base.checks import Floats
from sinuous.base.errors import grouped, segments
from sinuous.base.frozen import Frozen, text
from sinuous.kernels import packing
from sinuous.kernels.packing import read_only
from sinuous.kernels.statics import layout as t
from sinuous.kernels.tables import ROUNDOFF
from sinuous.model.joints import Revolute, joint_names
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Targets, Tolerance, as_tolerance, target_list, target_table
from sinuous.scene.mesh import Mesh
from sinuous.scene.point_cloud import PointCloud
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
    rolls = np.cumsum(found.states[:, t.TORSION])
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


ODD = 300.0
"""How many times larger than the robot, or smaller, something is when it is probably in another length unit. Parts of
a few robot lengths in mm, beside a robot in m, are some hundred to some thousand times too large."""

ODD_FILE = 100.0
"""The same of meshes and clouds, whose files do not say their unit."""

THIN, LINE = 1e4, 5e5
"""How many times longer than its radius, or than the arm of its tendons, a robot is when these are in another unit; one
that is thinner still is meant as a line."""

LONG_TOOL = 10.0
"""How many times longer than the robot its tool is when that is in another unit."""

SHORT_TOOL, NO_TOOL = 400.0, 1e5
"""How many times longer than the tool a segment is when the tool is in another unit; one that is shorter still is a
small change of a tool, as of a difference quotient."""

TIGHT, SLACK = 50.0, 300.0
"""How many times smaller, or larger, than what the largest bends need the limits of tendons are in another unit."""

KEPT = 64
"""Robots of which is kept what is suspicious."""

FULL_TURN = 2.0 * math.pi


def input_warnings(robot: Robot, scene: Snapshot) -> list[str]:
    """What is suspicious of a robot in a scene; one line each."""
    return [*_of_robot(robot), *_of_obstacles(robot, scene)]


def problem_warnings(robot: Robot, scene: Snapshot, waypoints: Sequence[Sequence[Target]]) -> list[str]:
    """The same, with what is suspicious of the base and of targets: what a solve says in its status."""
    return [*input_warnings(robot, scene), *_of_base(robot, scene.first), *_of_targets(robot, waypoints)]


@lru_cache(maxsize=KEPT)
def _of_robot(robot: Robot) -> tuple[str, ...]:
    """What is suspicious of a robot alone."""
    thick = robot.thick_notes
    return *_of_angles(robot), *_of_lengths(robot), *_of_loads(robot), *thick


def _longest(robot: Robot) -> float:
    return robot.longest or robot.mean_length


def _of_angles(robot: Robot) -> Iterator[str]:
    for numbers, most in grouped({k: s.max_bend for k, s in enumerate(robot.segments, 1)}):
        if most > FULL_TURN * (1.0 + 1e-9):
            which = segments(numbers, len(robot.segments))
            yield f"max_bend of {which} is {most:.4g} rad, more than a full turn; is it in degrees?"
    for k, segment in enumerate(robot.segments, 1):
        if float(np.hypot(*segment.rest)) > FULL_TURN * (1.0 + 1e-9):
            yield f"rest of segment {k} is more than a full turn; is it in degrees?"
        if segment.plane is not None and abs(segment.plane) > FULL_TURN * (1.0 + 1e-9):
            yield f"plane of segment {k} is at {segment.plane:.4g} rad, more than a full turn; is it in degrees?"
        for key in ("tendons", "chambers"):
            lines = getattr(segment, key)
            if lines is None:
                continue
            sizes = np.abs(lines.angles)
            if sizes.max() > 2.0 * FULL_TURN or sizes.min() > FULL_TURN * (1.0 + 1e-9):
                said = ", ".join(f"{angle:.4g}" for angle in lines.angles[:4])
                yield f"{key} of segment {k} stand at {said} rad, more than a full turn; are these degrees?"
    for joint, name in zip(robot.joints, joint_names(robot.joints), strict=True):
        most = max(map(abs, joint.limits))
        if isinstance(joint, Revolute) and most > 2.0 * FULL_TURN * (1.0 + 1e-9):  # wrists may turn once, both ways
            yield f"joint '{name}' turns up to {most:.4g} rad, more than two full turns; are its limits in degrees?"


def _of_lengths(robot: Robot) -> Iterator[str]:
    """Compare the radii, tool and limits of tendons of a robot with its length."""
    length = _longest(robot)
    ask = "are both in one length unit?"
    for key, radii, most in (
        ("radius", [segment.radius for segment in robot.segments], 1.0),
        ("radius of the tendons", [s.tendons.radius for s in robot.rows if s.tendons is not None], 1.0),
    ):
        odd = [radius for radius in radii if radius > most * length or length / LINE < radius < length / THIN]
        if odd:
            yield f"the {key} is {odd[0]:.4g}, the robot {length:.4g} long; {ask}"
    tool = float(np.linalg.norm(robot.tool[:3, 3]))
    segment_length = max((segment.length[1] for segment in robot.segments), default=length)
    if tool > LONG_TOOL * length or segment_length / NO_TOOL < tool < segment_length / SHORT_TOOL:
        yield f"the tool is {tool:.4g} long, the robot {length:.4g}; {ask}"
    for k, segment in enumerate(robot.segments, 1):
        if segment.tendons is None or segment.max_bend == 0.0:
            continue
        limits = np.abs(segment.tendons.displacements)
        most = float(limits[np.isfinite(limits)].max(initial=0.0))
        needed = segment.tendons.radius * segment.max_bend
        if 0.0 < most * TIGHT < needed or most > SLACK * needed * len(robot.segments):
            yield f"tendons of segment {k} move by at most {most:.4g}, its largest bend takes {needed:.4g}; {ask}"


def _of_loads(robot: Robot) -> Iterator[str]:
    """Compare what a robot carries with what bends it by a radian: a thousandth or thousandfold is another unit."""
    if robot.gravity is None and robot.payload:
        yield "the payload weighs nothing without gravity; gravity=(0, 0, -9.81) is that of the earth, for lengths in m"
    soft = [segment.stiffness.bend for segment in robot.rows if segment.stiffness is not None]
    if robot.gravity is None or not soft:
        return
    masses = [segment.mass * segment.length[1] for segment in robot.rows] + [each.mass for each in robot.payload]
    length = _longest(robot)
    bent = sum(masses) * float(np.linalg.norm(robot.gravity)) * length**2 / min(soft)
    if bent > ODD or 0.0 < bent < 1.0 / ODD**2:
        much = "hangs like a thread" if bent > ODD else "is not bent at all"
        yield (
            f"weight x length^2 / stiffness is {bent:.3g}, the robot {much}; "
            "are gravity, mass and stiffness in one set of units?"
        )


def _of_obstacles(robot: Robot, scene: Snapshot) -> Iterator[str]:
    length = _longest(robot)
    sizes, together = scene._sizes
    large = {} if max(sizes.values(), default=0.0) <= min(ODD, ODD_FILE) * length else sizes
    for i, size in large.items():
        of_file = isinstance(scene.obstacles[i], Mesh | PointCloud)
        if size > (ODD_FILE if of_file else ODD) * length:
            yield f"{scene.name(i)} is {size:.4g} large, the robot {length:.4g} long; are both in one length unit?"
    if sizes and len(sizes) == len(scene) and ODD * together < length:
        yield f"all obstacles lie within {together:.4g}, the robot is {length:.4g} long; are both in one length unit?"


def _of_base(robot: Robot, scene: Snapshot) -> Iterator[str]:
    if len(scene) and robot.mount == 0.0:
        place = robot.base[:3, 3]
        if float(scene.at_most(place)) < robot.radii[0]:
            name = scene.name(int(scene.nearest(place)))
            yield f"the base touches {name}; where the robot stands on it or sits in it, say so with mount"


def _of_targets(robot: Robot, waypoints: Sequence[Sequence[Target]]) -> Iterator[str]:
    length = _longest(robot)
    places = [target.position for targets in waypoints for target in targets if target.position is not None]
    distances = [float(np.linalg.norm(place - robot.base[:3, 3])) for place in places]
    far = max(distances, default=0.0)
    if far > ODD * length:
        yield f"a target is {far:.4g} from the base, the robot {length:.4g} long; are both in one length unit?"
    elif 0.0 < far * ODD < length:
        yield f"every target is within {far:.4g} of the base, the robot {length:.4g} long; are both in one length unit?"
