"""Distance to an obstacle that is more than a few numbers: a tree of triangles, balls or cubes, and samples on a grid.

Every query has a mode. In a step of the solver the interpolated samples are good enough. For a proof there is a lower
bound, which the samples give in one evaluation, and the exact distance, which costs a walk through the tree. An
obstacle that has samples alone has no exact distance: its lower bound stands for it.
"""

import math
from typing import Any

import numpy as np

from sinuous.kernels import tables
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.fields import blocks, candidates, discs, grids, trees
from sinuous.kernels.fields.grids import SampleGrid, grid_of
from sinuous.kernels.fields.primitives import Patch
from sinuous.kernels.fields.trees import Tree, box_distance, closest, item_distance, item_slope, lift, tree_of, unlift
from sinuous.kernels.maths.vectors import Array, Vec, add, norm, scale, sub

MODES: Any = np.arange(4)
INTERPOLATED, LOWER_BOUND, EXACT, UPPER_BOUND = MODES
"""Modes of a query: interpolated, as a step of the solver needs it; a lower bound; exact; an upper bound. They are not
int, because Numba would compile once more for each value."""

KNOWN_ROUNDING = 1e-9
"""What a distance that is known may be wrong by, as a share of it."""


def at_item(table: Array, store: Array, i: int, item: int, p: Vec) -> tuple[float, Vec]:
    """Signed distance of `p` to obstacle `i`, and its gradient, where item `item` is the closest."""
    d, g = item_slope(store, tree_of(table, i), item, p, int(table[i, tables.NORMALS]))
    sign = table[i, tables.SIGN]
    return sign * (d - table[i, tables.ROUNDING_RADIUS]), scale(sign, g)


def _find(table: Array, store: Array, i: int, p: Vec, reach: float, known: float) -> tuple[int, float, bool]:
    """Find the item closest to `p`, if it is closer than `reach`; its signed distance may be `known` (else inf).

    Returns its number or -1, its lifted distance, and whether that is the signed one: of a triangle it is where `p` is
    known to be free. Samples tell how far the closest one is at most, and whether `p` is free; only then may a surface
    be left out for being far.
    """
    tree = tree_of(table, i)
    away = reach + table[i, tables.ROUNDING_RADIUS]
    if table[i, tables.FIRST_CELL] >= 0.0:
        cells = grid_of(table, i, tables.FIRST_CELL)
        cell, far = candidates.cell_of(cells, p)
        if cell >= 0:
            return _find_in_cell(table, store, i, p, reach, known, (cells, cell, far))
    if table[i, tables.FIRST_SAMPLE] < 0.0:
        # Out of the box of everything a point is free, whatever it is to.
        free = table[i, tables.NORMALS] < 0.0 or (
            table[i, tables.SIGN] > 0.0 and box_distance(store, tree.nodes + tables.NODE_SIZE, p) > 0.0
        )
        item, d = closest(store, tree, p, lift(away) if free else math.inf)
        return item, d, free
    grid = grid_of(table, i, tables.FIRST_SAMPLE)
    corners, t, beyond = grids.look_up(store, grid, p)
    gap = norm(beyond)
    low = _lowest(table[i, tables.SIGN], corners, t, beyond, grid.spacing)
    if low >= reach:
        return -1, lift(away), True
    most = gap + grids.at_most(corners, t, grid.spacing)
    if tree.kind == tables.TRIANGLES:
        most = gap + _most_surface(corners, t, grid.spacing)
    most += table[i, tables.ROUNDING_RADIUS]
    most += 1e-9 * abs(most)
    free = low > 0.0
    item, d = closest(store, tree, p, lift(min(most, away) if free else most))
    if item < 0 and not (free and away <= most):
        item, d = closest(store, tree, p, math.inf)
    return item, d, free


def _find_in_cell(
    table: Array, store: Array, i: int, p: Vec, reach: float, known: float, where: tuple[SampleGrid, int, float]
) -> tuple[int, float, bool]:
    """The same by a list; `where`: the grid of cells, that of `p` in the store, and how far `p` is from its middle."""
    grid, cell, far = where
    tree = tree_of(table, i)
    away, middle = reach + table[i, tables.ROUNDING_RADIUS], store[cell + candidates.CELL_DISTANCE]
    slack = candidates.DISTANCE_SLACK * (abs(middle) + far)
    low = table[i, tables.SIGN] * (middle - table[i, tables.ROUNDING_RADIUS]) - far - slack
    if low >= reach:
        return -1, lift(away), True
    surface = abs(table[i, tables.SIGN] * known + table[i, tables.ROUNDING_RADIUS])
    most = min(abs(middle) + far + slack, (1.0 + KNOWN_ROUNDING) * surface + slack)
    free = table[i, tables.NORMALS] < 0.0 or low > 0.0
    item, d = candidates.closest(store, tree, grid, (cell, far), p, lift(min(most, away) if free else most))
    if item < 0 and not (free and away <= most):
        item, d = closest(store, tree, p, math.inf)
    return item, d, free


