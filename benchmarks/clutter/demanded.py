"""What a demanded clearance and the room that answers take cost: `python -m benchmarks.clutter.demanded`.

Each place is solved four times: as ever; with a clearance demanded that its hidden shape keeps; by a body that is
thicker by as much, which is as hard to lead among obstacles; and without the steps that lead out of contact. What
counts is the CPU time of the thread; the second of two solves is timed. An answer counts after judges that share no
code with the kernels found it right, and as clear as was demanded.
"""

import math
import sys
from collections.abc import Iterator, Sequence
from statistics import median
from typing import NamedTuple

import numpy as np
import typer

from benchmarks.clutter.by_family import LIMIT, PATIENCE, Alone, Count, Pieces, Seed, of_places, timed
from benchmarks.harness.command import command
from benchmarks.judges.clearances import least_clearance
from benchmarks.places import Place, make
from benchmarks.places.place import right
from sinuous.solving.solver import Solver

WAYS = ("as ever", "demanded", "thicker", "without room")

SHARE = 0.5
"""Of the clearance of the hidden shape, what is demanded."""

CONTACT = 0.02
"""Clearance below which an answer is in contact, in radii."""


class Row(NamedTuple):
    """One place, solved in one way: whether it is, and right; CPU time; clearance in radii; what was demanded."""

    family: str
    way: str
    solved: bool
    milliseconds: float
    clearance: float
    demanded: float


def examined(place: tuple[str, int]) -> list[Row]:
    """Solve one place in all ways."""
    at = make(*place)
    hidden = least_clearance(at.robot, at.scene, at.hidden_q[None])[0]
    clearance = SHARE * max(0.0, float(hidden))
    return [_row(at, way, clearance if way in ("demanded", "thicker") else 0.0) for way in WAYS]


def _row(at: Place, way: str, demanded: float) -> Row:
    robot = at.robot.changed(clearance=demanded)
    if way == "thicker":
        robot = at.robot.changed(segments=[each.changed(radius=each.radius + demanded) for each in at.robot.segments])
    solver = Solver(robot, at.scene, tolerance=at.tolerance, time=PATIENCE * LIMIT)
    if way == "without room":
        solver._prepared.grazing = -math.inf
    solution, spent = timed(solver, at)
    solved = solution.solved and spent <= LIMIT and right(at, solution.q)
    clearance = float(least_clearance(at.robot, at.scene, solution.q[None])[0]) if solved else 0.0
    kept = clearance >= demanded * (1.0 - 1e-9)
    return Row(at.family, way, solved and kept, 1e3 * spent, clearance / max(at.robot.radii), demanded)


def tables(rows: Sequence[Row]) -> Iterator[str]:
    """Yield Markdown: solved, median and p95, and answers in contact, by family and of all together."""
    yield "| family | way | solved | median, ms | p95, ms | worst, ms | time, of as ever | in contact |"
    yield "|---|---|---:|---:|---:|---:|---:|---:|"
    families = [*dict.fromkeys(row.family for row in rows), "all"]
    for family in families:
        own = {way: [row for row in rows if row.way == way and family in (row.family, "all")] for way in WAYS}
        for way, found in own.items():
            pairs = zip(own["as ever"], found, strict=True)
            ratios = [b.milliseconds / a.milliseconds for a, b in pairs if a.solved and b.solved]
            spent, good = [row.milliseconds for row in found], [row for row in found if row.solved]
            touching = sum(row.clearance < CONTACT for row in good)
            slow = float(np.quantile(spent, 0.95))
            yield (
                f"| {family} | {way} | {len(good)}/{len(found)} | {median(spent):.3f} | {slow:.1f} | "
                f"{max(spent):.0f} | {median(ratios or [1.0]):.2f} | {touching} |"
            )


def run(
    piece: Pieces = None,
    seed: Seed = 0,
    count: Count = 60,
    alone: Alone = False,
) -> None:
    """Print what a demanded clearance, and room that is taken, cost by family of places."""
    typer.echo("\n".join(tables(of_places(examined, piece, seed, count, alone))))


main = command(run, "benchmarks.clutter.demanded")


if __name__ == "__main__":
    sys.exit(main())
