"""Where the body touches obstacles, or is about to, and in which direction it would come free."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.measures.body import backbone_places, concerned
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem

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
    """

    segment: int
    obstacle: str | None
    clearance: float
    gradient: Floats
    other_segment: int | None = None
    inside: bool = False
    demanded: float = 0.0


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
            found.append(Contact(*own, inside=scene.obstacles[i].inside, demanded=demanded))
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
    jacobian = robot.jacobian(part, k + 1)
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
        found.append(Contact(int(b) + 1, None, float(own[i, j]), far - near, int(a) + 1, demanded=demanded))
    return sorted(found, key=lambda contact: contact.clearance)
