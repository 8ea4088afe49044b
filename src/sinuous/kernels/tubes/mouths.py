"""Tubes that open beside sharp edges: the rims of their mouths. A route through them need not be searched for inside.

Beside each edge, on the far side of each of its faces, it is looked whether there are walls all around. If so, the tube
there is followed both ways.
"""

import math

from sinuous.kernels.clock import allow, begin, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, coarseness, price, read_scene
from sinuous.kernels.fields.primitives import axis_of
from sinuous.kernels.fields.solids import EXACT, STEP
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, cross, get_vec, norm, put_vec, scale, sub
from sinuous.kernels.tables import BOX, CENTER, HALF_EXTENTS, KIND, ROUNDING, SIGN
from sinuous.kernels.tubes.axis import (
    BRANCH,
    COARSE,
    MOUTH,
    NO_TUBE,
    RAYS,
    UNENDED,
    follow_from,
    next_beside,
    reach,
    reversed_from,
)

OFF, INTO = 1.15, 1.5
"""How far off one face of an edge, and behind the other, a tube is looked for."""

LEAST = 0.85
"""Distance from the obstacles that there must be."""

SHORTEST = 4.0
"""Length that a tube has at least."""

VAIN, APART = 40, 0.3
"""Most places that are looked at in vain; and how near to one no other is looked at, of `KNOWN`."""

KNOWN = 2.0
"""How near to the axis of a known tube no other one is looked for. All lengths in radii of the body."""

Edge = tuple[Vec, Vec, Vec]
"""A place on an edge, and the unit normals of both its faces."""

Found = tuple[int, int, int]
"""How many tubes are found, how many points they have, and how many places there are where none is."""

Room = tuple[Array, Array, Array]
"""Points (K, 3) of tubes, and at their end places where none is; ends (t, 3) int64 of tubes; and the clock."""

NOT, CLOSED, ENTERED = range(3)
"""What is beside an edge: no hole or a known one; something that is too open or too tight; a hole."""


def _near(points: Array, first: int, last: int, p: Vec, near: float) -> bool:
    """Whether a place is near to a point from `first` up to, without it, `last`."""
    least = math.inf
    for i in range(first, last):
        least = min(least, norm(sub(get_vec(points, i, 0), p)))
    return least < near


def _known(points: Array, found: Found, p: Vec, radius: float) -> bool:
    """Whether a place is near to a tube that was found, or to where there was none."""
    size, near = points.shape[0], KNOWN * radius
    return _near(points, 0, found[1], p, near) or _near(points, size - found[2], size, p, APART * near)


def _enter(scene: Scene, edge: Edge, radius: float, room: Room, found: Found) -> tuple[int, Vec]:
    """What is off the first face of an edge and behind the second, and the middle of it where that is a hole."""
    place, off, behind = edge
    points, _, clock = room
    p = add_scaled(add_scaled(place, OFF * radius, off), -INTO * radius, behind)
    mode = STEP if coarseness(scene) <= COARSE * radius else EXACT
    if _known(points, found, p, radius) or spend(clock, 4 * price(scene)):
        return NOT, p
    d, _ = closest(scene, p, radius, mode)
    if d < LEAST * radius or reach(scene, p, off, radius, mode) == math.inf or spend(clock, 3 * RAYS * price(scene)):
        return NOT, p
    ended, middle = next_beside(scene, p, scale(-1.0, behind), (radius, OFF * radius), mode)
    if ended != UNENDED:
        return CLOSED, p
    return NOT if _known(points, found, middle, radius) else ENTERED, middle


def _is_open(scene: Scene, ended: int, p: Vec, radius: float) -> bool:
    """Whether a tube that ends so has a mouth there; `p` is the place beyond its last one."""
    if ended == NO_TUBE:
        d, _ = closest(scene, p, radius, EXACT)
        return d >= LEAST * radius
    return ended in (MOUTH, BRANCH)


