"""Places of the body, and how far they are from obstacles and from each other, by matrix exponentials and sampling."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.measures.obstacles import Indices, at_most, measure
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot

SAMPLES = 200
"""Places on every segment where the body is looked at."""


def arc_poses(q: Floats, pieces: int) -> Floats:
    """Poses (pieces + 1, 4, 4) along one segment `q` (3,), by powers of the exponential of its twist."""
    from scipy.linalg import expm  # noqa: PLC0415

    ux, uy, length = q
    twist = np.array([[0, 0, ux, 0], [0, 0, uy, 0], [-ux, -uy, 0, length], [0, 0, 0, 0]], np.float64)
    step = expm(twist / pieces)
    poses = [np.eye(4)]
    for _ in range(pieces):
        poses.append(poses[-1] @ step)
    return np.stack(poses)


def segment_ends(robot: Robot, q: Floats) -> Floats:
    """Poses (n + 1, 4, 4) of the base and of the ends of all segments."""
    poses = [robot.base]
    for segment in q:
        poses.append(poses[-1] @ arc_poses(segment, 1)[1])
    return np.stack(poses)


def body_places(robot: Robot, q: Floats, ends: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Sampled places (m, 3) of the backbone beyond the mount, and the segment (m,), 0 = first, that each is on."""
    places, segments = [], []
    before = 0.0
    for k, segment in enumerate(q):
        length = float(segment[2])
        free = before + np.linspace(0.0, length, SAMPLES + 1) >= robot.mount
        places.append((ends[k] @ arc_poses(segment, SAMPLES))[free, :3, 3])
        segments.append(np.full(len(places[-1]), k))
        before += length
    return np.concatenate(places), np.concatenate(segments)


class Nearest(NamedTuple):
    """The least distance to obstacles, and where it is.

    Attributes
    ----------
    distance : float
        Infinite without obstacles.
    segment : int or None
        Segment of the body, 1 = first.
    obstacle : str or None
        Name of the obstacle.
    """

    distance: float
    segment: int | None
    obstacle: str | None


def least_clearance(robot: Robot, scene: Snapshot, q: Floats, ends: Floats) -> Nearest:
    """Least clearance over sampled places of the body beyond the mount, in configuration `q` (n, 3).

    `ends` (n + 1, 4, 4) are the poses of the base and of the ends of all segments.
    """
    least = Nearest(math.inf, None, None)
    if len(scene) == 0:
        return least
    places, segments = body_places(robot, q, ends)
    radii = np.array(robot.radii)[segments]
    for i, obstacle in enumerate(scene.obstacles):
        clearances = measure(obstacle, places) - radii
        if clearances.min(initial=math.inf) < least.distance:
            nearest = int(clearances.argmin())
            least = Nearest(float(clearances[nearest]), int(segments[nearest]) + 1, scene.name(i))
    return least


def room_at(place: Floats, scene: Snapshot) -> Nearest:
    """Upper bound of the distance of a place (3,) to the obstacles, and the obstacle that gives it."""
    distances = [float(at_most(obstacle, place[None])[0]) for obstacle in scene.obstacles]
    nearest = int(np.argmin(distances))
    return Nearest(distances[nearest], None, scene.name(nearest))


MOST_PLACES = 20_000
"""Places of the whole body, but for robots of so many segments that a few each are more."""

FEWEST = 8
"""Places of a segment."""

RUN, PAIRS = 16, 64
"""Places in a row that are held against others in a row, and pairs of such runs that are looked at together."""


class Meeting(NamedTuple):
    """The least gap between two places of the body that concern each other, and where it is.

    Attributes
    ----------
    gap : float
        Their distance less both radii; infinite when no two places concern each other.
    segments : (int, int) or None
        Their segments, 1 = first, the one nearer to the base first.
    """

    gap: float
    segments: tuple[int, int] | None


def least_self_clearance(robot: Robot, q: Floats, ends: Floats) -> Meeting:
    """Least gap over sampled places of the body, in configuration `q` (n, 3).

    Two places concern each other when their distance along the backbone is at least pi times the larger of their
    radii, unless both have none. `ends` (n + 1, 4, 4) are the poses of the base and of the ends of all segments.
    """
    places, along, segments = _places(q, ends)
    radii = np.array(robot.radii)[segments]
    least = Meeting(math.inf, None)
    for low, one, other in _nearest_first(places, along, radii):
        if low >= least.gap:
            break
        first, second = one[:, :, None], other[:, None, :]
        larger = np.maximum(radii[first], radii[second])
        concerned = (along[second] - along[first] >= math.pi * larger) & (larger > 0.0)
        gaps = np.linalg.norm(places[first] - places[second], axis=-1) - radii[first] - radii[second]
        gaps[~concerned] = math.inf
        if gaps.min() < least.gap:
            k, a, b = np.unravel_index(gaps.argmin(), gaps.shape)
            least = Meeting(float(gaps.min()), (int(segments[one[k, a]]) + 1, int(segments[other[k, b]]) + 1))
    return least


def nearest_meeting(robot: Robot, q: Floats, ends: Floats) -> Meeting:
    """Where the body is nearest to itself, where that matters: see `Robot.avoids_itself`, `least_self_clearance`."""
    return least_self_clearance(robot, q, ends) if robot.avoids_itself else Meeting(math.inf, None)


def _places(q: Floats, ends: Floats) -> tuple[Floats, Floats, Indices]:
    """Sampled places (m, 3) of the backbone, how far along it they are (m,), and the segments (m,), 0 = first."""
    count = min(SAMPLES, max(FEWEST, MOST_PLACES // len(q)))
    fractions = np.linspace(0.0, 1.0, count + 1)
    places = [(ends[k] @ arc_poses(segment, count))[:, :3, 3] for k, segment in enumerate(q)]
    begins = np.cumsum(q[:, 2]) - q[:, 2]
    along = (begins[:, None] + q[:, 2, None] * fractions).ravel()
    return np.concatenate(places), along, np.repeat(np.arange(len(q)), count + 1)


def _nearest_first(places: Floats, along: Floats, radii: Floats) -> Iterator[tuple[float, Indices, Indices]]:
    """Yield pairs of runs of places (k, r), (k, r) with a lower bound of the gaps of what is still to come, and theirs.

    The run that is nearer to the base comes first. Pairs of which no two places concern each other are left out.
    The bounds are those of balls about the runs.
    """
    last = len(places) - 1
    runs = np.minimum(np.arange(0, last + 1, RUN)[:, None] + np.arange(RUN), last)
    centers = places[runs].mean(axis=1)
    reach = (np.linalg.norm(places[runs] - centers[:, None], axis=-1) + radii[runs]).max(axis=1)
    thinnest = radii[runs].min(axis=1)
    one, other = np.triu_indices(len(runs))
    apart = along[runs[other, -1]] - along[runs[one, 0]]
    may = np.flatnonzero(apart >= math.pi * np.maximum(thinnest[one], thinnest[other]))
    one, other = one[may], other[may]
    low = np.linalg.norm(centers[one] - centers[other], axis=1) - reach[one] - reach[other]
    order = np.argsort(low)
    for k in range(0, len(order), PAIRS):
        pairs = order[k : k + PAIRS]
        yield float(low[pairs[0]]), runs[one[pairs]], runs[other[pairs]]
