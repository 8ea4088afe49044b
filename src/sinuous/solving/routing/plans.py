"""Searches for routes over cells: how large the cells are, how many, and what is asked for."""

from typing import NamedTuple

from sinuous.kernels.freespace.grid import HALF_DIAGONAL

COARSE = 64
"""Finest cells in the length of the longest robot, at most, at first."""

CELLS = (1 << 14, 1 << 17, 1 << 19)
"""Most cells of a search, by blocks of eight of which some nobody looks at."""


class Plan(NamedTuple):
    """One search.

    Attributes
    ----------
    cell : float
        Edge of the cells.
    clearance : float
        Distance from the obstacles with which a cell can be passed.
    cells : int
        Most cells that are looked at.
    routes : int
        Most routes to find.
    exact : bool
        Whether to ask for exact distances, not for samples.
    prove : bool
        Whether to prove that there is none, where none is found.
    between : bool
        Whether it is left out where a route is known, until a table of finer cells is full.
    """

    cell: float
    clearance: float
    cells: int
    routes: int
    exact: bool
    prove: bool
    between: bool = False


def coarser(plan: Plan, radius: float) -> Plan:
    """A plan with cells of twice the edge."""
    return plan._replace(cell=2.0 * plan.cell, clearance=wide_enough(radius, 2.0 * plan.cell))


def wide_enough(radius: float, cell: float) -> float:
    """Clearance with which coarse cells can be passed."""
    return max(radius - 0.5 * cell, 0.25 * radius)


def plan_of(radius: float, length: float, coarse: bool) -> Plan:
    """Search for one route with coarse, or with fine cells, for a ball of this radius and a robot of this length.

    Cells of half the radius and less cannot leak through a wall, however thin it is. Coarser ones miss narrow passages.
    """
    fine = 0.5 * radius
    cell = max(fine, length / COARSE) if coarse else fine
    clearance = wide_enough(radius, cell) if cell > fine else radius - HALF_DIAGONAL * fine
    return Plan(cell, clearance, CELLS[0], 1, False, False)
