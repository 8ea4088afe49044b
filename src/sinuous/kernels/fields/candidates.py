"""Which triangles of a mesh may be the closest to a point: listed for every cell of a grid.

A large triangle that lies oblique to the axes has a box as large as the mesh, and a tree of such boxes leaves out next
to nothing. Of a cell with the radius r about its middle, only triangles that are no more than 2 r farther from the
middle than the closest one can be the closest to a point in it. They are in the order of that distance, so that a query
ends as soon as all that follow are too far.

`work` (r, c) has two rows for each level of the search: numbers of c triangles at most, and their distances.
"""

import math

from sinuous.kernels.compile import entry
from sinuous.kernels.fields import trees, triangles
from sinuous.kernels.fields.grids import SampleGrid, grid_of
from sinuous.kernels.fields.primitives import Patch, patch_size
from sinuous.kernels.fields.trees import Tree, item_beside, tree_of, unlift
from sinuous.kernels.maths.vectors import Array, Vec, norm, sub
from sinuous.kernels.tables import FIRST_CELL, NORMALS, TRIANGLE_SIZE

CELL_SIZE, LIST_FIRST, LIST_NUMBER, CELL_DISTANCE = 3, 0, 1, 2
"""Numbers of a cell: where its list begins, counted from the first cell; how many are in it, negative where others are
left out; and the signed distance of its middle from the mesh."""

LISTED = 128
"""Most triangles of a list. Where some are left out, and all that are in it are too near to the middle to tell, the
tree is asked, which takes as long as some hundred triangles."""

LESS = 2.0**-43
"""What is taken off a distance in an entry, as a share of the `span`, so that rounding never makes it larger: there are
fewer than 512 triangles."""

BLOCK = 4
"""Cells of a block along each axis: what cannot be the closest in any of them is left out once for all."""

DISTANCE_SLACK = 1e-9
"""What distances from middles may be wrong by, as a share of them."""

WORK = 4
"""Rows that a list is made in: numbers and distances of triangles, those of a block, then those of a cell."""


def middle(grid: SampleGrid, i: float, j: float, k: float) -> Vec:
    """Middle of a cell."""
    return grid.low[0] + i * grid.spacing, grid.low[1] + j * grid.spacing, grid.low[2] + k * grid.spacing


def _index(x: float, count: int) -> int:
    """Cell of a coordinate, in cells from the middle of the first one; -1: none."""
    return min(int(x + 0.5), count - 1) if -0.5 < x < count - 0.5 else -1  # also where it is NaN


def cell_of(grid: SampleGrid, p: Vec) -> tuple[int, float]:
    """Where the cell of `p` is in the store (-1: `p` is in none), and how far `p` is from its middle."""
    per = 1.0 / grid.spacing
    i = _index((p[0] - grid.low[0]) * per, grid.shape[0])
    j = _index((p[1] - grid.low[1]) * per, grid.shape[1])
    k = _index((p[2] - grid.low[2]) * per, grid.shape[2])
    if i < 0 or j < 0 or k < 0:
        return -1, math.inf
    number = (i * grid.shape[1] + j) * grid.shape[2] + k
    return grid.at + CELL_SIZE * number, norm(sub(p, middle(grid, i, j, k)))


def span(grid: SampleGrid) -> float:
    """More than any triangle of a list is away from the middle of its cell."""
    return grid.spacing * (grid.shape[0] + grid.shape[1] + grid.shape[2] + 4)


def listed(entry: float, span: float) -> tuple[int, float]:
    """Return the triangle of an entry, and how far it is from the middle of the cell: hardly less than that."""
    item = int(entry)
    return item, (entry - item) * span


def closest(
    store: Array, tree: Tree, grid: SampleGrid, cell: tuple[int, float], p: Vec, best: float
) -> tuple[int, float]:
    """Find the triangle closest to `p`, if it is closer than `best` (lifted): its number or -1, and how far it is.

    `cell` is that of `p`, see `cell_of`.
    """
    found, reach, most = -1, unlift(best) + cell[1], span(grid)
    first, number = grid.at + int(store[cell[0] + LIST_FIRST]), int(store[cell[0] + LIST_NUMBER])
    for at in range(first, first + abs(number)):
        item, from_middle = listed(store[at], most)
        if from_middle >= reach:
            return found, best
        d = triangles.square_distance(store, tree.items + TRIANGLE_SIZE * item, p, best)
        if d < best:
            found, best, reach = item, d, math.sqrt(d) + cell[1]
    if number > 0:
        return found, best
    other, d = trees.closest(store, tree, p, best)
    return (found, best) if other < 0 else (other, d)


