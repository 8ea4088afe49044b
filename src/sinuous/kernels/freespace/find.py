"""The door: routes of a ball through free space, from one place to another, and the proof that there are none."""

from sinuous.kernels.clock import begin_for
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, read_scene
from sinuous.kernels.freespace.band import count_points, line_length, respace, tighten
from sinuous.kernels.freespace.cells import EVALUATED, NONE, Memory, carve, forget_cells, forget_routes
from sinuous.kernels.freespace.grid import SearchGrid, onto_plane
from sinuous.kernels.freespace.grid_astar import FROM_GOAL, FROM_START, penalize_route, search_from_both_ends
from sinuous.kernels.freespace.query import Query, proof_grid, read_query, route_grid
from sinuous.kernels.maths.vectors import Array, get_vec, put_vec
from sinuous.kernels.tables import CLOSED, FOUND, PROVED_CLOSED


def _count_cells(memory: Memory, which: int, met: int) -> int:
    """How many cells lead from the one where both sides met to the end of a side; that one is not counted."""
    count, cell = 0, int(memory.sides.before[which, met])
    while cell != NONE:
        count, cell = count + 1, int(memory.sides.before[which, cell])
    return count


def _trace_line(memory: Memory, grid: SearchGrid, met: int, query: Query) -> int:
    """Write the line of the route through the cell `met` to `memory.points`; returns the number of its points.

    It has the origin, the start, the places where the route enters cells, but for those that both ends lie in, and the
    goal. Returns 0 when there is no place for it.
    """
    points, sides = memory.points, memory.sides
    behind, ahead = _count_cells(memory, FROM_START, met), _count_cells(memory, FROM_GOAL, met)
    if behind + ahead + 6 > points.shape[0]:
        return 0
    first = 1  # the place of the cell that the start lies in: the next one writes over it
    at, cell = first + behind, met
    while cell != NONE:
        put_vec(points, at, 0, get_vec(sides.points[FROM_START], cell, 0))
        at, cell = at - 1, int(sides.before[FROM_START, cell])
    at, cell = first + behind + 1, met
    while cell != NONE:
        put_vec(points, at, 0, get_vec(sides.points[FROM_GOAL], cell, 0))
        at, cell = at + 1, int(sides.before[FROM_GOAL, cell])
    put_vec(points, 0, 0, query.origin)
    put_vec(points, 1, 0, grid.start)
    count = max(2, at - 1)
    for i in range(2, count):
        put_vec(points, i, 0, onto_plane(grid, get_vec(points, i, 0)))
    put_vec(points, count, 0, grid.goal)
    return count + 1


def _smooth_route(memory: Memory, grid: SearchGrid, scene: Scene, met: int, query: Query, route: Array) -> int:
    """Fill `route` (K, 3) with the one through the cell `met`; returns how many points it has (0: too many cells)."""
    traced = _trace_line(memory, grid, met, query)
    if traced == 0:
        return 0
    wanted = count_points(line_length(memory.points, traced), grid.cell, route.shape[0])
    respace(memory.points, traced, route, wanted)
    tighten(scene, grid, route, memory.points, memory.clock, wanted)
    return wanted


def _proved_closed(memory: Memory, query: Query, scene: Scene) -> bool:
    """Prove that there is no route for any body of this radius, whatever its tangents."""
    forget_cells(memory)
    ended, _ = search_from_both_ends(memory, proof_grid(query, scene), scene)
    return ended == CLOSED


def _find(memory: Memory, scene: Scene, query: Query, routes: Array, counts: Array) -> tuple[int, int]:
    """Fill `routes` (r, K, 3) and `counts` (r,), as `find_routes`: how many, and how the last search ended."""
    grid = route_grid(query)
    forget_cells(memory)
    count, ended = 0, FOUND
    while count < routes.shape[0]:
        ended, met = search_from_both_ends(memory, grid, scene)
        if ended == CLOSED and count == 0 and query.prove and _proved_closed(memory, query, scene):
            return 0, PROVED_CLOSED
        if ended != FOUND:
            break
        points = _smooth_route(memory, grid, scene, met, query, routes[count])
        if points == 0:
            break
        counts[count] = points
        count += 1
        if count < routes.shape[0]:
            penalize_route(memory, grid, scene, met)
            forget_routes(memory)
    return count, ended


@entry
def find_routes(
    scene: Array, query: Array, seconds: float, buffer: Array, routes: Array, counts: Array
) -> tuple[int, int, int]:
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

    Returns
    -------
    (int, int, int)
        How many routes; how the last search ended: FOUND, CLOSED, FULL, TIMED_OUT, PROVED_CLOSED; and how many cells it
        examined.
    """
    obstacles, asked = read_scene(scene), read_query(query)
    memory = carve(buffer, asked.most_cells)
    begin_for(memory.clock, seconds)
    count, ended = _find(memory, obstacles, asked, routes, counts)
    return count, ended, int(memory.table.size[EVALUATED])
