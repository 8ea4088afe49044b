"""The door: routes of a ball through free space, from one place to another, and the proof that there are none."""

from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import Scene, read_scene
from sinuous.kernels.freespace.band import points_wanted, respace, span, tighten
from sinuous.kernels.freespace.cells import Memory, carve, clear, restart
from sinuous.kernels.freespace.grid import Grid, middle
from sinuous.kernels.freespace.grid_astar import explore, penalize
from sinuous.kernels.freespace.query import Query, proof_grid, read_query, route_grid, straight_length
from sinuous.kernels.maths.vectors import Array, put_vec
from sinuous.kernels.tables import CLOSED, FOUND, PROVED_CLOSED

APART = 2
"""Cells on all sides of a route that are made dearer before the next one is searched for."""


@kernel
def _trace(memory: Memory, grid: Grid, slot: int, query: Query) -> int:
    """Write the line of a route to `memory.points`: both straight pieces, and middles of cells between them.

    `slot` is the one that it begins with. Returns the number of points; 0 when there is no place for them.
    """
    points = memory.points
    put_vec(points, 0, 0, query.origin)
    put_vec(points, 1, 0, grid.start)
    count = 2
    slot = memory.side.before[slot]
    while slot >= 0:
        if count + 2 >= points.shape[0]:
            return 0
        put_vec(points, count, 0, middle(grid, memory.table.keys[slot]))
        count += 1
        slot = memory.side.before[slot]
    if count > 2:
        count -= 1  # the cell that the goal lies in
    put_vec(points, count, 0, grid.goal)
    put_vec(points, count + 1, 0, query.goal)
    return count + 2


@kernel
def _smooth(memory: Memory, grid: Grid, scene: Scene, slot: int, query: Query, route: Array) -> tuple[int, float]:
    """Fill `route` (K, 3) with the one that begins with `slot`: how many points (0: too many cells), their spacing."""
    traced = _trace(memory, grid, slot, query)
    if traced == 0:
        return 0, 0.0
    wanted = points_wanted(span(memory.points, traced), grid.cell, route.shape[0])
    respace(memory.points, traced, route, wanted)
    return wanted, tighten(scene, grid, route, memory.points, wanted)


@kernel
def _find(
    memory: Memory, scene: Scene, query: Query, deadline: float, routes: Array, counts: Array, spacings: Array
) -> tuple[int, int, int]:
    """Fill `routes`: how many, how the last search ended, how many cells it looked at.

    The first search does not know how long the route is, and so how far it leaves straight: when it leaves straight for
    longer than nothing, the search is done again with that length. A search that nothing may pass behind the ends of is
    done again without that condition when it is closed.
    """
    straight, barred, again = 0.0, True, True
    grid = route_grid(query, scene, straight, barred)
    clear(memory.table)
    count = cells = 0
    ended = FOUND
    while count < routes.shape[0]:
        ended, slot, cells = explore(memory, grid, scene, deadline, cells)
        if ended == CLOSED and count == 0 and barred:
            barred = False
            grid = route_grid(query, scene, straight, barred)
            clear(memory.table)
            cells = 0
            continue
        if ended != FOUND:
            break
        points, spacing = _smooth(memory, grid, scene, slot, query, routes[count])
        if points == 0:
            break
        ahead = straight_length(query, spacing * (points - 1))
        if again and ahead > query.free_length:
            again, straight = False, ahead
            grid = route_grid(query, scene, straight, barred)
            clear(memory.table)
            cells = 0
            continue
        counts[count], spacings[count] = points, spacing
        count += 1
        penalize(memory.table, memory.side, slot, APART)
        restart(memory.table, memory.side)
    return count, ended, cells


@entry
def find_routes(
    scene: Array, query: Array, seconds: float, buffer: Array, routes: Array, counts: Array, spacings: Array
) -> tuple[int, int, int, float]:
    """Find up to m routes that differ.

    Parameters
    ----------
    scene, query : ndarray
        Groups, laid out as `sinuous.kernels.tables` says.
    seconds : float
        Budget.
    buffer : ndarray
        Scratch, see `cells.memory_size`.
    routes : ndarray (m, K, 3)
        Filled with points from origin to goal, evenly spaced, at most K a route, in the length unit.
    counts : ndarray (m,) int64
        Filled with the number of points of every route.
    spacings : ndarray (m,)
        Filled with the distance between neighbours along every route.

    Returns
    -------
    (int, int, int, float)
        How many routes; how the last search ended: FOUND, CLOSED, FULL, TIMED_OUT, PROVED_CLOSED; how many cells it
        looked at; and the seconds that all took.
    """
    obstacles, asked = read_scene(scene), read_query(query)
    memory = carve(buffer, asked.slots)
    began = now(memory.clock)
    deadline = began + seconds
    count, ended, cells = _find(memory, obstacles, asked, deadline, routes, counts, spacings)
    if ended == CLOSED and count == 0 and asked.prove:
        clear(memory.table)
        ended, _, cells = explore(memory, proof_grid(asked), obstacles, deadline, 0)
        if ended == CLOSED:
            ended = PROVED_CLOSED
    return count, ended, cells, now(memory.clock) - began
