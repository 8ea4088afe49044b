"""Tubes: places where the obstacles lie all around, and the line through their middle.

Whoever begins in a tube has one way to go, and need not search for it: rays across its axis say where its wall is, and
where it ends. What a search finds instead may leave by the wrong mouth, and where it leaves by the right one it bends
around the rim: nothing says where the tube ends.

Other tubes are found by the rims of their mouths, so that a route through them need not be searched for inside. Beside
each edge, on the far side of each of its faces, it is checked whether there are walls all around. If so, the tube there
is followed both ways.

`points` (K, 3) are those of an axis, `edges` (e, 10) those of meshes, see `roadmap.find`.
"""

import math

from sinuous.kernels.clock import begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, coarseness, read_scene, work_of_all
from sinuous.kernels.fields.primitives import axis_of
from sinuous.kernels.fields.solids import EXACT, INTERPOLATED
from sinuous.kernels.freespace.band import reverse
from sinuous.kernels.maths.vectors import Array, Vec, across, add, add_scaled, cross, get_vec, norm, put_vec, scale, sub
from sinuous.kernels.tables import BOX, CENTER, HALF_EXTENTS, KIND, ROUNDING_RADIUS, SIGN

CROSS_RAYS = 8
"""Rays across the axis, evenly spread."""

ENCLOSED = 7
"""How many of them have to meet a wall in a tube: not all do where it branches."""

FAR = 5.0
"""How far a ray leads."""

EVALUATION_REACH = 3.0
"""How far an evaluation reaches."""

RAY_CLEARANCE, RAY_ACCURACY = 0.9, 0.05
"""Distance from the obstacles at which a ray ends, because a ball of the radius cannot get through; and how exactly."""

FIRST_EVALUATION = 0.15
"""Where a ray is examined first: at its beginning the distance is the same, whatever way it leads."""

RAY_EVALUATIONS = 12
"""Most evaluations along a ray."""

CENTERING = 0.5
"""How far the axis is moved to the middle of the rays at most, in one step, of the step."""

AXIS_CLEARANCE = 0.85
"""Distance from the obstacles that the axis has at least."""

MOST_SPACING = 1.0
"""Largest spacing of samples that the axis is found by. All lengths in radii of the body."""

RETRACED_POINTS = 5
"""Points that are found again with exact distances where a tube ends by samples."""

DIRECTION_STEPS = 2
"""Steps that the direction of the axis is taken over."""

MOUTH_DEPTH, OPEN_RAYS = 2.0, 4
"""How far beyond a mouth it is checked whether it is one, and how many rays may meet a wall there: where a tube
branches more of them do."""

NO_TUBE, MOUTH, WALL, BRANCH, UNENDED = range(5)
"""How a tube ends: there is none; where it opens; at a wall; where it branches; or not where it was followed."""


def reach(scene: Scene, p: Vec, direction: Vec, radius: float, mode: int) -> float:
    """How far a ball comes from `p` along a unit vector; inf: farther than a ray leads."""
    gone = FIRST_EVALUATION * radius
    for _ in range(RAY_EVALUATIONS):
        d, _ = closest(scene, add_scaled(p, gone, direction), EVALUATION_REACH * radius, mode)
        gone += min(d, EVALUATION_REACH * radius) - RAY_CLEARANCE * radius
        if d < (RAY_CLEARANCE + RAY_ACCURACY) * radius:
            return gone
        if gone > FAR * radius:
            return math.inf
    return gone


