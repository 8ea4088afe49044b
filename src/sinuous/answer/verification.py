"""Judge shapes by an independent, slow path: what `sinuous.measures` computes. No kernel is used, nothing is solved."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Batch, Number, Truth
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr, call
from sinuous.base.progress import ProgressBar
from sinuous.measures.body import BodyPlace, least_clearance, nearest_meeting, segment_ends
from sinuous.measures.following import least_clearances, least_meeting, shares_between
from sinuous.measures.reach import target_errors
from sinuous.measures.statics import imbalance, lacking_stretch, pulls
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem, ask_body, check_sizes
from sinuous.problem.target import Target, Targets, Tolerance, as_tolerance, target_list
from sinuous.scene.scene import SceneLike, as_snapshot
from sinuous.scene.snapshot import Snapshot
from sinuous.statics.body import body_of
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, Way

LIMIT_SLACK = 1e-9
"""By how much a limit may be exceeded: rad, or mean lengths of the robot."""


ROUNDING = 1e-9
"""What rounding may add to an error, relative to the robot's length."""

AT_REST = 1e-5
"""How far the shape of a loaded body may be from one at rest, relative to the robot's length."""


@dataclass(frozen=True, repr=False)
class Verification(ShortRepr):
    """What the slow path found.

    Attributes
    ----------
    ok : bool
        Targets met, limits kept, no place of the body inside an obstacle, and none inside the body elsewhere; nor
        nearer to either than the robot demands.
    position_error, angle_error : float
        Largest over the targets; 0 where nothing is asked.
    excess : float
        By how much the limits are exceeded; 0 within.
    clearance : float
        Least over the sampled places: the true clearance is at most this. Infinite without obstacles.
    segment, obstacle : int, str or None, str or None
        Where the least clearance is: segment (1 = first; or the name of the joint whose link it is) and name of the
        obstacle.
    self_clearance : float
        Least distance of the body from itself over the sampled places: the true one is at most this. Infinite where it
        does not matter: the body may run through itself, or is too short to.
    self_segments : pair of int or str, or None
        The two segments that are nearest to each other, likewise.
    place : BodyPlace or None
        Of the backbone, where the least clearance is.
    self_place : BodyPlace or None
        Of the backbone, where the body is nearest to itself: the place that is nearer to the tip.
    """

    ok: bool
    position_error: float
    angle_error: float
    excess: float
    clearance: float
    segment: int | str | None
    obstacle: str | None
    self_clearance: float
    self_segments: tuple[Any, Any] | None
    place: BodyPlace | None = None
    self_place: BodyPlace | None = None

    def _shown(self) -> Iterator[str]:
        yield f"ok={self.ok}"
        if self.place is not None and self.clearance < 0.0:
            yield f"in {self.obstacle} {self.place}"
        for name in ("position_error", "angle_error", "excess", "clearance", "self_clearance"):
            yield f"{name}={getattr(self, name):.3g}"


class MotionVerification(list[Verification]):
    """What the slow path found of a motion: of each waypoint, then of each step.

    Parameters
    ----------
    verifications : list of Verification
    left_steps : tuple of int
        Numbers of the steps in which the tip was seen to leave the line between waypoints, and may not, 1 = first.

    Attributes
    ----------
    left_steps : tuple of int
    """

    def __init__(self, verifications: Iterable[Verification] = (), left_steps: tuple[int, ...] = ()) -> None:
        super().__init__(verifications)
        self.left_steps = left_steps

    @property
    def ok(self) -> bool:
        """Whether all of them are, and the tip leaves no line that it has to follow."""
        return not self.left_steps and all(each.ok for each in self)


@dataclass(frozen=True, eq=False, repr=False)
class Verifications:
    """What the slow path found of many shapes; every attribute is an array (...), see `Verification`.

    Attributes
    ----------
    ok : ndarray of bool
    position_error, angle_error, excess, clearance, self_clearance : ndarray
    segment, obstacle, self_segments, place, self_place : ndarray of object
        With None where a single one has it.
    """

    ok: NDArray[np.bool_]
    position_error: Floats
    angle_error: Floats
    excess: Floats
    clearance: Floats
    segment: NDArray[np.object_]
    obstacle: NDArray[np.object_]
    self_clearance: Floats
    self_segments: NDArray[np.object_]
    place: NDArray[np.object_]
    self_place: NDArray[np.object_]

    def __repr__(self) -> str:
        return call("Verifications", [f"{int(self.ok.sum())} of {self.ok.size} ok"])


