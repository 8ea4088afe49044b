"""The door: a route from edge to edge, by A* over places of which few are examined (lazily, Bohlin & Kavraki 2000).

`triangles` (f, 12) are those of meshes: a corner, two sides from there, and the normal; `edges` (e, 10) theirs.
"""

import math
from collections import namedtuple

from sinuous.kernels.clock import CLOCK_SIZE, begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, read_scene, work_of_all
from sinuous.kernels.freespace.band import count_points, line_length, respace, tighten
from sinuous.kernels.freespace.grid import SearchGrid
from sinuous.kernels.freespace.query import Query, read_query, route_grid
from sinuous.kernels.maths import buckets
from sinuous.kernels.maths.buckets import Buckets
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array, get_vec, norm, put_vec, sub
from sinuous.kernels.roadmap.places import put_places
from sinuous.kernels.roadmap.sight import find_cutting, in_sight, is_cut_by

MOST_PLACES = 1024
"""Most places."""

MOST_LINES = 1 << 15
"""Most lines from place to place that wait to be examined."""

ROADMAP_INFLATION = 1.2
"""See `freespace.grid.SearchGrid`."""

TURN_COST = 0.5
"""What a place on the way costs, in radii of the body: of two routes as long, the one with fewer turns is better."""

SHORTENED = 0.9
"""What is left at least of the length of a route when it is drawn tight."""

LEAST_SPACING, MOST_SPACING = 0.5, 1.0
"""Least and greatest distance of the points of a band, in radii of the body."""

BAND_POINTS = 256
"""Points of a band that is neither."""

MOST_CUTS, MOST_WORK = 1 << 22, 1 << 18
"""How many boxes and triangles are asked whether they cut a line, at most; and work units of
distances, see `kernels.clock`."""

BUCKETS = 4096
"""Buckets of the queue of lines: lines whose routes differ in length by less than some thousandth are alike."""

RECENT = 16
"""How many of those that cut a line of late are asked first whether they cut this one."""

Roadmap = namedtuple("Roadmap", ["places", "cost", "before", "cut", "recent", "lines", "spare", "clock"])
"""Places (m, 3); by their number the cost (m,) of the route there, infinite while none is known, the place before
(m,) int64, and what cut the last line to there that was examined (m,) int64, see `sight.find_cutting`, and what cut any
of late (r,) int64; what the queue of lines lies in (l,) int64: each is the number of the place that it leads from times
`MOST_PLACES`, plus that of the one that it leads to; points (2 k, 3) to work with; the clock."""

QUEUE = BUCKETS + 2 * MOST_LINES + buckets.MORE
"""Numbers of the queue."""

START_PLACE, GOAL_PLACE = 0, 1
"""The numbers of both ends."""


def roadmap_size(points: int) -> int:
    """Numbers (float64) that a search for a route of at most so many points works in."""
    return 6 * MOST_PLACES + RECENT + QUEUE + 6 * points + CLOCK_SIZE


def _carve(buffer: Array, points: int) -> Roadmap:
    """Lay out the memory of a search, see `roadmap_size`."""
    places, rest = cut(buffer, MOST_PLACES, 3)
    cost, rest = cut(rest, MOST_PLACES)
    before, rest = cut_whole(rest, MOST_PLACES)
    done, rest = cut_whole(rest, MOST_PLACES)
    recent, rest = cut_whole(rest, RECENT)
    lines, rest = cut_whole(rest, QUEUE)
    spare, rest = cut(rest, 2 * points, 3)
    clock, rest = cut_whole(rest, CLOCK_SIZE)
    return Roadmap(places, cost, before, done, recent, lines, spare, clock)


def _empty_queue(roadmap: Roadmap, grid: SearchGrid) -> Buckets:
    """An empty queue of lines, for all lengths of routes that are not too long."""
    straight = norm(sub(grid.goal, grid.start))
    return buckets.carve(roadmap.lines, BUCKETS, straight, (1.0 / SHORTENED + ROADMAP_INFLATION - 1.0) * grid.longest)


def _put_lines(
    roadmap: Roadmap, queue: Buckets, grid: SearchGrid, scene: Scene, triangles: Array, count: int, place: int
) -> None:
    """Put lines from a place to all others into the queue, as far as there is room.

    A wall that cut the last line to a place hides it from most others: what it cuts here need not wait.
    """
    p, goal = get_vec(roadmap.places, place, 0), get_vec(roadmap.places, GOAL_PLACE, 0)
    for other in range(count):
        if roadmap.cost[other] < math.inf:
            continue
        q = get_vec(roadmap.places, other, 0)
        gone, rest = roadmap.cost[place] + norm(sub(q, p)), norm(sub(goal, q))
        if SHORTENED * (gone + rest) > grid.longest or is_cut_by(scene, triangles, roadmap.cut[other], p, q):
            continue
        if not buckets.push(queue, gone + ROADMAP_INFLATION * rest, place * MOST_PLACES + other):
            return


