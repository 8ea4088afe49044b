"""Cells that a flat wall cuts in two.

A cell that a box passes right through, with all other obstacles far from it, need not be divided: on either side of the
box all of it can be passed but for what is too near to the box, and nothing leads from one side to the other. So it has
two halves, each a cell of its own in the search. That holds for a half-space too, of which one half is never reached.
"""

from sinuous.kernels.fields.distances import Scene, evaluate, is_large, search
from sinuous.kernels.freespace.cells import NONE
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid, corners
from sinuous.kernels.maths.vectors import Vec, add, add_scaled, dot, get_mat, get_vec, scale, sub, vec_mat
from sinuous.kernels.tables import AXES, BOX, CENTER, HALF_EXTENTS, HALF_SPACE, KIND, ROUNDING_RADIUS, SIGN

LEAST_CUT_CLEARANCE = 1.0
"""Least clearance, in edges of the finest cells, with which no cell on one side of a wall reaches to the other side."""


def _axis_across(scene: Scene, i: int, p: Vec, edge: float, spare: float) -> int:
    """The axis of obstacle `i` along which it cuts a cube about `p` in two, with so much to spare; or NONE."""
    rotation = get_mat(scene.table, i, AXES)
    off = vec_mat(sub(p, get_vec(scene.table, i, CENTER)), rotation)
    if scene.table[i, KIND] == HALF_SPACE:
        return 2
    half = get_vec(scene.table, i, HALF_EXTENTS)
    a, b, c = rotation
    spans = (
        half[0] - abs(off[0]) >= 0.5 * edge * (abs(a[0]) + abs(b[0]) + abs(c[0])) + spare,
        half[1] - abs(off[1]) >= 0.5 * edge * (abs(a[1]) + abs(b[1]) + abs(c[1])) + spare,
        half[2] - abs(off[2]) >= 0.5 * edge * (abs(a[2]) + abs(b[2]) + abs(c[2])) + spare,
    )
    if spans[0] and spans[1]:
        return 2
    if spans[1] and spans[2]:
        return 0
    return 1 if spans[0] and spans[2] else NONE


def find_cut(grid: SearchGrid, scene: Scene, p: Vec, edge: float, which: int) -> int:
    """Say how obstacle `which`, the nearest to its middle `p`, cuts a cell in two: 3 times its number, and the axis.

    NONE where it does not, or where another obstacle is so near that not all of the rest can be passed.
    """
    kind = scene.table[which, KIND]
    if (
        kind not in (BOX, HALF_SPACE)
        or scene.table[which, SIGN] < 0.0
        or grid.clearance < LEAST_CUT_CLEARANCE * grid.cell
    ):
        return NONE
    axis = _axis_across(scene, which, p, edge, 2.0 * HALF_DIAGONAL * grid.cell)
    if axis == NONE:
        return NONE
    enough = HALF_DIAGONAL * (edge - grid.cell) + grid.ample
    if is_large(scene):
        return NONE if search(scene, p, enough, grid.mode, 0.0, which)[2] >= 0 else 3 * which + axis
    for i in range(scene.table.shape[0]):
        if i != which and evaluate(scene, i, p, enough, grid.mode)[0] < enough:
            return NONE
    return 3 * which + axis


def _wall_normal(scene: Scene, cut: int) -> Vec:
    """Unit normal of a wall."""
    a, b, c = get_mat(scene.table, cut // 3, AXES)
    axis = cut % 3
    if axis == 0:
        return a[0], b[0], c[0]
    return (a[1], b[1], c[1]) if axis == 1 else (a[2], b[2], c[2])


def distance_beyond(scene: Scene, cut: int, side: int, p: Vec) -> float:
    """How far the point `p` is from the face of a wall on a side of it; negative on the other one, and in the wall."""
    i = cut // 3
    thick = 0.0 if scene.table[i, KIND] == HALF_SPACE else scene.table[i, HALF_EXTENTS + cut % 3]
    off = dot(sub(p, get_vec(scene.table, i, CENTER)), _wall_normal(scene, cut))
    return (2.0 * side - 1.0) * off - thick - scene.table[i, ROUNDING_RADIUS]


def side_of(scene: Scene, cut: int, p: Vec) -> int:
    """On which side of a wall a point is: 0 or 1."""
    return 1 if distance_beyond(scene, cut, 1, p) > distance_beyond(scene, cut, 0, p) else 0


def place_beside(scene: Scene, cut: int, side: int, p: Vec, far: float) -> Vec:
    """The point on a side of a wall that is nearest to `p`, and so far from the wall."""
    lacking = far - distance_beyond(scene, cut, side, p)
    return p if lacking <= 0.0 else add_scaled(p, (2.0 * side - 1.0) * lacking, _wall_normal(scene, cut))


def common_box(grid: SearchGrid, one: int, other: int) -> tuple[Vec, Vec]:
    """Low and high corner of what two cells that touch have in common."""
    a, b = corners(grid, one)
    c, d = corners(grid, other)
    low = max(a[0], c[0]), max(a[1], c[1]), max(a[2], c[2])
    return low, (min(b[0], d[0]), min(b[1], d[1]), min(b[2], d[2]))


def _can_be_passed(grid: SearchGrid, scene: Scene, cut: int, side: int, low: Vec, high: Vec) -> bool:
    """Whether between two corners there is a point that can be passed, on a side of a wall."""
    a, b, c = _wall_normal(scene, cut)
    x, y, z = sub(high, low)
    reach = 0.5 * (abs(a) * x + abs(b) * y + abs(c) * z)
    return distance_beyond(scene, cut, side, scale(0.5, add(low, high))) + reach >= grid.clearance


def linked(grid: SearchGrid, scene: Scene, one: tuple[int, int, int], other: tuple[int, int, int]) -> bool:
    """Whether a route leads from one cell to another that it touches: each by its key, its cut, and the side of it.

    A wall cuts one of both at least. From one finest cell to the next one it leads by the middle between both, which
    belongs to both cells and is as far from a wall as they are.
    """
    if one[1] == other[1] and one[2] != other[2]:
        return False
    low, high = common_box(grid, one[0], other[0])
    if one[1] != NONE and not _can_be_passed(grid, scene, one[1], one[2], low, high):
        return False
    return other[1] == NONE or _can_be_passed(grid, scene, other[1], other[2], low, high)
