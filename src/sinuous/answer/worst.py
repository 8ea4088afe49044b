"""Contacts of a body, and the constraint that a configuration is farthest from meeting; by kernels, to be quick.

It only says what a failed solve is missing. Its values are those of `sinuous.measures`, except that fewer places of
the body are compared with each other.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import Constraint
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, labelled, number, one_of_body
from sinuous.base.frozen import ShortRepr
from sinuous.measures.body import (
    SAMPLES,
    BodyPlace,
    Meeting,
    NearestObstacle,
    backbone_places,
    concerned,
    nearest_meeting,
)
from sinuous.measures.reach import target_errors
from sinuous.model.robot import Robot
from sinuous.problem.problem import BodyQuestion, Problem
from sinuous.scene.snapshot import Snapshot, least_gap

FIRST_PIECES = 16
"""Pieces that a segment is divided into at first."""

HALVINGS = 6
"""How often pieces that might touch an obstacle are halved."""

SELF_PLACES = 480
"""Places of the body, of all segments together, that are compared with each other."""

TOUCHING = 1e-3
"""Clearance up to which the body counts as touching, in mean lengths of the robot."""


class Contact(NamedTuple):
    """A place of the body at an obstacle.

    Attributes
    ----------
    segment : int
        1 = first.
    obstacle : str
    clearance : float
        Distance of the surface of the body from the obstacle, less what is demanded of it; negative where it is nearer.
    gradient : ndarray (3 n,)
        Of the clearance, by bends (rad) and lengths (length unit).
    other_segment : int or None
        The segment that it touches, where the body touches itself: not beyond `segment`.
    inside : bool
        Whether the body has to stay inside the obstacle.
    demanded : float
        The distance that is demanded.
    place : BodyPlace or None
        Of the backbone, on `segment`.
    """

    segment: int
    obstacle: str | None
    clearance: float
    gradient: Floats
    other_segment: int | None = None
    inside: bool = False
    demanded: float = 0.0
    place: BodyPlace | None = None


class _Places(NamedTuple):
    """Places of the body: the segments (m,) they are on, 0 = first, how far along (m,), 0 to 1, and where (m, 3)."""

    segments: NDArray[np.intp]
    along: Floats
    points: Floats


def all_contacts(problem: Problem, q: Floats) -> list[Contact]:
    """List contacts of the body in configuration `q` (n, 3) with obstacles and with itself, deepest first."""
    contacts = [*contacts_of(problem, q), *self_contacts_of(problem, q)]
    return sorted(contacts, key=lambda contact: contact.clearance)


def contacts_of(problem: Problem, q: Floats, margin: float | None = None) -> list[Contact]:
    """List where the body in configuration `q` (n, 3) is within `margin` of obstacles, deepest first."""
    robot, scene = problem.robot, problem.scene
    if len(scene) == 0:
        return []
    reach = TOUCHING * robot.mean_length if margin is None else margin
    places = _near(problem, q, reach)
    found: list[Contact] = []
    for i in range(len(scene)):
        distances, slopes = scene.distance_to(i, places.points)
        clearances = distances - np.array(robot.needed_radii)[places.segments]
        for m in _deepest(places, clearances, reach):
            place = int(places.segments[m]), float(places.along[m]), places.points[m]
            gradient = _gradient(robot, q, place, slopes[m])
            own = place[0] + 1, scene.name(i), float(clearances[m]), gradient
            demanded = robot.needed_radii[place[0]] - robot.radii[place[0]]
            where = BodyPlace.of(place[2], place[0] + 1, place[1])
            found.append(Contact(*own, inside=scene.obstacles[i].inside, demanded=demanded, place=where))
    return sorted(found, key=lambda contact: contact.clearance)


def _near(problem: Problem, q: Floats, reach: float) -> _Places:
    """Places that may be within reach of an obstacle: pieces that might touch, or be deepest, are halved again."""
    robot, ends = problem.robot, problem.robot.forward(q)
    starts = np.concatenate([robot.base[None], ends[:-1]])
    radii, begin = np.array(robot.needed_radii), np.concatenate([[0.0], np.cumsum(q[:, 2])[:-1]])
    segments = np.repeat(np.arange(len(robot)), FIRST_PIECES + 1)
    along = np.tile(np.linspace(0.0, 1.0, FIRST_PIECES + 1), len(robot))
    step, deepest = 1.0 / FIRST_PIECES, np.full(len(robot), reach)
    kept = [_Places(segments[:0], along[:0], np.empty((0, 3)))]
    for _ in range(HALVINGS):
        free = begin[segments] + along * q[segments, 2] >= robot.mount
        segments, along = segments[free], along[free]
        points = _points(starts[segments], q[segments], along)
        clearance = problem.scene.distance(points) - radii[segments]
        np.minimum.at(deepest, segments, clearance)
        least = clearance - 0.5 * step * q[segments, 2]
        near = least <= reach
        kept.append(_Places(segments[near], along[near], points[near]))
        unclear = near & ((clearance > reach) | (least < deepest[segments]))
        step *= 0.5
        segments = np.repeat(segments[unclear], 2)
        along = np.clip((along[unclear, None] + [-0.5 * step, 0.5 * step]).ravel(), 0.0, 1.0)
    return _Places(*(np.concatenate(parts) for parts in zip(*kept, strict=True)))


def _points(starts: Floats, q: Floats, along: Floats) -> Floats:
    """Places (m, 3) at shares `along` (m,) of segments `q` (m, 3) that begin with the poses `starts` (m, 4, 4)."""
    bend = np.hypot(q[:, 0], q[:, 1])
    angle, arc = along * bend, along * q[:, 2]
    sideways = 0.5 * arc * along * np.sinc(0.5 * angle / np.pi) ** 2
    local = np.stack([sideways * q[:, 0], sideways * q[:, 1], arc * np.sinc(angle / np.pi)], axis=-1)
    return np.einsum("mij,mj->mi", starts[:, :3, :3], local) + starts[:, :3, 3]


def _deepest(places: _Places, clearances: Floats, reach: float) -> list[int]:
    """Of every segment within reach the deepest place, and the first and the last: it may lie along the obstacle."""
    chosen: list[int] = []
    for k in np.unique(places.segments[clearances <= reach]):
        own = np.flatnonzero((places.segments == k) & (clearances <= reach))
        ends = own[places.along[own].argmin()], own[places.along[own].argmax()]
        chosen += dict.fromkeys((int(own[clearances[own].argmin()]), *map(int, ends)))
    return chosen


def _gradient(robot: Robot, q: Floats, place: tuple[int, float, Floats], slope: Floats) -> Floats:
    """Gradient (3 n,) of the distance, which changes with `slope` (3,), of a place: segment, share of it, point (3,).

    The segment up to there is a segment like any other, of the same share of its bend and length.
    """
    k, share, point = place
    part = q.copy()
    part[k] *= share
    jacobian = robot._row_jacobian(part, k + 1)
    end = robot.tip(part)[:3, 3] if k + 1 == len(robot) else point
    moved = jacobian[3:] - np.cross(jacobian[:3], end - point, axis=0)
    gradient: Floats = slope @ moved
    gradient[3 * k : 3 * k + 3] *= share
    return gradient


def self_contacts_of(problem: Problem, q: Floats) -> list[Contact]:
    """List where the body in configuration `q` (n, 3) touches itself: of two segments the deepest place."""
    from scipy.spatial.distance import cdist  # noqa: PLC0415

    robot, unit = problem.robot, problem.robot.mean_length
    if not robot.avoids_itself or len(robot) > SELF_PLACES // 4:
        return []
    count = SELF_PLACES // len(robot)
    along = np.tile(np.linspace(0.0, 1.0, count + 1), len(robot))
    segments = np.repeat(np.arange(len(robot)), count + 1)
    places = backbone_places(robot, q, np.concatenate([robot.base[None], robot.forward(q)]), count)
    points, radii = places.points, places.radii
    gaps = cdist(points, points) - radii[:, None] - radii
    one, other = np.nonzero(np.triu(gaps <= TOUCHING * unit, 1))
    touching = np.zeros(gaps.shape, np.bool_)
    touching[one, other] = concerned(places, one, other)
    found = []
    for a, b in {(segments[i], segments[j]) for i, j in np.argwhere(touching)}:
        own = np.where(touching & (segments[:, None] == a) & (segments == b), gaps, np.inf)
        i, j = np.unravel_index(own.argmin(), own.shape)
        apart = points[j] - points[i]
        away = apart / max(float(np.linalg.norm(apart)), 1e-300)
        ends = ((int(segments[k]), float(along[k]), points[k]) for k in (j, i))
        far, near = (_gradient(robot, q, end, away) for end in ends)
        demanded = sum(robot.self_radii[k] - robot.radii[k] for k in (int(a), int(b)))
        where = BodyPlace.of(points[j], int(b) + 1, along[j])
        meeting = float(own[i, j]), far - near, int(a) + 1
        found.append(Contact(int(b) + 1, None, *meeting, demanded=demanded, place=where))
    return sorted(found, key=lambda contact: contact.clearance)


WorstKind = Constraint | Literal["position", "angle"]
"""What may be worst."""


@dataclass(frozen=True, repr=False)
class Worst(ShortRepr):
    """The constraint that is farthest from being met.

    Attributes
    ----------
    constraint : str
        `position`, `angle`, `clearance`, `self_clearance`, or a limit: `length`, `bend`, `curvature`, `actuator`.
    segment : int, str or None
        Segment where it is, 1 = first; or the name of a joint, or of the one whose link it is.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    amount : float
        By how much it is missed: beyond the tolerance for `position` (length) and `angle` (rad); for
        `clearance` and `self_clearance` the depth of overlap, or what is missing of what is demanded (length); beyond
        the limit for the others (length; rad for `bend` and `curvature`).
    other_segment : int, str or None
        The segment that it touches, for `self_clearance`; not beyond `segment`.
    place : BodyPlace or None
        Where: of clearances the place of the backbone that is deepest, of `position` and `angle` the end that misses
        its target. A limit has none.
    step : int or None
        Of a motion from elsewhere: the step (1 = first) on which it is.
    time : float or None
        Of a motion from elsewhere: when.
    """

    constraint: WorstKind
    segment: int | str | None
    obstacle: str | None
    amount: float
    other_segment: int | str | None = None
    place: BodyPlace | None = None
    step: int | None = None
    time: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        when = {} if self.step is None else result_of(self, "step time")
        return result_of(self, "constraint segment obstacle amount other_segment place") | when

    @classmethod
    def from_dict(cls, values: Any) -> "Worst":
        """Make it of plain values, as `to_dict` writes them.

        Raises
        ------
        InputError
            When they are none.
        """
        try:
            place = values.get("place")
            return cls(**{**values, "place": None if place is None else BodyPlace.from_dict(place)})
        except (TypeError, AttributeError):
            raise InputError("worst", "", values, "a constraint that is not met") from None

    def on_robot(self, asked: BodyQuestion) -> "Worst":
        """Return it by segments of the robot, where it is of a body of arcs."""
        place = None if self.place is None else self.place.on_robot(asked.owners, asked.arcs[:, 2])
        own = asked.segment(self.segment), asked.segment(self.other_segment)
        return replace(self, segment=own[0], other_segment=own[1], place=place)

    def at_times(self, before: Floats, after: Floats) -> "Worst":
        """Return the same of a motion whose knots are at other times (T,), or in the opposite order."""
        if self.time is None:
            return self
        at = float(np.interp(self.time, *((before, after) if before[0] <= before[-1] else (before[::-1], after[::-1]))))
        step = int(np.clip(np.searchsorted(after, at, side="left"), 1, len(after) - 1))
        return replace(self, step=step, time=at)

    def __str__(self) -> str:
        when = "" if self.step is None else f"step {self.step}, at time {number(self.time)}: "
        return f"{when}{self._missed}"

    @property
    def _missed(self) -> str:
        """What is not met, and where."""
        there = "" if self.place is None else f", {self.place}"
        if self.other_segment is not None:
            whom = "itself" if self.other_segment == self.segment else one_of_body(self.other_segment)
            return f"{one_of_body(self.segment)} touches {whom}, {self.amount:.3g} too near{there}"
        if self.obstacle is not None:
            return f"{one_of_body(self.segment)} lacks {self.amount:.3g} of clearance from {self.obstacle}{there}"
        at_end = self.constraint in ("position", "angle")
        whose = "" if self.segment is None else labelled([self.segment])
        what = f"{self.constraint} of {whose}" if whose else str(self.constraint)
        if isinstance(self.segment, str) and not at_end:  # a joint has one limit
            what = whose
        return f"{what} is {self.amount:.3g} beyond its {'tolerance' if at_end else 'limit'}"


def find_worst(problem: Problem, q: Floats, overlap: bool) -> Worst:
    """The constraint that `q` (n, 3) is farthest from meeting, lengths relative to the robot's length.

    With `overlap` it is known to be a clearance, however deep.
    """
    robot, tolerance = problem.robot, problem.tolerance
    ends = np.concatenate([robot.base[None], robot.forward(q)])
    unit = robot.mean_length
    found = [(worst.amount / unit, worst) for worst in _overlaps(problem, q, ends if overlap else None)]
    if overlap:
        return max(found, key=lambda pair: pair[0])[1]
    for name, segment, amount in robot.limit_set.violations(q):
        found.append((amount / robot.limit_set.unit_of(name), Worst(name, segment, None, amount)))
    for target in problem.targets:
        off, turn = target_errors(robot, target, ends)
        segment = robot.end_row(target.segment)
        miss, twist = off - (tolerance.position or 0.0), turn - tolerance.angle
        end = ends[-1] @ robot.tool if segment == len(robot) else ends[segment]
        place = BodyPlace.of(end[:3, 3], segment, 1.0)
        found.append((miss / unit, Worst("position", segment, None, miss, place=place)))
        found.append((twist, Worst("angle", segment, None, twist, place=place)))
    return max(found, key=lambda pair: pair[0])[1]


def find_overlap(robot: Robot, scene: Snapshot, q: Floats) -> Worst:
    """The deepest overlap of `q` (n, 3) with an obstacle or with itself; its amount is not positive without any.

    Where only bounds of distances are known it overlaps what an upper bound says.
    """
    ends = np.concatenate([robot.base[None], robot.forward(q)])
    clearance, itself = compiled_clearance(robot, scene, q, above=True), nearest_meeting(robot, q, ends)
    return max(_as_worst(clearance, itself), key=lambda worst: worst.amount)


def _overlaps(problem: Problem, q: Floats, ends: Floats | None) -> tuple[Worst, Worst]:
    """How deep the body overlaps obstacles, and itself.

    With the frames of all `ends` (n + 1, 4, 4) it is known that it does one of both, and it is looked for with care.
    """
    clearance = compiled_clearance(problem.robot, problem.scene, q)
    itself = _seen(problem, q)
    if ends is not None and min(clearance.distance, itself.gap) > 0.0:
        itself = nearest_meeting(problem.robot, q, ends)
    return _as_worst(clearance, itself)


def _as_worst(clearance: NearestObstacle, itself: Meeting) -> tuple[Worst, Worst]:
    near, far = itself.segments or (None, None)
    distance, where, which, place = clearance
    apart = Worst("clearance", where, which, -distance, place=place)
    return apart, Worst("self_clearance", far, None, -itself.gap, near, itself.place)


def _seen(problem: Problem, q: Floats) -> Meeting:
    """Where the body touches itself, as far as fewer places show it than `nearest_meeting` looks at, in less time."""
    contacts = self_contacts_of(problem, q)
    if not contacts:
        return Meeting(math.inf, None)
    deepest = contacts[0]
    return Meeting(deepest.clearance, (deepest.other_segment or deepest.segment, deepest.segment), deepest.place)


def compiled_clearance(robot: Robot, scene: Snapshot, q: Floats, above: bool = False) -> NearestObstacle:
    """Least clearance beyond what is demanded, its segment (1 = first) and obstacle: as `measures.body` has it."""
    if len(scene) == 0:
        return NearestObstacle(math.inf, None, None)
    points, lengths = robot.backbone(q, SAMPLES), q[:, 2]
    # The end of a segment is the beginning of the next one, which may be thicker: it counts for both.
    places = np.arange(SAMPLES * len(robot)).reshape(-1, SAMPLES)[:, :1] + np.arange(SAMPLES + 1)
    before = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    free = before[:, None] + np.linspace(0.0, lengths, SAMPLES + 1, axis=-1) >= robot.mount
    segments = np.broadcast_to(np.arange(len(robot))[:, None], free.shape)[free]
    nearest = least_gap(points[places[free]], np.array(robot.needed_radii)[segments], scene, above)
    if nearest.place is None:
        return NearestObstacle(nearest.distance, None, nearest.obstacle)
    row, run = np.argwhere(free)[nearest.place]
    place = BodyPlace.of(points[places[row, run]], int(row) + 1, run / SAMPLES)
    return NearestObstacle(nearest.distance, int(row) + 1, nearest.obstacle, place)
