"""Exact distances at the points of a grid about an obstacle: what its samples are made of."""

import math

from sinuous.kernels import tables
from sinuous.kernels.compile import entry
from sinuous.kernels.fields import blocks, discs
from sinuous.kernels.fields.grids import SampleGrid, grid_of
from sinuous.kernels.fields.solids import at_item
from sinuous.kernels.fields.trees import Tree, closest, item_distance, tree_of
from sinuous.kernels.maths.vectors import Array, Vec


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
    """The same, point by point.

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
