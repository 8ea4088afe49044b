"""The nearest of many small things, exactly: each lies in a ball, and balls that are too far away are passed over."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats

Indices = NDArray[np.intp]
Exact = Callable[[Indices, Indices], Floats]

PAIRS = 2**18
"""Pairs of a point and a thing that are looked at together."""

BLOCK = 2**20
"""Neighbours that are asked for together."""


def least_distances(points: Floats, centers: Floats, reach: Floats, exact: Exact) -> Floats:
    """Least of the distances from each point to all things.

    Parameters
    ----------
    points : ndarray (m, 3)
    centers, reach : ndarray (k, 3), (k,)
        Balls that hold the things.
    exact : callable
        From indices of points (i,) and of things (i,) to their distances (i,), signed or not.

    Returns
    -------
    ndarray (m,)
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415

    best = np.full(len(points), np.inf)
    everyone = np.arange(len(points))
    sizes = [(members, cKDTree(centers[members])) for members in _alike(reach)]
    for members, tree in sizes:
        best = np.minimum(best, exact(everyone, members[tree.query(points)[1]]))
    for members, tree in sizes:
        within = np.maximum(best + float(reach[members].max()), 0.0) * (1.0 + 1e-12)
        counts = np.asarray(tree.query_ball_point(points, within, return_length=True))
        for block in _blocks(counts):
            lists = tree.query_ball_point(points[block], within[block])
            point = np.repeat(block, counts[block])
            thing = members[np.concatenate([np.asarray(entry, np.intp) for entry in lists])]
            for first in range(0, len(point), PAIRS):
                part = slice(first, first + PAIRS)
                np.minimum.at(best, point[part], exact(point[part], thing[part]))
    return best


def _alike(reach: Floats) -> list[Indices]:
    """Things whose balls differ in size by at most a factor of two, so that a large one does not widen every search."""
    exponents = np.frexp(reach)[1]
    return [np.flatnonzero(exponents == e) for e in np.unique(exponents)]


def _blocks(counts: Indices) -> Iterator[Indices]:
    """Split points that have this many neighbours into blocks that have about `BLOCK` together."""
    number = np.cumsum(counts) // BLOCK
    for n in np.unique(number):
        yield np.flatnonzero(number == n)
