"""The door: a route from edge to edge, by A* over places of which few are looked at (lazily, Bohlin & Kavraki 2000)."""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE, allow, begin, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, price, read_scene
from sinuous.kernels.freespace.band import points_wanted, respace, span, tighten
from sinuous.kernels.freespace.grid import Grid
from sinuous.kernels.freespace.query import Query, read_query, route_grid, straight_length
from sinuous.kernels.maths import buckets
from sinuous.kernels.maths.buckets import Buckets
from sinuous.kernels.maths.vectors import Array, get_vec, norm, put_vec, sub
from sinuous.kernels.roadmap.places import put_places
from sinuous.kernels.roadmap.sight import cuts, cutting, in_sight

PLACES = 1024
"""Most places."""

LINES = 1 << 15
"""Most lines from place to place that wait to be looked at."""

INFLATION = 1.2
"""See `freespace.grid.Grid`."""

TURN_COST = 0.5
"""What a place on the way costs, in radii of the body: of two routes as long, the one with fewer turns is better."""

SHORTENED = 0.9
"""What is left at least of the length of a route when it is drawn tight."""

FINE, COARSE = 0.5, 1.0
"""Least and greatest distance of the points of a band, in radii of the body."""

POINTS = 256
"""Points of a band that is neither."""

CUTS, LOOKS = 1 << 22, 1 << 18
"""How many boxes and triangles are asked whether they cut a line, at most; and looks at distances, see `kernels.clock`.
"""

BUCKETS = 4096
"""Buckets of the queue of lines: lines whose routes differ in length by less than some thousandth are alike."""

RECENT = 16
"""How many of those are asked first whether they cut a line that cut one of late."""

Roadmap = namedtuple("Roadmap", ["places", "cost", "before", "cut", "recent", "lines", "spare", "clock"])
"""Places (m, 3); by their number the cost (m,) of the route there, infinite while none is known, the place before
(m,) int64, and what cut the last line to there that was looked at (m,) int64, see `sight.cutting`, and what cut any
of late (r,) int64; what the queue of lines lies in (l,) int64: each is the number of the place that it leads from times
`PLACES`, plus that of the one that it leads to; points (2 k, 3) to work with; the clock."""

QUEUE = BUCKETS + 2 * LINES + buckets.MORE
"""Numbers of the queue."""

START, GOAL = 0, 1
"""The numbers of both ends."""


def roadmap_size(points: int) -> int:
    """Numbers (float64) that a search for a route of at most so many points works in."""
    return 6 * PLACES + RECENT + QUEUE + 6 * points + CLOCK_SIZE


def _carve(buffer: Array, points: int) -> Roadmap:
    """Lay out the memory of a search, see `roadmap_size`."""
    work, spare = buffer[6 * PLACES :], buffer[6 * PLACES + RECENT + QUEUE :]
    return Roadmap(
        buffer[: 3 * PLACES].reshape((PLACES, 3)),
        buffer[3 * PLACES : 4 * PLACES],
        buffer[4 * PLACES : 5 * PLACES].view(np.int64),
        buffer[5 * PLACES : 6 * PLACES].view(np.int64),
        work[:RECENT].view(np.int64),
        work[RECENT : RECENT + QUEUE].view(np.int64),
        spare[: 6 * points].reshape((2 * points, 3)),
        spare[6 * points :][:CLOCK_SIZE].view(np.int64),
    )


def _queue(roadmap: Roadmap, grid: Grid) -> Buckets:
    """An empty queue of lines, for all lengths of routes that are not too long."""
    straight = norm(sub(grid.goal, grid.start))
    return buckets.carve(roadmap.lines, BUCKETS, straight, (1.0 / SHORTENED + INFLATION - 1.0) * grid.longest)


def _put_lines(
    roadmap: Roadmap, queue: Buckets, grid: Grid, scene: Scene, triangles: Array, count: int, place: int
) -> None:
    """Put lines from a place to all others into the queue, as far as there is room.

    A wall that cut the last line to a place hides it from most others: what it cuts here need not wait.
    """
    p, goal = get_vec(roadmap.places, place, 0), get_vec(roadmap.places, GOAL, 0)
    for other in range(count):
        if roadmap.cost[other] < math.inf:
            continue
        q = get_vec(roadmap.places, other, 0)
        gone, rest = roadmap.cost[place] + norm(sub(q, p)), norm(sub(goal, q))
        if SHORTENED * (gone + rest) > grid.longest or cuts(scene, triangles, roadmap.cut[other], p, q):
            continue
        if not buckets.push(queue, gone + INFLATION * rest, place * PLACES + other):
            return


