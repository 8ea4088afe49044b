"""What is asked of a route search, and the grids that answer it.

`query` (QUERY_WIDTH,) is flat, see `tables`.
"""

import math
from collections import namedtuple

from sinuous.kernels import tables as t
from sinuous.kernels.fields.distances import Scene, most_roundoff
from sinuous.kernels.fields.solids import INTERPOLATED, UPPER_BOUND
from sinuous.kernels.fields.triangles import read
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid
from sinuous.kernels.maths.vectors import ZERO, Array, add_scaled

INFLATION = 2.0
"""See `SearchGrid`: among obstacles a route costs more than its length, and to find the cheapest one is far dearer."""

GREEDY = 1e6
"""The inflation of a proof: it asks whether there is a route, whatever that costs."""

CLEARANCE_WEIGHT = 0.2
"""See `grid.SearchGrid`: little, because with more the search examines all the room around a narrow place first."""

CELL_LEVELS = 7
"""Sizes of cells beside the finest, each twice as large as the one before."""

Query = namedtuple(
    "Query",
    "origin axis goal normal goal_radius goal_slack radius longest free_length cell clearance free_margin most_cells "
    "prove",
)
"""The numbers of a query by their names, see `sinuous.kernels.tables`."""


def read_query(query: Array) -> Query:
    """Take a query (QUERY_WIDTH,) apart."""
    return Query(
        read(query, t.QUERY_ORIGIN),
        read(query, t.QUERY_AXIS),
        read(query, t.QUERY_GOAL),
        read(query, t.QUERY_NORMAL),
        query[t.QUERY_GOAL_RADIUS],
        query[t.QUERY_GOAL_SLACK],
        query[t.QUERY_RADIUS],
        query[t.QUERY_LONGEST],
        query[t.QUERY_FREE_LENGTH],
        query[t.QUERY_CELL],
        query[t.QUERY_CLEARANCE],
        query[t.QUERY_FREE_MARGIN],
        int(query[t.QUERY_MOST_CELLS]),
        query[t.QUERY_PROVE] != 0.0,
    )


def route_grid(query: Query) -> SearchGrid:
    """The grid for routes: from the end of the mount, where they have left along the axis, to the goal."""
    start = add_scaled(query.origin, query.free_length, query.axis)
    ample = max(query.clearance, 2.0 * HALF_DIAGONAL * query.cell - query.clearance)
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
        query.goal,
        query.goal_radius,
        INFLATION,
        CLEARANCE_WEIGHT,
        query.longest - query.free_length + query.goal_radius + query.cell,
        INTERPOLATED,
        query.normal,
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
        query.goal,
        query.goal_radius + query.goal_slack,
        GREEDY,
        0.0,
        math.inf,
        UPPER_BOUND,
        ZERO,
    )