def _most_surface(v: grids.CellCorners, t: Vec, spacing: float) -> float:
    """Upper bound of the distance to the surface, whichever side it is on."""
    return max(grids.at_most(v, t, spacing), -grids.at_least(v, t, spacing))


def _lowest(sign: float, corners: grids.CellCorners, t: Vec, beyond: Vec, spacing: float) -> float:
    """Lower bound by the samples, also out of their grid, which holds the whole obstacle.

    From out of a convex box, every point in it is at an angle of 90 degrees or more to the direction of the box.
    """
    low = grids.set_distance(corners, t, spacing)
    gap = norm(beyond)
    if gap == 0.0:
        return low
    return math.hypot(max(low, 0.0), gap) if sign > 0.0 else low - gap


def _interpolate(sign: float, corners: grids.CellCorners, t: Vec, beyond: Vec, spacing: float) -> tuple[float, Vec]:
    """Distance and gradient by the samples, also out of their grid (see `_lowest`)."""
    d, g = grids.value(corners, t), grids.slope(corners, t, spacing)
    gap = norm(beyond)
    if gap == 0.0:
        return d, g
    along = (g[0] if beyond[0] == 0.0 else 0.0, g[1] if beyond[1] == 0.0 else 0.0, g[2] if beyond[2] == 0.0 else 0.0)
    if sign < 0.0:
        return d - gap, sub(along, scale(1.0 / gap, beyond))
    d = max(d, 0.0)
    far = math.hypot(d, gap)
    return far, scale(1.0 / far, add(beyond, scale(d, along)))


@shared
def evaluate(table: Array, store: Array, i: int, p: Vec, reach: float, mode: int) -> tuple[float, float]:
    """Distance of `p` to obstacle `i`, asked in this mode, and an upper bound of it: the same where it is exact.

    What is not less than `reach` need not be exact: any lower bound that is not less than `reach` either will do.
    """
    exact = mode in (EXACT, UPPER_BOUND)
    if table[i, tables.FIRST_SAMPLE] < 0.0 or (exact and table[i, tables.KIND] == tables.TREE):
        item, d, free = _find(table, store, i, p, reach, math.inf)
        if item < 0:
            return reach, math.inf
        exact_one = unlift(d) - table[i, tables.ROUNDING_RADIUS] if free else at_item(table, store, i, item, p)[0]
        return exact_one, exact_one
    grid = grid_of(table, i, tables.FIRST_SAMPLE)
    corners, t, beyond = grids.look_up(store, grid, p)
    if table[i, tables.KIND] == tables.SAMPLES:
        d = _evaluate_samples(corners, t, norm(beyond), grid.spacing, mode, table[i, tables.EXACT_BELOW])
        return d, d
    if mode == INTERPOLATED:
        d, _ = _interpolate(table[i, tables.SIGN], corners, t, beyond, grid.spacing)
        return d, d
    low = _lowest(table[i, tables.SIGN], corners, t, beyond, grid.spacing)
    return low, grids.at_most(corners, t, grid.spacing) + norm(beyond)


def _evaluate_samples(
    corners: grids.CellCorners, t: Vec, gap: float, spacing: float, mode: int, exact_below: float
) -> float:
    if mode == INTERPOLATED:
        return grids.value(corners, t) - gap
    if mode == UPPER_BOUND:
        return grids.at_most_below(corners, t, spacing, exact_below) + gap
    return grids.at_least(corners, t, spacing) - gap


@shared
def slope(table: Array, store: Array, i: int, p: Vec, reach: float, mode: int, known: float) -> tuple[float, Vec]:
    """Distance of `p` to obstacle `i`, INTERPOLATED or EXACT, and its gradient; `reach` as for `evaluate`.

    `known` is that distance, where it is known already, else infinite.
    """
    kind = table[i, tables.KIND]
    if table[i, tables.FIRST_SAMPLE] < 0.0 or (mode == EXACT and kind == tables.TREE):
        item, _, _ = _find(table, store, i, p, reach, known)
        return at_item(table, store, i, item, p) if item >= 0 else (reach, (0.0, 0.0, 1.0))
    grid = grid_of(table, i, tables.FIRST_SAMPLE)
    corners, t, beyond = grids.look_up(store, grid, p)
    d, g = _interpolate(table[i, tables.SIGN] if kind == tables.TREE else -1.0, corners, t, beyond, grid.spacing)
    if mode == EXACT:
        d = _evaluate_samples(corners, t, norm(beyond), grid.spacing, EXACT, math.inf)
    return d, g


