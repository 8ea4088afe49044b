"""The tree of boxes about all obstacles of a large scene, as `sinuous.kernels.fields.hierarchy` reads it.

An obstacle has a box along its own axes. Where that is long and oblique, the box about it along the axes of the world
would hold next to nothing else than other obstacles, so it is halved first, and again (early split clipping, Ernst &
Greiner 2007). When an obstacle moves, its boxes and those above them are made anew, and the order of the tree stays.
"""

from collections.abc import Collection
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels import tables as t

BOX_NUMBERS = 16
"""Center (3), rotation (9), half extents (3), and how far it extends beyond them (1): as in the row of a primitive."""

WASTE = 2.0
"""Of a box about a box that is halved: its area, of that of what is in it."""

FINE = 0.5
"""Extent of boxes that are not halved, in mean distances of obstacles."""

MORE_BOXES, MOST_HALVES = 3, 16384
"""How many boxes there may be more than obstacles, per obstacle and in all."""

PADDING = 1e-12
"""By how much boxes are larger than what is in them, relative to their coordinates: what arithmetic makes of both."""

LEVEL_WORK = 6
"""Work units of a query for each level of the tree."""

SPHERE_COST = 0.25
"""What the distance to a ball takes, of that to another obstacle: a hierarchy of balls alone is worth while later."""


class _Boxes(NamedTuple):
    """Boxes along axes of their own: the obstacles in them (c,), centers, axes, half extents, rounding (c,)."""

    owners: NDArray[np.int64]
    centers: Floats
    axes: Floats
    half: Floats
    rounding: Floats

    @classmethod
    def read(cls, owners: NDArray[np.int64], boxes: Floats) -> "_Boxes":
        """Take boxes (c, 16) apart."""
        return cls(owners, boxes[:, :3], boxes[:, 3:12].reshape(-1, 3, 3), boxes[:, 12:15], boxes[:, 15])

    def take(self, which: NDArray[np.int64]) -> "_Boxes":
        """Return some of them."""
        return _Boxes._make(own[which] for own in self)

    @property
    def extents(self) -> Floats:
        """Half extents (c, 3) along the axes of the world."""
        extents: Floats = (np.abs(self.axes) @ self.half[:, :, None])[:, :, 0] + self.rounding[:, None]
        return extents

    def halved(self) -> "_Boxes":
        """Return both halves of each, cut across its longest axis: first all of the one, then of the other."""
        each, longest = np.arange(len(self.half)), self.half.argmax(axis=1)
        half = self.half.copy()
        half[each, longest] *= 0.5
        off = half[each, longest, None] * self.axes[each, :, longest]
        twice = self.take(np.tile(each, 2))
        return twice._replace(
            centers=np.concatenate([self.centers - off, self.centers + off]), half=np.tile(half, (2, 1))
        )


def _area(half: Floats) -> Floats:
    """An eighth of the area of boxes with these half extents (c, 3)."""
    x, y, z = half.T
    area: Floats = x * y + y * z + z * x
    return area