def verify(problem: Problem, q: Floats) -> Verification:
    """Recompute errors, limits and clearances of the configuration `q` (n, 3) for `problem`."""
    return verified(problem.robot, q, problem.scene, problem.targets, problem.tolerance)


def verified(robot: Robot, q: Floats, scene: Snapshot, targets: Sequence[Target], tolerance: Tolerance) -> Verification:
    """Recompute errors, limits and clearances of a configuration `q` (n, 3); there may be no targets."""
    asked, limits = ask_body(robot, q, targets), robot.limit_set
    body, arcs = asked.body, asked.arcs
    ends = segment_ends(body, arcs)
    errors = [target_errors(body, target, ends) for target in asked.targets]
    off, turn = (max((error[i] for error in errors), default=0.0) for i in (0, 1))
    clearance, segment, obstacle, place = least_clearance(body, scene, arcs, ends)
    itself = nearest_meeting(body, arcs, ends)
    demanded = np.subtract(body.needed_radii, body.radii)
    spare = clearance - float(demanded[0])
    if np.ptp(demanded) > 0.0:  # the place with the least clearance need not be the one that lacks most
        spare = least_clearance(body, scene, arcs, ends, beyond=True).distance
    slack = ROUNDING * robot.mean_length
    at_rest = asked.shape is None or imbalance(robot, q, asked.shape.states) <= AT_REST * robot.mean_length
    ok = (
        at_rest
        and (asked.shape is None or not limits.tension_violations(pulls(robot, q, asked.shape.states)))
        and off <= (tolerance.position or 0.0) + slack
        and turn <= tolerance.angle + 1e-7
        and _within_limits(robot, q)
        and _held(robot, q)
        and spare >= -slack
        and itself.gap >= -slack
    )
    gap = itself.gap + robot._least_clearances[1]
    where, pair = asked.segment(segment), itself.segments
    both = None if pair is None else (asked.owners[pair[0] - 1], asked.owners[pair[1] - 1])
    places = (None if own is None else own.on_robot(asked.owners, arcs[:, 2]) for own in (place, itself.place))
    return Verification(ok, off, turn, robot.excess(q), clearance, where, obstacle, gap, both, *places)


def verify_steps(robot: Robot, q: Floats, scene: Snapshot, times: Floats) -> list[Verification]:
    """Look at the steps between knots (T, n, 3) at many places of each, in the scene as it is at their `times` (T,)."""
    return [_step(robot, q[i : i + 2], scene, times[i : i + 2]) for i in range(len(q) - 1)]


def _step(robot: Robot, ends: Floats, scene: Snapshot, times: Floats) -> Verification:
    """Look at one step: limits at both ends, for they are convex; tensions and clearances at shares of it."""
    if robot.has_external_load:
        return _loaded_step(robot, ends, scene, times)
    shares = shares_between(robot, *ends)
    q = (1.0 - shares)[:, None, None] * ends[0] + shares[:, None, None] * ends[1]
    when = times[0] + shares * (times[1] - times[0])
    found = _seen(robot, ends, robot, q, robot.labels, scene, when)
    return replace(found, ok=found.ok and _held(robot, q))


def _loaded_step(robot: Robot, ends: Floats, scene: Snapshot, times: Floats) -> Verification:
    """Look at a step of a loaded body: every shape of it has to be at rest, too, by other code than that found it."""
    one, other = Rest(robot, ends[0]), Rest(robot, ends[1])
    body, owners = longest_body(robot), [robot.labels[k] for k in body_of(robot).owners]
    if one.states is None or other.states is None:
        raise InputError("q", "no equilibrium was found", ends.tolist(), "knots at which the robot holds its load")
    shares, way = shares_between(body, one.arcs, other.arcs), Way(one, other)
    rests = [one, *map(way.rest, shares[1:-1].tolist()), other]
    shapes = [each for each in rests if each.states is not None]
    drives = np.stack([each.q for each in shapes]), np.stack([each.found[0] for each in shapes])
    moved = [each.displacements for each in shapes if each.displacements is not None]
    displaced = np.stack(moved) if moved else None
    off = imbalance(robot, *drives, displaced)
    when = times[0] + shares[[each.states is not None for each in rests]] * (times[1] - times[0])
    found = _seen(robot, ends, body, np.stack([each.arcs for each in shapes]), owners, scene, when)
    held = not any(map(robot.limit_set.tension_violations, pulls(robot, *drives, displaced)))
    at_rest = len(shapes) == len(rests) and off <= AT_REST * robot.mean_length
    return replace(found, ok=found.ok and at_rest and held)