def _probe_around(scene: Scene, p: Vec, ahead: Vec, radius: float, mode: int) -> tuple[int, Vec]:
    """How many rays across the unit vector `ahead` meet a wall, and how far it is to the middle between walls."""
    a, b = across(ahead)
    count, middle = 0, (0.0, 0.0, 0.0)
    for i in range(CROSS_RAYS // 2):
        angle = 2.0 * math.pi * i / CROSS_RAYS
        direction = add(scale(math.cos(angle), a), scale(math.sin(angle), b))
        there = reach(scene, p, direction, radius, mode)
        back = reach(scene, p, scale(-1.0, direction), radius, mode)
        count += int(there < math.inf) + int(back < math.inf)
        if there < math.inf and back < math.inf:
            middle = add_scaled(middle, 2.0 / CROSS_RAYS * (there - back), direction)
    return count, middle


def _limited(a: Vec, most: float) -> Vec:
    """The vector, no longer than `most`."""
    size = norm(a)
    return scale(most / size, a) if size > most else a


def next_beside(scene: Scene, p: Vec, ahead: Vec, sizes: tuple[float, float], mode: int) -> tuple[int, Vec]:
    """Point of the axis beside `p`; and MOUTH or WALL where the tube does not go on there, else UNENDED.

    `sizes` are the radius, and how far the axis may be from `p`.
    """
    radius, most = sizes
    hits, middle = _probe_around(scene, p, ahead, radius, mode)
    if hits < ENCLOSED:
        return MOUTH, p
    p = add(p, _limited(middle, most))
    d, _ = closest(scene, p, radius, mode)
    return WALL if d < AXIS_CLEARANCE * radius else UNENDED, p


def _ahead(points: Array, count: int, ahead: Vec) -> Vec:
    """Where the axis leads from the last of so many points; from the first one as it did before."""
    if count == 1:
        return ahead
    line = sub(get_vec(points, count - 1, 0), get_vec(points, max(0, count - 1 - DIRECTION_STEPS), 0))
    return scale(1.0 / norm(line), line)


def follow_from(
    scene: Scene, ahead: Vec, sizes: tuple[float, float, float], clock: Array, points: Array
) -> tuple[int, int]:
    """Fill `points` from the second on; see `follow_tube`.

    Samples are asked where they are fine enough, until a tube ends by them: then from some points before.
    """
    radius, spacing, free = sizes
    units = CROSS_RAYS * 3 * work_of_all(scene)
    sampled = coarseness(scene) <= MOST_SPACING * radius
    count = 1
    while count < points.shape[0]:
        if spend(clock, units):
            return count, UNENDED
        last = get_vec(points, count - 1, 0)
        beside = add_scaled(last, max(spacing, free) if count == 1 else spacing, ahead)
        own = (radius, CENTERING * spacing)
        ended, p = next_beside(scene, beside, ahead, own, INTERPOLATED if sampled else EXACT)
        if ended != UNENDED and sampled:
            sampled, count = False, max(1, count - RETRACED_POINTS)
            ahead = _ahead(points, count, ahead)
            continue
        if ended == MOUTH and count > 1:
            hits, _ = _probe_around(scene, add_scaled(beside, MOUTH_DEPTH * radius, ahead), ahead, radius, EXACT)
            return count, MOUTH if hits <= OPEN_RAYS else BRANCH
        if ended != UNENDED:
            return count, NO_TUBE if count == 1 else ended
        put_vec(points, count, 0, p)
        count += 1
        ahead = _ahead(points, count, ahead)
    return count, UNENDED


@entry
def follow_tube(
    scene: Array, start: Array, sizes: tuple[float, float, float], seconds: float, clock: Array, points: Array
) -> tuple[int, int]:
    """Follow the axis of the tube that a place lies in.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    start : ndarray (2, 3)
        The place, and the unit vector along which the tube is followed from there.
    sizes : (float, float, float)
        Radius of the body; distance between points of the axis; and how far from the start obstacles do not concern
        the body. In the length unit.
    seconds : float
        Budget.
    clock : ndarray (c,) int64
        Scratch, see `sinuous.kernels.clock`.
    points : ndarray (K, 3)
        Filled with points of the axis, the start first.

    Returns
    -------
    (int, int)
        How many points there are, and how the tube ends: NO_TUBE, MOUTH, WALL, BRANCH or UNENDED.
    """
    obstacles = read_scene(scene)
    begin_for(clock, seconds)
    put_vec(points, 0, 0, get_vec(start, 0, 0))
    return follow_from(obstacles, get_vec(start, 1, 0), sizes, clock, points)


FACE_OFFSET, FACE_DEPTH = 1.15, 1.5
"""How far off one face of an edge, and behind the other, a tube is checked for."""

LEAST_CLEARANCE = 0.85
"""Distance from the obstacles that there must be."""

SHORTEST_TUBE = 4.0
"""Length that a tube has at least."""

MOST_VAIN_PLACES, VAIN_DISTANCE = 40, 0.3
"""Most places that are examined in vain; and how near to one no other is examined, of `KNOWN_DISTANCE`."""

KNOWN_DISTANCE = 2.0
"""How near to the axis of a known tube no other one is checked for. All lengths in radii of the body."""

Edge = tuple[Vec, Vec, Vec]
"""A place on an edge, and the unit normals of both its faces."""

Found = tuple[int, int, int]
"""How many tubes are found, how many points they have, and how many places there are where none is."""

TubeTables = tuple[Array, Array, Array]
"""Points (K, 3) of tubes, and at their end places where none is; ends (t, 3) int64 of tubes; and the clock."""

NO_HOLE, HOLE_CLOSED, HOLE_ENTERED = range(3)
"""What is beside an edge: no hole or a known one; something that is too open or too tight; a hole."""


def _near(points: Array, first: int, last: int, p: Vec, near: float) -> bool:
    """Whether a place is near to a point from `first` up to, without it, `last`."""
    least = math.inf
    for i in range(first, last):
        least = min(least, norm(sub(get_vec(points, i, 0), p)))
    return least < near


def _known(points: Array, found: Found, p: Vec, radius: float) -> bool:
    """Whether a place is near to a tube that was found, or to where there was none."""
    size, near = points.shape[0], KNOWN_DISTANCE * radius
    return _near(points, 0, found[1], p, near) or _near(points, size - found[2], size, p, VAIN_DISTANCE * near)


def _enter(scene: Scene, edge: Edge, radius: float, tables: TubeTables, found: Found) -> tuple[int, Vec]:
    """What is off the first face of an edge and behind the second, and the middle of it where that is a hole."""
    place, off, behind = edge
    points, _, clock = tables
    p = add_scaled(add_scaled(place, FACE_OFFSET * radius, off), -FACE_DEPTH * radius, behind)
    mode = INTERPOLATED if coarseness(scene) <= MOST_SPACING * radius else EXACT
    if _known(points, found, p, radius) or spend(clock, 4 * work_of_all(scene)):
        return NO_HOLE, p
    d, _ = closest(scene, p, radius, mode)
    if (
        d < LEAST_CLEARANCE * radius
        or reach(scene, p, off, radius, mode) == math.inf
        or spend(clock, 3 * CROSS_RAYS * work_of_all(scene))
    ):
        return NO_HOLE, p
    ended, middle = next_beside(scene, p, scale(-1.0, behind), (radius, FACE_OFFSET * radius), mode)
    if ended != UNENDED:
        return HOLE_CLOSED, p
    return NO_HOLE if _known(points, found, middle, radius) else HOLE_ENTERED, middle


def _is_open(scene: Scene, ended: int, p: Vec, radius: float) -> bool:
    """Whether a tube that ends so has a mouth there; `p` is the place beyond its last one."""
    if ended == NO_TUBE:
        d, _ = closest(scene, p, radius, EXACT)
        return d >= LEAST_CLEARANCE * radius
    return ended in (MOUTH, BRANCH)


def _follow_both(scene: Scene, behind: Vec, radius: float, clock: Array, points: Array) -> tuple[int, bool]:
    """Follow a tube both ways from the first of `points`; returns how many there are, and whether it is open."""
    sizes, begun, ahead = (radius, radius, 0.0), get_vec(points, 0, 0), scale(-1.0, behind)
    back, first = follow_from(scene, behind, sizes, clock, points)
    reverse(points, back)
    forth, last = follow_from(scene, ahead, sizes, clock, points[back - 1 :])
    through = _is_open(scene, first, add_scaled(begun, radius, behind), radius)
    return back - 1 + forth, through and _is_open(scene, last, add_scaled(begun, radius, ahead), radius)


def _find_behind(scene: Scene, edge: Edge, radius: float, tables: TubeTables, found: Found) -> Found:
    """Look for a tube behind the second face of an edge, off its first one. What ends at a wall is found, too."""
    points, ends, clock = tables
    tubes, count, vain = found
    left = points.shape[0] - vain - 1
    if tubes == ends.shape[0] or vain == MOST_VAIN_PLACES or count + 1 >= left:
        return found
    what, p = _enter(scene, edge, radius, tables, found)
    if what == NO_HOLE:
        return found
    if what == HOLE_ENTERED:
        put_vec(points, count, 0, p)
        size, through = _follow_both(scene, edge[2], radius, clock, points[count:left])
        if size > SHORTEST_TUBE:
            ends[tubes, 0], ends[tubes, 1], ends[tubes, 2] = count, count + size, int(through)
            return tubes + 1, count + size, vain
    put_vec(points, left, 0, p)
    return tubes, count, vain + 1


def _find_on_both_sides(scene: Scene, edge: Edge, radius: float, tables: TubeTables, found: Found) -> Found:
    """Look for a tube on either side of an edge."""
    place, one, other = edge
    found = _find_behind(scene, (place, one, other), radius, tables, found)
    return _find_behind(scene, (place, other, one), radius, tables, found)


def _of_box(scene: Scene, i: int, radius: float, tables: TubeTables, found: Found) -> Found:
    """Look beside the twelve edges of a box, in their middles."""
    middle = get_vec(scene.table, i, CENTER)
    for along in range(3):
        u, v = (along + 1) % 3, (along + 2) % 3
        for corner in range(4):
            a = scale(-1.0 if corner & 1 else 1.0, axis_of(scene.table, i, u))
            b = scale(-1.0 if corner & 2 else 1.0, axis_of(scene.table, i, v))
            p = add_scaled(middle, scene.table[i, HALF_EXTENTS + u] + scene.table[i, ROUNDING_RADIUS], a)
            p = add_scaled(p, scene.table[i, HALF_EXTENTS + v] + scene.table[i, ROUNDING_RADIUS], b)
            found = _find_on_both_sides(scene, (p, a, b), radius, tables, found)
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
    begin_for(clock, seconds)
    tables, found = (points, ends, clock), (0, 0, 0)
    for i in range(obstacles.table.shape[0]):
        if obstacles.table[i, KIND] == BOX and obstacles.table[i, SIGN] > 0.0:
            found = _of_box(obstacles, i, radius, tables, found)
    for i in range(edges.shape[0]):
        found = _find_on_both_sides(obstacles, _of_edge(edges, i), radius, tables, found)
    return found[0]