def bound_patch(store: Array, tree: Tree, grid: SampleGrid, patch: Patch) -> tuple[float, Vec]:
    """Lower bound of the distance of a patch from the surface; -inf: none known.

    Also the gradient, at the center, of the distance to the triangle that decides.
    """
    g = (0.0, 0.0, 1.0)
    cell, far = cell_of(grid, patch.center)
    if cell < 0:
        return -math.inf, g
    first, number = grid.at + int(store[cell + LIST_FIRST]), int(store[cell + LIST_NUMBER])
    if number == 0:
        return -math.inf, g
    size, least, most = patch_size(patch), math.inf, span(grid)
    unlisted = listed(store[first], most)[1] + math.sqrt(3.0) * grid.spacing
    if number < 0:
        unlisted = min(unlisted, listed(store[first - number - 1], most)[1])
    for at in range(first, first + abs(number)):
        item, from_middle = listed(store[at], most)
        if from_middle - far - size >= least:
            return least, g
        low, own = item_beside(store, tree, item, patch, size)
        if low < least:
            least, g = low, own
    return min(least, unlisted - far - size), g


def _near(store: Array, tree: Tree, p: Vec, radius: float, count: int, work: Array, row: int) -> int:
    """Put those of `count` triangles into two rows of `work` that may be the closest within `radius` of `p`.

    Those to choose from are in the two rows before; from row 0 on, they are all. Returns how many they are.
    """
    least, number = math.inf, 0
    for a in range(count):
        item = a if row == 0 else int(work[row - 2, a])
        d = math.sqrt(triangles.square_distance(store, tree.items + TRIANGLE_SIZE * item, p, math.inf))
        work[row, a], work[row + 1, a] = item, d
        least = min(least, d)
    for a in range(count):
        if work[row + 1, a] <= (1.0 + DISTANCE_SLACK) * (least + 2.0 * radius):
            work[row, number], work[row + 1, number] = work[row, a], work[row + 1, a]
            number += 1
    return number


def _sort(work: Array, count: int) -> None:
    """Put the first `count` triangles of the last two rows in the order of their distances."""
    for a in range(1, count):
        item, d, b = work[2, a], work[3, a], a
        while b > 0 and work[3, b - 1] > d:
            work[2, b], work[3, b] = work[2, b - 1], work[3, b - 1]
            b -= 1
        work[2, b], work[3, b] = item, d


def _fill(work: Array, count: int, most: float, cell: Array, lists: Array) -> int:
    """Fill the number of a cell (3,), and its list, of the `count` triangles in the last two rows; say how many fit.

    `lists` (l,) is what there is room for; `most` is the `span`.
    """
    number = min(count, LISTED, lists.shape[0])
    for e in range(number):
        lists[e] = work[2, e] + max(0.0, work[3, e] / most - LESS)
    cell[LIST_NUMBER] = number if number == count else -number
    return number


@entry
def list_candidates(table: Array, store: Array, work: Array, cells: Array, lists: Array) -> int:
    """Fill `cells` (nx, ny, nz, 3) and `lists` (l,) of the one obstacle, a mesh of m triangles, m < 512.

    `work` (4, m) is scratch. An entry of a list is the number of a triangle, and how far it is from the middle of the
    cell as a share of the `span`. Returns how many entries all lists have.
    """
    tree, grid, normals = tree_of(table, 0), grid_of(table, 0, FIRST_CELL), int(table[0, NORMALS])
    (nx, ny, nz), most = grid.shape, span(grid)
    radius, off = 0.5 * math.sqrt(3.0) * grid.spacing, 0.5 * (BLOCK - 1)
    used = 0
    for a in range(0, nx, BLOCK):
        for b in range(0, ny, BLOCK):
            for c in range(0, nz, BLOCK):
                about = middle(grid, a + off, b + off, c + off)
                count = _near(store, tree, about, BLOCK * radius, tree.count, work, 0)
                for i in range(a, min(a + BLOCK, nx)):
                    for j in range(b, min(b + BLOCK, ny)):
                        for k in range(c, min(c + BLOCK, nz)):
                            p = middle(grid, i, j, k)
                            number = _near(store, tree, p, radius, count, work, 2)
                            _sort(work, number)
                            nearest = int(work[2, 0])
                            at = tree.items + TRIANGLE_SIZE * nearest
                            cells[i, j, k, CELL_DISTANCE], _ = triangles.signed(store, at, normals, nearest, p)
                            cells[i, j, k, LIST_FIRST] = cells.size + used
                            used += _fill(work, number, most, cells[i, j, k], lists[used:])
    return used