def _seen(
    robot: Robot, ends: Floats, body: Robot, q: Floats, owners: Sequence[Any], scene: Snapshot, when: Floats
) -> Verification:
    """Judge shapes `q` (T, N, 3) of a body, whose segments belong to these `owners` of the robot, at times (T,)."""
    clearances, spares, segments, obstacles = least_clearances(body, scene, q, when)
    at = int(clearances.argmin())
    itself = least_meeting(body, q)
    gap, slack = itself.gap + robot._least_clearances[1], ROUNDING * robot.mean_length
    ok = all(_within_limits(robot, one) for one in ends) and spares.min() >= -slack and itself.gap >= -slack
    nothing = obstacles[at] < 0
    segment, obstacle = (None, None) if nothing else (owners[int(segments[at])], scene.name(int(obstacles[at])))
    pair = itself.segments
    both = None if pair is None else (owners[pair[0] - 1], owners[pair[1] - 1])
    least = float(clearances[at])
    there = (
        None if nothing else least_clearance(body, scene.at(float(when[at])), q[at], segment_ends(body, q[at])).place
    )
    places = (None if own is None else own.on_robot(owners, q[at][:, 2]) for own in (there, itself.place))
    return Verification(bool(ok), 0.0, 0.0, robot.excess(ends), least, segment, obstacle, gap, both, *places)


def _within_limits(robot: Robot, q: Floats) -> bool:
    return not robot.limit_set.violations(q, LIMIT_SLACK)


def _held(robot: Robot, q: Floats) -> bool:
    """Whether tensions within their limits hold shapes (..., n, 3) without load."""
    return robot.limit_set.tension_rows is None or lacking_stretch(robot, q) <= LIMIT_SLACK * robot.mean_length


OBJECTS = ("segment", "obstacle", "self_segments", "place", "self_place")

KINDS = {"ok": np.bool_, **dict.fromkeys(OBJECTS, np.object_)}
"""What arrays of these attributes of a verification hold; all others are numbers."""


@overload
def check(
    robot: Robot,
    q: Sequence[Sequence[Number]],
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Truth = True,
) -> Verification: ...


@overload
def check(
    robot: Robot,
    q: Sequence[Sequence[Sequence[Number]]],
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Truth = True,
) -> Verifications: ...


@overload
def check(
    robot: Robot,
    q: Batch,
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Truth = True,
) -> Any: ...


def check(
    robot: Robot,
    q: Batch,
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Truth = True,
) -> Any:
    """Judge shapes: limits, clearance, and targets where there are any. No kernel is used, nothing is solved.

    Parameters
    ----------
    robot : Robot
    q : array_like (..., n, 3)
        One configuration, or many.
    scene : Scene or list of obstacles, optional
    targets : Target or list of Target, optional
        To be met at once, by every configuration.
    tolerance : Tolerance, optional
        Of the targets; default as for a solve.
    progress : bool
        Whether to show on a terminal how many of many are done.

    Returns
    -------
    Verification or Verifications
        Of many configurations every attribute is an array (...).

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """
    checks.instance("robot", robot, Robot, "a Robot")
    shapes, place = robot.configuration("q", q), as_snapshot(scene)
    place.refuse_moving()
    check_sizes(robot, place)
    asked = () if targets is None else target_list("targets", targets, robot)
    exactly = as_tolerance(tolerance).for_robot(robot)
    every = shapes.reshape(-1, len(robot), 3)
    found = []
    with ProgressBar(len(every) if checks.truth("progress", progress) else 0, what="checking") as bar:
        for one in every:
            found.append(verified(robot, one, place, asked, exactly))
            bar.advance()
    return found[0] if shapes.ndim == 2 else _stacked(found, shapes.shape[:-2])


def _stacked(found: list[Verification], lead: tuple[int, ...]) -> Verifications:
    arrays: dict[str, Any] = {}
    for name in (field.name for field in fields(Verification)):
        values = np.empty(len(found), KINDS.get(name, np.float64))
        for i, one in enumerate(found):
            values[i] = getattr(one, name)
        arrays[name] = values.reshape(lead)
    return Verifications(**arrays)