def _straight(roadmap: Roadmap, grid: Grid, scene: Scene, triangles: Array) -> bool:
    """Whether the goal is in sight from the start: a search would look there first, and needs no other places then."""
    put_vec(roadmap.places, START, 0, grid.start)
    put_vec(roadmap.places, GOAL, 0, grid.goal)
    for i in range(RECENT):
        roadmap.recent[i] = -1
    by, asked = cutting(scene, triangles, grid.start, grid.goal, roadmap.recent)
    far = SHORTENED * norm(sub(grid.goal, grid.start)) > grid.longest
    if far or by >= 0 or spend(roadmap.clock, asked):
        return False
    seen, looked = in_sight(scene, grid, grid.start, grid.goal)
    roadmap.before[GOAL] = START
    return seen and not spend(roadmap.clock, looked * price(scene))


def _search(roadmap: Roadmap, grid: Grid, scene: Scene, triangles: Array, count: int) -> bool:
    """Search for a route from place to place, as far as the time allows; `before` leads back from the goal.

    What cut the line from the start to the goal is among what is `recent` already, see `_straight`.
    """
    looks = price(scene)
    for i in range(count):
        roadmap.cost[i], roadmap.cut[i] = math.inf, -1
    roadmap.cost[START], roadmap.before[START] = 0.0, -1
    queue = _queue(roadmap, grid)
    _put_lines(roadmap, queue, grid, scene, triangles, count, START)
    tried = spent = 0
    while tried < CUTS and spent < LOOKS:
        line = buckets.pop(queue)
        if line < 0:
            return False
        place, other = line // PLACES, line % PLACES
        if roadmap.cost[other] < math.inf:
            continue
        p, q = get_vec(roadmap.places, place, 0), get_vec(roadmap.places, other, 0)
        by, asked = cutting(scene, triangles, p, q, roadmap.recent)
        tried += asked
        if spend(roadmap.clock, asked):
            return False
        if by >= 0:
            roadmap.cut[other] = by
            continue
        seen, looked = in_sight(scene, grid, p, q)
        spent += looked * looks
        if spend(roadmap.clock, looked * looks):
            return False
        if not seen:
            continue
        roadmap.cost[other] = roadmap.cost[place] + norm(sub(q, p)) + TURN_COST * grid.radius
        roadmap.before[other] = place
        if other == GOAL:
            return True
        _put_lines(roadmap, queue, grid, scene, triangles, count, other)
    return False


def _draw(roadmap: Roadmap, grid: Grid, scene: Scene, query: Query, route: Array) -> int:
    """Fill `route` (K, 3) with the one that was found; returns how many points it has."""
    line, count, place = roadmap.spare, 4, roadmap.before[GOAL]
    while place != START:
        count, place = count + 1, roadmap.before[place]
    put_vec(line, 0, 0, query.origin)
    put_vec(line, count - 1, 0, query.goal)
    at, place = count - 2, GOAL
    while at > 0:
        put_vec(line, at, 0, get_vec(roadmap.places, place, 0))
        at, place = at - 1, roadmap.before[place]
    length = span(line, count)
    spacing = max(FINE * grid.radius, min(COARSE * grid.radius, length / POINTS))
    wanted = points_wanted(length, spacing, route.shape[0])
    respace(line, count, route, wanted)
    tighten(scene, grid, route, roadmap.spare, roadmap.clock, wanted)
    return wanted


def _find(roadmap: Roadmap, scene: Scene, query: Query, edges: Array, triangles: Array, route: Array) -> int:
    """See `find_by_edges`. Where the route leaves straight for longer than nothing, it is sought again from there."""
    straight, points = 0.0, 0
    for _ in range(2):
        grid = route_grid(query, scene, straight, True)
        if not _straight(roadmap, grid, scene, triangles):
            count = put_places(scene, grid, edges, roadmap.places, roadmap.clock)
            if not _search(roadmap, grid, scene, triangles, count):
                return 0
        points = _draw(roadmap, grid, scene, query, route)
        straight = straight_length(query, span(route, points))
        if straight <= query.free_length:
            break
    return points


@entry
def find_by_edges(
    scene: Array, query: Array, edges: Array, triangles: Array, seconds: float, buffer: Array, route: Array
) -> int:
    """Find a route of a ball around the edges of boxes and meshes.

    Parameters
    ----------
    scene, query : ndarray
        Groups, laid out as `sinuous.kernels.tables` says.
    edges : ndarray (e, 10)
        Those of meshes, see `places.put_places`.
    triangles : ndarray (t, 12)
        Some of which a line may cross, see `sight.cutting`: asked before distances, which are dearer.
    seconds : float
        Budget.
    buffer : ndarray
        Scratch, see `roadmap_size`.
    route : ndarray (K, 3)
        Filled with points from origin to goal, evenly spaced, at most K, in the length unit.

    Returns
    -------
    int
        How many points it has; 0 where none was found, which proves nothing.
    """
    roadmap = _carve(buffer, route.shape[0])
    begin(roadmap.clock)
    allow(roadmap.clock, seconds)
    if seconds <= 0.0:  # a straight route takes fewer looks than pass before the time is read
        return 0
    return _find(roadmap, read_scene(scene), read_query(query), edges, triangles, route)