def _sees_goal(roadmap: Roadmap, grid: SearchGrid, scene: Scene, triangles: Array) -> bool:
    """Whether the goal is in sight from the start: a search would check there first, and needs no other places then."""
    put_vec(roadmap.places, START_PLACE, 0, grid.start)
    put_vec(roadmap.places, GOAL_PLACE, 0, grid.goal)
    for i in range(RECENT):
        roadmap.recent[i] = -1
    by, asked = find_cutting(scene, triangles, grid.start, grid.goal, roadmap.recent)
    far = SHORTENED * norm(sub(grid.goal, grid.start)) > grid.longest
    if far or by >= 0 or spend(roadmap.clock, asked):
        return False
    seen, looked = in_sight(scene, grid, grid.start, grid.goal)
    roadmap.before[GOAL_PLACE] = START_PLACE
    return seen and not spend(roadmap.clock, looked * work_of_all(scene))


def _search_places(roadmap: Roadmap, grid: SearchGrid, scene: Scene, triangles: Array, count: int) -> bool:
    """Search for a route from place to place, as far as the time allows; `before` leads back from the goal.

    What cut the line from the start to the goal is among what is `recent` already, see `_sees_goal`.
    """
    units = work_of_all(scene)
    for i in range(count):
        roadmap.cost[i], roadmap.cut[i] = math.inf, -1
    roadmap.cost[START_PLACE], roadmap.before[START_PLACE] = 0.0, -1
    queue = _empty_queue(roadmap, grid)
    _put_lines(roadmap, queue, grid, scene, triangles, count, START_PLACE)
    tried = spent = 0
    while tried < MOST_CUTS and spent < MOST_WORK:
        line = buckets.pop(queue)
        if line < 0:
            return False
        place, other = line // MOST_PLACES, line % MOST_PLACES
        if roadmap.cost[other] < math.inf:
            continue
        p, q = get_vec(roadmap.places, place, 0), get_vec(roadmap.places, other, 0)
        by, asked = find_cutting(scene, triangles, p, q, roadmap.recent)
        tried += asked
        if spend(roadmap.clock, asked):
            return False
        if by >= 0:
            roadmap.cut[other] = by
            continue
        seen, looked = in_sight(scene, grid, p, q)
        spent += looked * units
        if spend(roadmap.clock, looked * units):
            return False
        if not seen:
            continue
        roadmap.cost[other] = roadmap.cost[place] + norm(sub(q, p)) + TURN_COST * grid.radius
        roadmap.before[other] = place
        if other == GOAL_PLACE:
            return True
        _put_lines(roadmap, queue, grid, scene, triangles, count, other)
    return False


def _draw_route(roadmap: Roadmap, grid: SearchGrid, scene: Scene, query: Query, route: Array) -> int:
    """Fill `route` (K, 3) with the one that was found; returns how many points it has."""
    line, count, place = roadmap.spare, 3, roadmap.before[GOAL_PLACE]
    while place != START_PLACE:
        count, place = count + 1, roadmap.before[place]
    put_vec(line, 0, 0, query.origin)
    at, place = count - 1, GOAL_PLACE
    while at > 0:
        put_vec(line, at, 0, get_vec(roadmap.places, place, 0))
        at, place = at - 1, roadmap.before[place]
    length = line_length(line, count)
    spacing = max(LEAST_SPACING * grid.radius, min(MOST_SPACING * grid.radius, length / BAND_POINTS))
    wanted = count_points(length, spacing, route.shape[0])
    respace(line, count, route, wanted)
    tighten(scene, grid, route, roadmap.spare, roadmap.clock, wanted)
    return wanted


def _find_route(roadmap: Roadmap, scene: Scene, query: Query, edges: Array, triangles: Array, route: Array) -> int:
    """Fill `route` (K, 3); see `find_by_edges`."""
    grid = route_grid(query)
    if not _sees_goal(roadmap, grid, scene, triangles):
        count = put_places(scene, grid, edges, roadmap.places, roadmap.clock)
        if not _search_places(roadmap, grid, scene, triangles, count):
            return 0
    return _draw_route(roadmap, grid, scene, query, route)


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
        Some of which a line may cross, see `sight.find_cutting`: asked before distances, which are dearer.
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
    begin_for(roadmap.clock, seconds)
    if seconds <= 0.0:  # a straight route takes fewer evaluations than pass before the time is read
        return 0
    return _find_route(roadmap, read_scene(scene), read_query(query), edges, triangles, route)
