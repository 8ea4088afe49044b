"""What is asked of a route search, and the grids that answer it."""

import math
from collections import namedtuple

from sinuous.kernels import tables as t
from sinuous.kernels.fields.distances import Scene, closest, most_roundoff
from sinuous.kernels.fields.solids import INTERPOLATED, UPPER_BOUND
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add_scaled, norm, sub

INFLATION = 2.0
"""See `grid.Grid`: among obstacles a route costs more than its length, and to find the cheapest one is far dearer."""

GREEDY = 1e6
"""The inflation of a proof: it asks whether there is a route, whatever that costs."""

CLEARANCE_WEIGHT = 0.2
"""See `grid.Grid`: little, because with more the search examines all the room around a narrow place first."""

CELL_LEVELS = 7
"""Sizes of cells beside the finest, each twice as large as the one before."""

STRAIGHT_STEPS = 16
"""Steps in which it is checked how far a route can leave straight."""

Query = namedtuple(
    "Query",
    "origin axis goal back goal_radius goal_slack radius shortest longest turn free_length straight_min "
    "straight_max other_length cell clearance free_margin most_cells prove",
)
"""The numbers of a query by their names, see `sinuous.kernels.tables`."""


def _vector(query: Array, at: int) -> Vec:
    return query[at], query[at + 1], query[at + 2]


def read_query(query: Array) -> Query:
    """Take a query (27,) apart."""
    return Query(
        _vector(query, t.QUERY_ORIGIN),
        _vector(query, t.QUERY_AXIS),
        _vector(query, t.QUERY_GOAL),
        _vector(query, t.QUERY_BACK),
        query[t.QUERY_GOAL_RADIUS],
        query[t.QUERY_GOAL_SLACK],
        query[t.QUERY_RADIUS],
        query[t.QUERY_SHORTEST],
        query[t.QUERY_LONGEST],
        query[t.QUERY_TURN],
        query[t.QUERY_FREE_LENGTH],
        query[t.QUERY_STRAIGHT_MIN],
        query[t.QUERY_STRAIGHT_MAX],
        query[t.QUERY_OTHER_LENGTH],
        query[t.QUERY_CELL],
        query[t.QUERY_CLEARANCE],
        query[t.QUERY_FREE_MARGIN],
        int(query[t.QUERY_MOST_CELLS]),
        query[t.QUERY_PROVE] != 0.0,
    )


def straight_length(query: Query, length: float) -> float:
    """How far a route of this length leaves straight."""
    return min(query.straight_max, max(query.straight_min, length - query.other_length))


def _end_of_straight(scene: Scene, place: Vec, axis: Vec, past: float, most: float, radius: float) -> Vec:
    """The point farthest along `axis`, from `past` up to `most`, that a ball can reach straight."""
    reached = past
    for i in range(1, STRAIGHT_STEPS + 1):
        further = past + (most - past) * i / STRAIGHT_STEPS
        d, _ = closest(scene, add_scaled(place, further, axis), radius, INTERPOLATED)
        if d < radius:
            break
        reached = further
    return add_scaled(place, reached, axis)


def route_grid(query: Query, scene: Scene, straight: float, barred: bool) -> SearchGrid:
    """The grid for routes that leave straight for so long, and with `barred` pass behind neither end.

    The search is from the end of a straight piece at one end to that at the other.
    """
    turn = 0.5 * query.turn
    most = max(query.free_length, straight) + turn
    start = _end_of_straight(scene, query.origin, query.axis, query.free_length, most, query.radius)
    goal = query.goal
    if norm(query.back) > 0.0:
        goal = _end_of_straight(scene, query.goal, query.back, 0.0, turn, query.radius)
    ample = max(query.clearance, 2.0 * HALF_DIAGONAL * query.cell - query.clearance)
    pieces = norm(sub(start, query.origin)) + norm(sub(goal, query.goal))
    return SearchGrid(
        query.origin,
        query.cell,
        CELL_LEVELS,
        query.clearance,
        max(query.radius, ample),
        query.radius,
        query.free_margin,
        query.longest,
        start,
        0.9 * query.cell,
        query.axis,
        goal,
        query.goal_radius,
        query.back,
        turn if barred else 0.0,
        INFLATION,
        CLEARANCE_WEIGHT,
        query.longest - pieces + query.goal_radius + query.cell,
        INTERPOLATED,
    )


def proof_grid(query: Query, scene: Scene) -> SearchGrid:
    """The grid for the proof that there is no route: whatever any body of this radius can pass, can be passed."""
    clearance = query.radius - HALF_DIAGONAL * query.cell - most_roundoff(scene)
    return SearchGrid(
        query.origin,
        query.cell,
        CELL_LEVELS,
        clearance,
        max(clearance, 2.0 * HALF_DIAGONAL * query.cell - clearance),
        query.radius,
        query.radius,
        query.longest,
        query.origin,
        query.free_length + HALF_DIAGONAL * query.cell,
        ZERO,
        query.goal,
        query.goal_radius + query.goal_slack,
        ZERO,
        0.0,
        GREEDY,
        0.0,
        math.inf,
        UPPER_BOUND,
    )