def _divided(boxes: _Boxes, most: int) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Halve boxes that waste much, those first that waste most, until there are so many.

    Returns the obstacles in them (c,), and centers and half extents (c, 3) along the axes of the world.
    """
    count, extents = len(boxes.half), boxes.extents
    if count < 2:
        return boxes.owners, boxes.centers, extents
    span = (boxes.centers + extents).max(axis=0) - (boxes.centers - extents).min(axis=0)
    fine = FINE * float(np.prod(np.maximum(span, 1e-3 * span.max())) / count) ** (1.0 / 3.0)
    kept = list[tuple[Any, ...]]()
    while True:
        own = _area(boxes.half + boxes.rounding[:, None])
        wasted = _area(extents) - own
        large = (wasted > (WASTE - 1.0) * own) & (extents.max(axis=1) > fine)
        which = np.flatnonzero(large)
        if len(which) > most - count:
            which = which[np.argsort(-wasted[which], kind="stable")][: most - count]
            large[:] = False
            large[which] = True
        kept.append((boxes.owners[~large], boxes.centers[~large], extents[~large]))
        if not len(which):
            owners, centers, extents = map(np.concatenate, zip(*kept, strict=True))
            return owners, centers, extents
        boxes, count = boxes.take(which).halved(), count + len(which)
        extents = boxes.extents


def _corners(centers: Floats, extents: Floats, roundoff: Floats) -> tuple[Floats, Floats]:
    """Low and high corners (c, 3) of boxes along the axes of the world, `roundoff` (c,) wider."""
    wider = extents + (roundoff + PADDING * (np.abs(centers) + extents + roundoff[:, None]).sum(axis=1))[:, None]
    return centers - wider, centers + wider


def _bounded(rows: Floats, boxes: Floats) -> NDArray[np.bool_]:
    """Which obstacles (m,) lie in a box."""
    ends = np.where(rows[:, t.KIND] < t.TREE, np.isfinite(rows[:, t.EXTENT]), rows[:, t.KIND] == t.TREE)
    return ends & (rows[:, t.SIGN] > 0.0) & np.isfinite(boxes).all(axis=1)


def hierarchy(rows: Floats, boxes: Floats, beside: Collection[int] = ()) -> Floats:
    """Return what the store of a scene begins with: nothing where there are not `MANY_OBSTACLES`.

    Where most of these are balls there is no hierarchy, only a header that says so.

    Parameters
    ----------
    rows : ndarray (m, 33)
    boxes : ndarray (m, 16)
        About each obstacle, along axes of its own; not finite where there is none.
    beside : collection of int
        Obstacles that will move, so that they are kept beside the tree.
    """
    if len(rows) < t.MANY_OBSTACLES:
        return np.zeros(0)
    if SPHERE_COST * len(rows) + (1.0 - SPHERE_COST) * np.count_nonzero(rows[:, t.KIND] != t.SPHERE) < t.MANY_OBSTACLES:
        return np.array([NONE, *[0.0] * (t.HIERARCHY_HEADER - 1)])
    from sinuous.kernels.fields.eight_boxes import EIGHT  # noqa: PLC0415
    from sinuous.kernels.fields.trees import arrange, enclose  # noqa: PLC0415

    inside = _bounded(rows, boxes)
    inside[list(beside)] = False
    owners = np.flatnonzero(inside)
    most = len(owners) + min(MORE_BOXES * len(owners), MOST_HALVES)
    owners, centers, extents = _divided(_Boxes.read(owners, boxes[owners]), most)
    lows, highs = _corners(centers, extents, rows[owners, t.ROUNDOFF])
    count = len(owners)
    levels = max(2, (max(1, count) - 1).bit_length())
    order, nodes = np.arange(count), np.empty((2 << levels, t.NODE_SIZE))
    arrange(centers.copy(), levels, order)
    enclose(lows, highs, order, levels, nodes)
    header = np.zeros(t.HIERARCHY_HEADER)
    aside = np.flatnonzero(~inside)
    header[[t.HIERARCHY_OBSTACLES, t.HIERARCHY_LEVELS]] = len(rows), levels
    header[[t.HIERARCHY_BOXES, t.HIERARCHY_BESIDE]] = count, len(aside)
    _sum_up(header, rows, aside)
    return np.concatenate([header, aside, owners[order], nodes.reshape(-1, EIGHT, t.NODE_SIZE).swapaxes(1, 2).ravel()])


def _sum_up(header: Floats, rows: Floats, aside: NDArray[np.int64]) -> None:
    """Write into the header what holds for all obstacles."""
    from sinuous.kernels.clock import TREE_WORK  # noqa: PLC0415

    trees = rows[:, t.KIND] >= t.TREE
    sampled = rows[trees & (rows[:, t.FIRST_SAMPLE] >= 0.0)]
    most = TREE_WORK if trees.any() else 1
    work = LEVEL_WORK * (1 + header[t.HIERARCHY_LEVELS]) + 2 * most + np.where(trees[aside], TREE_WORK, 1).sum()
    header[t.HIERARCHY_WORK] = work
    header[t.HIERARCHY_ROUNDOFF] = rows[:, t.ROUNDOFF].max()
    header[t.HIERARCHY_SPACING] = sampled[:, t.SPACING].max(initial=0.0)


NONE = -1.0
"""The number of obstacles in the header of a scene whose hierarchy would not be worth while."""


NEAR, FAR = 1.5, 4.0
"""Distance up to which cells list all obstacles, and from which on they list none, in radii of the body."""

MOST_CELLS, MOST_NUMBERS = 1 << 17, 1 << 21
"""How many cells there are at most, and of how many numbers they and their lists are."""


def with_cells(rows: Floats, store: Floats, box: Floats, radius: float) -> Floats:
    """Return the store of a scene that has a hierarchy, with cells that list who is near, in a box (2, 3).

    `radius` is that of the body, with which distances are compared.
    """
    from sinuous.kernels.fields.scene_cells import PENDING, list_near  # noqa: PLC0415

    header = store[: t.HIERARCHY_HEADER]
    own = store[: int(header[t.HIERARCHY_CELLS]) or len(store)]
    first, count = t.HIERARCHY_HEADER + int(header[t.HIERARCHY_BESIDE]), int(header[t.HIERARCHY_BOXES])
    owners = np.unique(own[first : first + count].astype(np.int64))
    cell = np.append(box.mean(axis=0), 0.5 * (box[1] - box[0]).max())
    reaches, pending, memory = np.array([NEAR, FAR]) * radius, np.empty((MOST_CELLS, PENDING)), np.empty(MOST_NUMBERS)
    used = list_near(rows, own, owners, cell, reaches, pending, memory)
    made = np.concatenate([own, memory[:used]])
    made[t.HIERARCHY_CELLS] = len(own)
    return made


def bounds(store: Floats) -> Floats:
    """Low and high corner (2, 3) of the tree of a scene that has a hierarchy: of all in it."""
    corners: Floats = _nodes(store)[0, :, 1].reshape(2, 3)
    return corners


def _nodes(store: Floats) -> Floats:
    """Boxes of the tree of a scene that has a hierarchy, a view: box 8 i + j is [i, :, j]."""
    from sinuous.kernels.fields.eight_boxes import EIGHT  # noqa: PLC0415

    begin = t.HIERARCHY_HEADER + int(store[t.HIERARCHY_BESIDE] + store[t.HIERARCHY_BOXES])
    end = begin + (t.NODE_SIZE << (1 + int(store[t.HIERARCHY_LEVELS])))
    return store[begin:end].reshape(-1, t.NODE_SIZE, EIGHT)


def without_cells(group: Floats) -> Floats:
    """Return what kernels read of a scene without its cells, if it has any: they are the last in it; not a copy."""
    rows, store = packing.scene_parts(group)
    cells = int(store[t.HIERARCHY_CELLS]) if len(rows) >= t.MANY_OBSTACLES else 0
    return group[: len(group) - len(store) + cells] if cells else group


def is_worn(store: Floats, obstacles: int) -> bool:
    """Whether so many obstacles were changed that a new hierarchy is worth while."""
    return bool(store[t.HIERARCHY_CHANGES] >= max(t.MANY_OBSTACLES, obstacles // 8))


def refit(rows: Floats, store: Floats, index: int, box: Floats) -> bool:
    """Write into the hierarchy of a scene that one of its obstacles, whose row is there already, is in this box (16,).

    Returns whether that goes: not where it was in the tree and has no box now, or the other way round.
    """
    header = store[: t.HIERARCHY_HEADER]
    header[t.HIERARCHY_CELLS] = 0.0
    if header[t.HIERARCHY_OBSTACLES] == NONE:
        return bool(rows[index, t.KIND] == t.SPHERE)
    first, count = t.HIERARCHY_HEADER + int(header[t.HIERARCHY_BESIDE]), int(header[t.HIERARCHY_BOXES])
    beside = store[t.HIERARCHY_HEADER : first].astype(np.int64)
    inside = bool(_bounded(rows[index : index + 1], box[None])[0])
    if inside == bool((beside == index).any()):
        return False
    if rows[index, t.KIND] >= t.TREE:
        _sum_up(header, rows, beside)
    header[t.HIERARCHY_ROUNDOFF] = max(header[t.HIERARCHY_ROUNDOFF], rows[index, t.ROUNDOFF])
    if inside:
        header[t.HIERARCHY_CHANGES] += 1.0
        places = np.flatnonzero(store[first : first + count] == index)
        _put(_nodes(store), places, count, box, float(rows[index, t.ROUNDOFF]))
    return True


def _put(nodes: Floats, places: NDArray[np.int64], count: int, box: Floats, roundoff: float) -> None:
    """Put a box (16,), divided, into so many places of the leaves, and make the boxes above them anew."""
    own = _Boxes.read(np.zeros(1, np.int64), box[None])
    while 2 * len(own.half) <= len(places):
        own = own.halved()
    lows, highs = _corners(own.centers, own.extents, np.full(len(own.half), roundoff))
    leaves = nodes.shape[0] * nodes.shape[2] >> 1
    # Leaf j of all has the boxes from (j count) >> levels on: at most one.
    at = leaves + (((places + 1) * leaves - 1) // count)
    which = np.arange(len(places)) % len(lows)
    nodes[at >> 3, :3, at & 7], nodes[at >> 3, 3:, at & 7] = lows[which], highs[which]
    while len(at) and at[0] > 1:
        at = at >> 1
        block, left = at >> 2, 2 * at & 7
        nodes[at >> 3, :3, at & 7] = np.minimum(nodes[block, :3, left], nodes[block, :3, left + 1])
        nodes[at >> 3, 3:, at & 7] = np.maximum(nodes[block, 3:, left], nodes[block, 3:, left + 1])
