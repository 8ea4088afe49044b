"""Fewer triangles for a surface, and a proved bound of how far the surface was moved by that.

Edges are collapsed by quadric errors (Garland & Heckbert 1997; `fast_simplification`), which bound nothing. So every
place of the surface as it was is held against the new one (`kernels/fields/deviation`): none is farther away than the
bound. What stays away from the new surface by that bound and more does not touch the old one.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.scene.trees import tree_of_boxes
from sinuous.scene.triangles import THREADS, Integers, boxes_of, with_planes

FIRST = 10
"""Triangles for each one that is kept, in a first try."""

FEWEST = 4
"""Triangles that are kept, at least."""

TRIES = 6
"""Numbers of triangles that are tried, at most."""

WORTH = 0.8
"""Share of the triangles to which a further try must bring them."""

SMALL = 0.7
"""Share of what is allowed, below which a surface is looked at no more closely."""


class Decimated(NamedTuple):
    """A surface of fewer triangles.

    Attributes
    ----------
    vertices, faces : ndarray (v, 3), (f, 3)
    bound : float
        How far any place of the surface before is from this one, at most.
    """

    vertices: Floats
    faces: Integers
    bound: float


def decimate(
    vertices: Floats, faces: Integers, most: float, accept: Callable[[Floats, Integers], bool]
) -> Decimated | None:
    """Find few triangles from which the surface is nowhere farther away than `most`, and that are accepted.

    Returns
    -------
    Decimated or None
        None where no try was better than the surface itself.

    Raises
    ------
    InputError
        When the package is missing.
    """
    simplify = checks.needed("fast_simplification", "mesh", "decimate", most).simplify
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    best: Decimated | None = None
    low, high = 0, len(faces)
    count = max(FEWEST, high // FIRST)
    for _ in range(TRIES):
        places, kept = simplify(vertices - middle, faces.astype(np.int32), target_count=count)
        places, kept = np.asarray(places, np.float64) + middle, np.asarray(kept, np.int64)
        bound = largest_distance(vertices, faces, places, kept, most) if len(kept) else np.inf
        if bound <= most and len(kept) < high and accept(places, kept):
            best, high = Decimated(places, kept, bound), len(kept)
            wanted = int(high * bound / most)  # a bound goes with the square of the edges
        else:
            low, wanted = count, 0
        count = max(FEWEST, low + 1, wanted, int(np.sqrt(max(low, 1) * high)) if low else 0)
        if count > WORTH * high:
            break
    return best


def largest_distance(vertices: Floats, faces: Integers, places: Floats, kept: Integers, most: float) -> float:
    """Upper bound of the distance of a surface to another one, of `places` and `kept`; infinite beyond `most`."""
    from sinuous.kernels.fields import deviation  # noqa: PLC0415

    corners = places[kept]
    order, levels, nodes = tree_of_boxes(corners.mean(axis=1), *boxes_of(corners))
    with np.errstate(invalid="ignore"):  # a triangle without area has no plane: NaN leaves its edges
        items = np.nan_to_num(with_planes(corners[order]))
    row = np.zeros((1, t.OBSTACLE_WIDTH))
    row[0, [t.KIND, t.LEVELS, t.ITEM_COUNT, t.ITEM_KIND, t.ITEMS]] = t.TREE, levels, len(kept), t.TRIANGLES, nodes.size
    store = np.concatenate([nodes.ravel(), items.ravel()])
    items, squares = np.empty(len(vertices), np.int64), np.empty(len(vertices))
    points, sides = np.array(vertices, order="C"), np.array(faces, order="C")

    def find(first: int, last: int) -> None:
        deviation.nearest(row, store, points[first:last], items[first:last], squares[first:last])

    def part(first: int, last: int) -> float:
        stack = np.empty((deviation.DEEPEST + 2, deviation.STACK_SIZE))
        enough = SMALL * most
        return float(
            deviation.largest_distance(row, store, points, sides, items, squares, first, last, enough, most, stack)
        )

    with ThreadPoolExecutor(THREADS) as threads:
        ends = _ends(len(points))
        list(threads.map(find, ends[:-1], ends[1:]))
        if squares.max() > most * most:
            return np.inf
        ends = _ends(len(sides))
        found = max(threads.map(part, ends[:-1], ends[1:]))
    return found + packing.roundoff(np.concatenate([vertices, places]))


def _ends(count: int) -> list[int]:
    """Where the shares of so many things begin, and where the last one ends."""
    return np.linspace(0, count, 4 * THREADS + 1).astype(int).tolist()
