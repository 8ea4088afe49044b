"""The searches for routes to one target, from the quickest to the most thorough."""

from typing import NamedTuple

from sinuous.kernels.freespace.grid import HALF_DIAGONAL

COARSE, FINE = 64, 20_000
"""Finest cells in the length of the longest robot: most of them at first, and most at all."""

ALTERNATIVES = 4
"""Routes to one target that differ."""

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
    then : int
        Least number of scattered starts that come before the next search; what it costs may ask for more.
    exact : bool
        Whether to ask for exact distances, not for samples.
    prove : bool
        Whether to prove that there is none, where none is found.
    effort : int
        What may be tried along all routes before the next search, in scattered starts.
    """

    cell: float
    clearance: float
    cells: int
    routes: int
    then: int
    exact: bool
    prove: bool
    effort: int


def coarser(plan: Plan, radius: float) -> Plan:
    """A plan with cells of twice the edge."""
    return plan._replace(cell=2.0 * plan.cell, clearance=wide_enough(radius, 2.0 * plan.cell))


def wide_enough(radius: float, cell: float) -> float:
    """Clearance with which coarse cells can be passed."""
    return max(radius - 0.5 * cell, 0.25 * radius)


def plans_of(radius: float, length: float) -> tuple[Plan, ...]:
    """Searches for a body of this radius and a robot of this length, from the quickest to the most thorough.

    Cells of half the radius and less cannot leak through a wall, however thin it is, and prove that a room is closed.
    Coarser ones miss narrow passages.
    """
    fine = max(0.5 * radius, length / FINE)
    coarse = max(fine, length / COARSE)
    through = radius - HALF_DIAGONAL * fine
    wide = wide_enough(radius, coarse)
    proves = fine <= 0.5 * radius
    few, many, most = CELLS
    first = [Plan(coarse, wide, few, 1, 5, False, False, 8)] if coarse > fine else []
    second = [Plan(coarse, wide, few, ALTERNATIVES, 20, False, False, 110)] if coarse > fine else []
    return (
        *first,
        Plan(fine, through, few, 1, 10, False, proves, 20),
        *second,
        Plan(fine, through, many, ALTERNATIVES, 80, False, proves, 220),
        Plan(fine, through, many, 1, 80, True, proves, 220),
        Plan(fine, through, most, ALTERNATIVES, 200, True, proves, 440),
    )
