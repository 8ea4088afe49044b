"""How far the body is from itself, by many places of it."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.measures.body import SAMPLES, arc_poses
from sinuous.measures.nearest import Indices, blocks
from sinuous.robot.robot import Robot

MOST_PLACES = 20_000
"""Places of the whole body, but for robots of so many segments that a few each are more."""

FEWEST = 8
"""Places of a segment."""


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
    for first, second in _near(places, along, radii):
        gaps = np.linalg.norm(places[first] - places[second], axis=-1) - radii[first] - radii[second]
        if gaps.min(initial=math.inf) < least.gap:
            at = int(gaps.argmin())
            pair = sorted((int(segments[first[at]]) + 1, int(segments[second[at]]) + 1))
            least = Meeting(float(gaps[at]), (pair[0], pair[1]))
    return least


def _places(q: Floats, ends: Floats) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Sampled places (m, 3) of the backbone, how far along it they are (m,), and the segments (m,), 0 = first."""
    count = min(SAMPLES, max(FEWEST, MOST_PLACES // len(q)))
    fractions = np.linspace(0.0, 1.0, count + 1)
    places = [(ends[k] @ arc_poses(segment, count))[:, :3, 3] for k, segment in enumerate(q)]
    begins = np.cumsum(q[:, 2]) - q[:, 2]
    along = (begins[:, None] + q[:, 2, None] * fractions).ravel()
    return np.concatenate(places), along, np.repeat(np.arange(len(q)), count + 1)


def _near(places: Floats, along: Floats, radii: Floats) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of places that concern each other, block by block; none that could be nearest is left out."""
    from scipy.spatial import cKDTree  # noqa: PLC0415

    thickest = float(radii.max())
    if thickest == 0.0:
        return
    # Places half a circle of the largest radius apart concern each other: no gap beyond the least of theirs matters.
    first = np.arange(len(along))
    second = np.searchsorted(along, along + math.pi * thickest)
    first, second = first[second < len(along)], second[second < len(along)]
    apart = np.linalg.norm(places[first] - places[second], axis=-1) - radii[first] - radii[second]
    reach = min(float(apart.min(initial=math.inf)) + 2.0 * thickest, float(along[-1])) * (1.0 + 1e-12)
    tree = cKDTree(places)
    for block in blocks(np.asarray(tree.query_ball_point(places, reach, return_length=True))):
        lists = tree.query_ball_point(places[block], reach)
        neighbours = [np.asarray(entry, np.intp) for entry in lists]
        first, second = np.repeat(block, [len(own) for own in neighbours]), np.concatenate(neighbours)
        larger = np.maximum(radii[first], radii[second])
        concerned = (along[second] - along[first] >= math.pi * larger) & (larger > 0.0)
        yield first[concerned], second[concerned]