def _follow_both(scene: Scene, behind: Vec, radius: float, clock: Array, points: Array) -> tuple[int, bool]:
    """Follow a tube both ways from the first of `points`; returns how many there are, and whether it is open."""
    sizes, begun, ahead = (radius, radius, 0.0), get_vec(points, 0, 0), scale(-1.0, behind)
    back, first = follow_from(scene, behind, sizes, clock, points)
    reversed_from(points, back)
    forth, last = follow_from(scene, ahead, sizes, clock, points[back - 1 :])
    through = _is_open(scene, first, add_scaled(begun, radius, behind), radius)
    return back - 1 + forth, through and _is_open(scene, last, add_scaled(begun, radius, ahead), radius)


def _look(scene: Scene, edge: Edge, radius: float, room: Room, found: Found) -> Found:
    """Look for a tube behind the second face of an edge, off its first one. What ends at a wall is found, too."""
    points, ends, clock = room
    tubes, count, vain = found
    left = points.shape[0] - vain - 1
    if tubes == ends.shape[0] or vain == VAIN or count + 1 >= left:
        return found
    what, p = _enter(scene, edge, radius, room, found)
    if what == NOT:
        return found
    if what == ENTERED:
        put_vec(points, count, 0, p)
        size, through = _follow_both(scene, edge[2], radius, clock, points[count:left])
        if size > SHORTEST:
            ends[tubes, 0], ends[tubes, 1], ends[tubes, 2] = count, count + size, int(through)
            return tubes + 1, count + size, vain
    put_vec(points, left, 0, p)
    return tubes, count, vain + 1


def _look_both(scene: Scene, edge: Edge, radius: float, room: Room, found: Found) -> Found:
    """Look for a tube on either side of an edge."""
    place, one, other = edge
    found = _look(scene, (place, one, other), radius, room, found)
    return _look(scene, (place, other, one), radius, room, found)


def _of_box(scene: Scene, i: int, radius: float, room: Room, found: Found) -> Found:
    """Look beside the twelve edges of a box, in their middles."""
    middle = get_vec(scene.table, i, CENTER)
    for along in range(3):
        u, v = (along + 1) % 3, (along + 2) % 3
        for corner in range(4):
            a = scale(-1.0 if corner & 1 else 1.0, axis_of(scene.table, i, u))
            b = scale(-1.0 if corner & 2 else 1.0, axis_of(scene.table, i, v))
            p = add_scaled(middle, scene.table[i, HALF_EXTENTS + u] + scene.table[i, ROUNDING], a)
            p = add_scaled(p, scene.table[i, HALF_EXTENTS + v] + scene.table[i, ROUNDING], b)
            found = _look_both(scene, (p, a, b), radius, room, found)
    return found


def _of_edge(edges: Array, i: int) -> Edge:
    """Edge number `i` of a mesh: its middle, and the normals of its faces, from the way off both by one."""
    way, axis = get_vec(edges, i, 3), get_vec(edges, i, 6)
    cosine = 1.0 / norm(way)
    between, side = scale(cosine * cosine, way), scale(math.sqrt(max(0.0, 1.0 - cosine * cosine)) * cosine, way)
    aside = cross(axis, side)
    return get_vec(edges, i, 0), add(between, aside), sub(between, aside)


@entry
def find_tubes(
    scene: Array, edges: Array, radius: float, seconds: float, clock: Array, points: Array, ends: Array
) -> int:
    """Find tubes that open beside the edges of boxes and meshes.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    edges : ndarray (e, 10)
        Those of meshes, see `sinuous.kernels.roadmap.places`.
    radius : float
        Of the body, in the length unit.
    seconds : float
        Budget.
    clock : ndarray (c,) int64
        Scratch, see `sinuous.kernels.clock`.
    points : ndarray (K, 3)
        Filled with points of the axes, one after the other.
    ends : ndarray (t, 3) int64
        Filled for each tube: its first point, the one after its last, and 1 where it is open at both ends.

    Returns
    -------
    int
        How many tubes there are.
    """
    obstacles = read_scene(scene)
    begin(clock)
    allow(clock, seconds)
    room, found = (points, ends, clock), (0, 0, 0)
    for i in range(obstacles.table.shape[0]):
        if obstacles.table[i, KIND] == BOX and obstacles.table[i, SIGN] > 0.0:
            found = _of_box(obstacles, i, radius, room, found)
    for i in range(edges.shape[0]):
        found = _look_both(obstacles, _of_edge(edges, i), radius, room, found)
    return found[0]
