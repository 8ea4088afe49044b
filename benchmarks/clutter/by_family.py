"""What commands share that solve some places of each family, beside `clutter`: options, places, and CPU time."""

from collections.abc import Callable, Iterable
from time import thread_time
from typing import Annotated, NoReturn, TypeVar

import numpy as np
import typer

from benchmarks.harness.experiment import chosen
from benchmarks.harness.quiet import ignore_suspicions
from benchmarks.places import FAMILIES, Place
from benchmarks.solvers.parallel import in_processes
from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.solver.solver import Solver

Pieces = Annotated[
    list[str] | None, typer.Option("--piece", metavar="FAMILY", help="Only this family, or a pattern; repeat for more.")
]
Seed = Annotated[int, typer.Option(help="Place i of a family is 1000 * seed + i.")]
Count = Annotated[int, typer.Option(help="Places of each family.")]
Alone = Annotated[bool, typer.Option("--alone", help="In this process, instead of one for each core.")]

LIMIT = 1.0
"""Seconds of CPU time in which a place has to be solved."""

PATIENCE = 3.0
"""Budget of a solve on the clock, in units of that: the machine may be busy."""

Row = TypeVar("Row")


def of_places(
    examined: Callable[[tuple[str, int]], Iterable[Row]], pieces: list[str] | None, seed: int, count: int, alone: bool
) -> list[Row]:
    """Examine so many places, each given by family and number, of every family that is chosen, and return all rows.

    Raises
    ------
    InputError
        Where a pattern fits no family, or a number is out of range.
    """
    checks.integer("--seed", seed, 0, 2**31 // 1000 - 1)
    checks.integer("--count", count, 1, 1000)
    places = [(family, 1000 * seed + i) for family in families_of(pieces) for i in range(count)]
    ignore_suspicions()
    return [row for rows in in_processes(examined, places, alone=alone) for row in rows]


def of_families(examined: Callable[[str], Row], pieces: list[str] | None, alone: bool) -> list[Row]:
    """Examine every family that is chosen, by its name, and return what came of it."""
    ignore_suspicions()
    return list(in_processes(examined, families_of(pieces), alone=alone))


def tell(lines: Iterable[str], wrong: bool) -> NoReturn:
    """Print lines, and end with 1 where something is wrong."""
    typer.echo("\n".join(lines))
    raise typer.Exit(int(wrong))


def quantiles(seconds: list[float]) -> tuple[float, ...]:
    """Return median, 95th percentile and worst of times, in ms; NaN of none."""
    return tuple((1e3 * np.quantile(seconds, [0.5, 0.95, 1.0])).tolist()) if seconds else (np.nan,) * 3


def families_of(pieces: list[str] | None) -> list[str]:
    """Return the families that fit one of the patterns, or all, in their order."""
    fitting = chosen(list(FAMILIES), pieces or ["*"])
    return [name for name in FAMILIES if name in fitting]


def timed(solver: Solver, place: Place, runs: int = 2) -> tuple[Solution, float]:
    """Solve a place so often; return the last solution, and the seconds of CPU time of this thread that it took."""
    for _ in range(runs):
        began = thread_time()
        solution = solver.solve(place.targets)
        spent = thread_time() - began
    return solution, spent
