"""Places that a route may turn at: beside the edges of boxes and meshes.

A shortest path among polyhedra turns at their edges alone (Lozano-Perez & Wesley 1979). A place lies so far off an edge
that a ball passes, and is pushed to where there is more room: in a door, to its middle.

`places` (P, 3) are those that were noted.
"""

import math

from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import Scene, closest, obstacle, work_of_all
from sinuous.kernels.fields.primitives import axis_of
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.grid import SearchGrid
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, get_vec, norm, put_vec, scale, sub
from sinuous.kernels.tables import BOX, CENTER, HALF_EXTENTS, KIND, ROUNDING_RADIUS, SIGN

EDGE_OFFSET = 1.15
"""Distance of a place from both faces of its edge."""

PUSHED_CLEARANCE, LEAST_CLEARANCE = 1.5, 1.0
"""Distance from the obstacles that places are pushed to, and that they must have. All in radii of the body."""

ALIKE = 0.5
"""Distance of two places that count as one, in radii: boxes that touch have the same edges."""

PLACE_PUSHES = 6
"""How often a place is pushed."""


def _push_place(scene: Scene, radius: float, p: Vec) -> tuple[Vec, float]:
    """Push a place to where there is more room; returns it, and its distance from the obstacles."""
    best, most = p, -math.inf
    for _ in range(PLACE_PUSHES):
        d, which = closest(scene, p, PUSHED_CLEARANCE * radius, INTERPOLATED)
        if d > most:
            best, most = p, d
        if which < 0 or d < 0.0 or d >= PUSHED_CLEARANCE * radius:
            break
        _, g = obstacle(scene, which, p, d)
        p = add_scaled(p, PUSHED_CLEARANCE * radius - d, g)
    return best, most


def _add_place(scene: Scene, grid: SearchGrid, places: Array, count: int, p: Vec, clock: Array) -> int:
    """Note a place, if a ball has room there; returns how many there are."""
    if count == places.shape[0] or spend(clock, 2 * work_of_all(scene)):
        return count
    p, d = _push_place(scene, grid.radius, p)
    far = norm(sub(p, grid.start)) + norm(sub(p, grid.goal))
    if d < LEAST_CLEARANCE * grid.radius or far > grid.longest:
        return count
    near = (ALIKE * grid.radius) ** 2
    for i in range(2, count):
        away = sub(p, get_vec(places, i, 0))
        if dot(away, away) < near:
            return count
    put_vec(places, count, 0, p)
    return count + 1


def _nearest_to_line(grid: SearchGrid, p: Vec, axis: Vec, half: float) -> float:
    """How far along an edge, from its middle `p`, it is nearest to the straight line between both ends."""
    line = sub(grid.goal, grid.start)
    w = sub(p, grid.start)
    a, b, d, e = dot(line, line), dot(line, axis), dot(line, w), dot(axis, w)
    across_both = a - b * b
    if across_both <= 1e-9 * a:
        return 0.0
    return min(half, max(-half, (b * d - a * e) / across_both))


def _add_edge(
    scene: Scene, grid: SearchGrid, places: Array, count: int, edge: tuple[Vec, Vec, float], clock: Array
) -> int:
    """Note two places along an edge, of which the middle, moved off, the unit axis and half the length are given."""
    p, axis, half = edge
    count = _add_place(scene, grid, places, count, p, clock)
    nearest = _nearest_to_line(grid, p, axis, half)
    if abs(nearest) > grid.radius:
        count = _add_place(scene, grid, places, count, add_scaled(p, nearest, axis), clock)
    return count


def _add_box(scene: Scene, grid: SearchGrid, places: Array, count: int, i: int, clock: Array) -> int:
    """Note places beside the twelve edges of a box."""
    middle, off = get_vec(scene.table, i, CENTER), EDGE_OFFSET * grid.radius + scene.table[i, ROUNDING_RADIUS]
    half = get_vec(scene.table, i, HALF_EXTENTS)
    for along in range(3):
        u, v = (along + 1) % 3, (along + 2) % 3
        to_u = scale(scene.table[i, HALF_EXTENTS + u] + off, axis_of(scene.table, i, u))
        to_v = scale(scene.table[i, HALF_EXTENTS + v] + off, axis_of(scene.table, i, v))
        length = half[0] if along == 0 else half[1] if along == 1 else half[2]
        for corner in range(4):
            p = add_scaled(middle, -1.0 if corner & 1 else 1.0, to_u)
            p = add_scaled(p, -1.0 if corner & 2 else 1.0, to_v)
            count = _add_edge(scene, grid, places, count, (p, axis_of(scene.table, i, along), length), clock)
    return count


def put_places(scene: Scene, grid: SearchGrid, edges: Array, places: Array, clock: Array) -> int:
    """Fill `places` (m, 3), as far as the time allows: start, goal, and all others; returns how many there are.

    Of edges (e, 10), other than those of boxes, the middle is given, the way off both faces by one, the unit axis, and
    half of the length.
    """
    put_vec(places, 0, 0, grid.start)
    put_vec(places, 1, 0, grid.goal)
    count = 2
    for i in range(scene.table.shape[0]):
        if scene.table[i, KIND] == BOX and scene.table[i, SIGN] > 0.0:
            count = _add_box(scene, grid, places, count, i, clock)
    for i in range(edges.shape[0]):
        p = add_scaled(get_vec(edges, i, 0), EDGE_OFFSET * grid.radius, get_vec(edges, i, 3))
        count = _add_edge(scene, grid, places, count, (p, get_vec(edges, i, 6), edges[i, 9]), clock)
    return count
