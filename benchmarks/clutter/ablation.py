"""What each attempt of the solver brings: `python -m benchmarks.clutter.ablation [--piece NAME] [--count N]`.

Each place is solved with everything, and with one attempt after the other switched off. What counts is the CPU time of
the thread, so that other work on the machine hardly matters; the second of two solves is timed.
"""

import csv
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from statistics import fmean, median
from typing import Annotated, NamedTuple

import numpy as np
import typer

from benchmarks.clutter.by_family import LIMIT, PATIENCE, Alone, Count, Pieces, Seed, of_places, timed
from benchmarks.harness.command import command
from benchmarks.places import Place, make
from benchmarks.places.place import right
from sinuous.base import checks
from sinuous.cli.options import check_writable
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.solver.attempts import ATTEMPTS
from sinuous.solver.solver import Solver
from sinuous.solver.strategy import OPENING

EVERYTHING = "everything"
"""What is called where nothing is switched off."""

OFF = tuple(name for name in ATTEMPTS if name != "remembered")
"""What is switched off in turn: there is no memory."""

MOVES_SOLVED, MOVES_TIME = 0.01, 0.10
"""Share of the places of a family that is lost, and share by which its p95 changes, from which on an attempt counts."""


LEAST = 2.0
"""Least change of a p95 that counts, ms: of less than that, other work on the machine makes as much."""


class Row(NamedTuple):
    """One place, with one attempt switched off.

    Attributes
    ----------
    family : str
    seed : int
    off : str
    solved : bool
        Within the limit, and right.
    milliseconds : float
        CPU time; that of the limit where it is not solved.
    """

    family: str
    seed: int
    off: str
    solved: bool
    milliseconds: float


def examined(place: tuple[str, int], off: Sequence[str] = OFF) -> list[Row]:
    """Solve one place with everything, and with each attempt switched off."""
    family, seed = place
    at = make(family, seed)
    whole, opened = _row(at, EVERYTHING)
    # what the first call solves knows no attempts
    return [whole, *(whole._replace(off=name) if opened else _row(at, name)[0] for name in off)]


def _row(at: Place, off: str) -> tuple[Row, bool]:
    without = () if off == EVERYTHING else (off,)
    solver = Solver(at.robot, at.scene, tolerance=at.tolerance, time=PATIENCE * LIMIT, without=without)
    solution, spent = timed(solver, at)
    solved = solution.solved and spent <= LIMIT and right(at, solution.q)
    opened = solution.solved and solution.start != SOURCES[ROUTE] and solution.starts <= OPENING
    return Row(at.family, at.seed, off, solved, 1e3 * (spent if solved else LIMIT)), opened


def tables(rows: Sequence[Row]) -> Iterator[str]:
    """Yield Markdown: what each attempt brings over all places, and the families with everything switched on."""
    by: defaultdict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        by[row.family, row.off].append(row)
        by["all", row.off].append(row)
    families = list(dict.fromkeys(row.family for row in rows))
    yield "| switched off | solved | mean, ms | median, ms | p95, ms | families that it moves |"
    yield "|---|---:|---:|---:|---:|---|"
    for name in dict.fromkeys(row.off for row in rows):
        moved = {family: _moved(by[family, EVERYTHING], by[family, name]) for family in families}
        told = ", ".join(f"{family} ({how})" for family, how in moved.items() if how)
        figures = _figures(by["all", name])
        mean = fmean(row.milliseconds for row in by["all", name])
        yield f"| {name} | {figures[0]} | {mean:.1f} | {figures[1]:.2f} | {figures[2]:.1f} | {told} |"
    yield ""
    yield "With everything:"
    yield ""
    yield "| family | solved | median, ms | p95, ms |"
    yield "|---|---:|---:|---:|"
    for family in (*families, "all"):
        yield f"| {family} | " + "{} | {:.2f} | {:.1f} |".format(*_figures(by[family, EVERYTHING]))


def _figures(rows: Sequence[Row]) -> tuple[str, float, float]:
    spent = [row.milliseconds for row in rows]
    return f"{sum(row.solved for row in rows)}/{len(rows)}", median(spent), float(np.quantile(spent, 0.95))


def _moved(whole: Sequence[Row], without: Sequence[Row]) -> str:
    """How an attempt matters in a family: how many more places are lost without it, or how much longer the p95 is."""
    lost = sum(row.solved for row in whole) - sum(row.solved for row in without)
    if lost > MOVES_SOLVED * len(whole):
        return f"{lost} lost"
    before, after = (_figures(rows)[2] for rows in (whole, without))
    slower = after > (1.0 + MOVES_TIME) * before and after - before > LEAST
    return f"x {after / before:.1f}" if slower else ""


def run(
    piece: Pieces = None,
    seed: Seed = 0,
    count: Count = 60,
    only: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Switch off only this attempt; repeat for more.")
    ] = None,
    alone: Alone = False,
    out: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Keep what each place took.")] = None,
) -> None:
    """Print what each attempt of the solver brings, by family of places."""
    off = OFF if not only else tuple(checks.choice("--only", name, OFF) for name in only)
    if out is not None:
        check_writable("--csv", out)
    rows = of_places(partial(examined, off=off), piece, seed, count, alone)
    if out is not None:
        with out.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([Row._fields, *rows])
    typer.echo("\n".join(tables(rows)))


main = command(run, "benchmarks.clutter.ablation")


if __name__ == "__main__":
    sys.exit(main())
