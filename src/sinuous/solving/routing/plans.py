"""What is planned: the searches for routes to one target, and what is tried along each of them; what is quick first."""

from functools import lru_cache
from typing import NamedTuple

from sinuous.checks import Floats
from sinuous.kernels.freespace.grid import HALF_DIAGONAL
from sinuous.solving.routing.growth import FEW, GLANCE, MANY, ONE, SOME, Beam

COARSE = 64
"""Finest cells in the length of the longest robot, at most, at first."""

BETWEEN = 3.0
"""Edge of the coarse cells, in those of the fine ones, from which on cells of twice the finest come between."""

ALTERNATIVES = 4
"""Routes to one target that differ."""

CELLS = (1 << 14, 1 << 17, 1 << 19)
"""Most cells of a search, by blocks of eight of which some nobody looks at."""

GROWN = {ONE: 4, SOME: 5, FEW: 9, MANY: 100}
"""What it costs to grow chains along a route, from either end, in scattered starts, about."""

GATES = {GLANCE: 3, ONE: 4, SOME: 12, FEW: 40, MANY: 150}
"""The same for chains through the gates at the first place of a passage, part after part."""

LATER = (1.0, 1.5, 3.0)
"""How much more it takes until those through the next places lead to a solution."""

BLIND, GLANCED = 3, 4
"""How much later chains are grown through gates of routes over coarse cells, many of which cut through walls; and what
the first glance at these costs."""

BENT = (15, 15, 25, 25, 50, 50, 50, 50)
"""What it costs to make a route longer, side by side."""


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
    between : bool
        Whether it is left out where a route is known, until a table of finer cells is full.
    """

    cell: float
    clearance: float
    cells: int
    routes: int
    then: int
    exact: bool
    prove: bool
    effort: int
    between: bool = False


def coarser(plan: Plan, radius: float) -> Plan:
    """A plan with cells of twice the edge."""
    return plan._replace(cell=2.0 * plan.cell, clearance=wide_enough(radius, 2.0 * plan.cell))


def wide_enough(radius: float, cell: float) -> float:
    """Clearance with which coarse cells can be passed."""
    return max(radius - 0.5 * cell, 0.25 * radius)


def plans_of(radius: float, length: float, proves: bool) -> tuple[Plan, ...]:
    """Searches for a ball of this radius and a robot of this length, from the quickest to the most thorough.

    Cells of half the radius and less cannot leak through a wall, however thin it is, and prove that a room is closed,
    if the ball is no thicker than the robot. Coarser ones miss narrow passages.
    """
    fine = 0.5 * radius
    coarse = max(fine, length / COARSE)
    through = radius - HALF_DIAGONAL * fine
    wide = wide_enough(radius, coarse)
    few, many, most = CELLS
    first = [Plan(coarse, wide, few, 1, 5, False, False, 8)] if coarse > fine else []
    if coarse > BETWEEN * fine:
        first.append(coarser(first[0]._replace(cell=fine, between=True), radius))
    second = [Plan(coarse, wide, few, ALTERNATIVES, 20, False, False, 110)] if coarse > fine else []
    return (
        *first,
        Plan(fine, through, few, 1, 10, False, proves, 20),
        *second,
        Plan(fine, through, many, ALTERNATIVES, 80, False, proves, 220),
        Plan(fine, through, many, 1, 80, True, proves, 220),
        Plan(fine, through, most, ALTERNATIVES, 200, True, proves, 440),
    )


class Line(NamedTuple):
    """A route, along which chains are grown.

    Attributes
    ----------
    route : ndarray (K, 3)
    finest : bool
        Whether it leads around edges, or over the finest cells: others may cut through walls.
    exact : bool
        Whether it comes from exact distances, not from samples.
    rank : int
        How many were known before it, and one.
    weight : int
        How many were known that are not coarser, and one.
    """

    route: Floats
    finest: bool
    exact: bool
    rank: int
    weight: int


class Chore(NamedTuple):
    """Something to try along a route.

    Attributes
    ----------
    cost : int
        What it costs, in scattered starts, about.
    beam : Beam or None
        How chains are grown; `None`: the route is made longer.
    which : int
        To which side, then; or through which gate, -1: through none.
    """

    cost: int
    beam: Beam | None
    which: int


class Task(NamedTuple):
    """The next of all that is to be tried along a line: smaller comes first.

    Attributes
    ----------
    cost : int
        What it costs, in scattered starts, times the weight of its line.
    rank, number : int
        Of the line among all, and of the task among those of the line.
    line : Line
    chores : tuple of Chore
        All that is to be tried along the line.
    """

    cost: int
    rank: int
    number: int
    line: Line
    chores: tuple[Chore, ...]


@lru_cache
def chores_of(grows: bool, gates: bool, finest: bool, sides: int) -> tuple[Chore, ...]:
    """What is to be tried along a route, the cheapest first.

    Whether chains are grown along it, and through its gates; whether it leads around edges, or over the finest cells;
    and to how many sides it is bent.
    """
    chores = [Chore(cost, beam, -1) for beam, cost in GROWN.items() if grows]
    for beam, cost in GATES.items() if grows and gates else ():
        if beam == GLANCE:
            chores.append(Chore(cost if finest else GLANCED, beam, 0))
            continue
        chores += [Chore(round(cost * (1 if finest else BLIND) * by), beam, gate) for gate, by in enumerate(LATER)]
    chores += [Chore(BENT[side], None, side) for side in range(sides)]
    return tuple(sorted(chores, key=lambda chore: chore.cost))