@shared
def bound_patch(table: Array, store: Array, i: int, patch: Patch, deviation: float, reach: float) -> tuple[float, Vec]:
    """Lower bound of the distance to obstacle `i` of all within `deviation` of a patch; -inf where none is known.

    If one point of all that is free: then it all is, because the surface is farther away. Also the gradient, at the
    center, of the distance to what decides. What is not less than `reach` need not be exact.
    """
    tree, g = tree_of(table, i), (0.0, 0.0, 1.0)
    if table[i, tables.KIND] != tables.TREE or (table[i, tables.SIGN] < 0.0 and tree.kind != tables.TRIANGLES):
        return -math.inf, g
    if table[i, tables.FIRST_CELL] >= 0.0:
        away, g = candidates.bound_patch(store, tree, grid_of(table, i, tables.FIRST_CELL), patch)
    else:
        away, g = trees.bound_patch(store, tree, patch, reach + table[i, tables.ROUNDING_RADIUS] + deviation)
    low = away - table[i, tables.ROUNDING_RADIUS] - deviation
    return (low if low > 0.0 else -math.inf), g


@entry
def enclose(table: Array, store: Array, own: Array) -> None:
    """Fill the discs `own` (2 << levels, 8) of the one obstacle, a mesh, see `discs`."""
    discs.enclose(store, tree_of(table, 0), own)


@entry
def sample(table: Array, store: Array, own: Array, work: Array, first: int, last: int, out: Array) -> None:
    """Fill slabs `first` up to, without it, `last` of `out` (nx, ny, nz) with exact distances to the one obstacle.

    Of a mesh `own` (2 << levels, 8) are the discs, else (0, 8). `work` (blocks.WORKSPACE,) is overwritten.
    """
    tree, grid = tree_of(table, 0), grid_of(table, 0, tables.FIRST_SAMPLE)
    if tree.kind == tables.CUBES:
        _sample_by_point(table, store, tree, grid, first, last, out)
        return
    seed, edge = 0, blocks.EDGE
    for i in range(first, last, edge):
        for j in range(0, out.shape[1], edge):
            for k in range(0, out.shape[2], edge):
                for lane in range(blocks.LANES):
                    p = _point(grid, i + lane // (edge * edge), j + lane // edge % edge, k + lane % edge)
                    work[blocks.POINT_X + lane], work[blocks.POINT_Y + lane], work[blocks.POINT_Z + lane] = p
                blocks.closest(store, tree, own, seed, work)
                seed = int(work[blocks.FOUND])
                for a in range(i, min(i + edge, last)):
                    for b in range(j, min(j + edge, out.shape[1])):
                        for c in range(k, min(k + edge, out.shape[2])):
                            item = int(work[blocks.FOUND + ((a - i) * edge + b - j) * edge + c - k])
                            out[a, b, c], _ = at_item(table, store, 0, item, _point(grid, a, b, c))


def _point(grid: SampleGrid, i: int, j: int, k: int) -> Vec:
    return (grid.low[0] + i * grid.spacing, grid.low[1] + j * grid.spacing, grid.low[2] + k * grid.spacing)


def _sample_by_point(
    table: Array, store: Array, tree: Tree, grid: SampleGrid, first: int, last: int, out: Array
) -> None:
    """The same into `out` (i, j, k), point by point.

    What was closest to the neighbour is nearly the closest here, too: hardly anything has to be examined again.
    """
    at_row = at_slab = at = -1
    for i in range(first, last):
        for j in range(out.shape[1]):
            for k in range(out.shape[2]):
                p = _point(grid, i, j, k)
                if k == 0:
                    at = at_slab if j == 0 else at_row
                near = item_distance(store, tree, at, p, math.inf) if at >= 0 else math.inf
                item, _ = closest(store, tree, p, near)
                at = item if item >= 0 else at
                out[i, j, k], _ = at_item(table, store, 0, at, p)
                if k == 0:
                    at_row = at
                if j == 0 and k == 0:
                    at_slab = at
