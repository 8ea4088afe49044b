"""Whether a ball can be moved straight from one place to another.

`triangles` (f, 12) are those of meshes: a corner, two sides from there, and the normal.
"""

import math

from sinuous.kernels.fields.distances import Scene, closest, is_large, work_of_all
from sinuous.kernels.fields.hierarchy import crossed_leaf, item_of, tree_over
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.grid import SearchGrid
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, cross, dot, get_mat, get_vec, norm, sub, vec_mat
from sinuous.kernels.tables import AXES, BOX, CENTER, HALF_EXTENTS, HIERARCHY_HEADER, KIND, SIGN

LINE_CLEARANCE = 0.95
"""Distance from the obstacles that a straight line keeps, in radii of the body: where it is less, a band that is drawn
along it still finds more."""

SHORTEST_STEP = 0.15
"""Shortest step along a line, in radii of the body."""

MOST_STEPS = 8192
"""Most steps along a line."""


def _clip_to_slab(low: float, high: float, p: float, line: float, half: float) -> tuple[float, float]:
    """The part from `low` to `high` of a line that is within a slab, given its origin and its direction across it."""
    if line == 0.0:
        return (low, high) if abs(p) < half else (low, -math.inf)
    one, other = (-half - p) / line, (half - p) / line
    return max(low, min(one, other)), min(high, max(one, other))


def _box_cuts(scene: Scene, i: int, a: Vec, line: Vec) -> bool:
    """Whether box `i` cuts the straight line from `a` on."""
    axes = get_mat(scene.table, i, AXES)
    p, way = vec_mat(sub(a, get_vec(scene.table, i, CENTER)), axes), vec_mat(line, axes)
    half = get_vec(scene.table, i, HALF_EXTENTS)
    low, high = _clip_to_slab(0.0, 1.0, p[0], way[0], half[0])
    low, high = _clip_to_slab(low, high, p[1], way[1], half[1])
    low, high = _clip_to_slab(low, high, p[2], way[2], half[2])
    return low < high


def _is_box_that_cuts(scene: Scene, i: int, a: Vec, line: Vec) -> bool:
    """Whether obstacle `i` is a box that cuts the straight line from `a` on."""
    return bool(scene.table[i, KIND] == BOX and scene.table[i, SIGN] > 0.0 and _box_cuts(scene, i, a, line))


def _box_among_many(scene: Scene, a: Vec, line: Vec) -> int:
    """The first box that cuts the straight line from `a` on, in a large scene; -1: none does."""
    tree, node, which = tree_over(scene.store), 0, -1
    for at in range(HIERARCHY_HEADER, tree.items):  # those that move
        i = int(scene.store[at])
        if (which < 0 or i < which) and _is_box_that_cuts(scene, i, a, line):
            which = i
    while True:
        node = crossed_leaf(scene.store, tree, node, a, line, 0.0)
        if node == 0:
            return which
        i = int(scene.store[item_of(tree, node)])
        if (which < 0 or i < which) and _is_box_that_cuts(scene, i, a, line):
            which = i


def _crosses(triangles: Array, i: int, a: Vec, line: Vec) -> bool:
    """Whether the straight line from `a` on crosses triangle `i` (Moeller & Trumbore 1997).

    Most triangles have both ends of it on one side.
    """
    off, normal = sub(a, get_vec(triangles, i, 0)), get_vec(triangles, i, 9)
    above, rise = dot(normal, off), dot(normal, line)
    if above * (above + rise) > 0.0 or rise == 0.0:
        return False
    u, v = get_vec(triangles, i, 3), get_vec(triangles, i, 6)
    across, along = cross(line, v), cross(off, u)
    s, t = -dot(off, across) / rise, -dot(line, along) / rise
    return s >= 0.0 and t >= 0.0 and s + t <= 1.0


def is_cut_by(scene: Scene, triangles: Array, which: int, a: Vec, b: Vec) -> bool:
    """Whether something, numbered as `find_cutting` does it (-1: nothing), cuts the straight line from `a` to `b`."""
    if which < 0:
        return False
    line, obstacles = sub(b, a), scene.table.shape[0]
    return _crosses(triangles, which - obstacles, a, line) if which >= obstacles else _box_cuts(scene, which, a, line)


def _find_cutting_among_all(scene: Scene, triangles: Array, a: Vec, line: Vec) -> int:
    """What cuts the straight line from `a` on, of all, see `find_cutting`."""
    obstacles = scene.table.shape[0]
    if is_large(scene):
        which = _box_among_many(scene, a, line)
        if which >= 0:
            return which
    else:
        for i in range(obstacles):
            if _is_box_that_cuts(scene, i, a, line):
                return i
    for i in range(triangles.shape[0]):
        if _crosses(triangles, i, a, line):
            return obstacles + i
    return -1


def find_cutting(scene: Scene, triangles: Array, a: Vec, b: Vec, recent: Array) -> tuple[int, int]:
    """Say what cuts the straight line from `a` to `b`: a box, or a triangle; -1: nothing. And how many were asked.

    Boxes have their numbers among the obstacles, triangles (t, 12) the numbers after those of all obstacles; each is a
    corner, the ways from there to both others, and the cross product of these. What cut other lines, `recent` (r,)
    int64 (-1: nothing), is asked first: a room has few walls.
    """
    which, at = -1, 0
    for k in range(recent.shape[0]):
        at = k
        if recent[k] < 0:
            break
        if is_cut_by(scene, triangles, recent[k], a, b):
            which = recent[k]
            break
    asked = at + 1
    if which < 0:
        asked += triangles.shape[0] + (work_of_all(scene) if is_large(scene) else scene.table.shape[0])
        which = _find_cutting_among_all(scene, triangles, a, sub(b, a))
    if which >= 0:
        for k in range(at, 0, -1):
            recent[k] = recent[k - 1]
        recent[0] = which
    return int(which), asked


def in_sight(scene: Scene, grid: SearchGrid, a: Vec, b: Vec) -> tuple[bool, int]:
    """Whether a ball can be moved straight from `a` to `b`; and the evaluations that took."""
    line, clear = sub(b, a), LINE_CLEARANCE * grid.radius
    length = norm(line)
    gone, units = 0.0, 0
    while gone < length:
        p = add_scaled(a, gone / length, line)
        d, _ = closest(scene, p, clear + length - gone, INTERPOLATED)
        units += 1
        if d < clear:
            return False, units
        gone += max(d - clear, SHORTEST_STEP * grid.radius, length / MOST_STEPS)
    return True, units
