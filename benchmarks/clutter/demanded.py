"""What a demanded clearance and the room that answers take cost: `python -m benchmarks.clutter.demanded`.

Each place is solved in five ways, and each way is held against one that is as hard:

- a trace of clearance is demanded, a millionth of the radius: the problem is the one without;
- a clearance is demanded that the hidden shape keeps; against a body that is thicker by as much, which is as hard to
  lead among obstacles;
- without the steps that lead out of contact; against what is done as ever.

What counts is the CPU time of the thread: all ways take turns, and the least of several solves is taken, for a solve is
the same each time. Ratios are of places that both ways solve, and again of those where both find the same shape. An
answer counts after judges that share no code with the kernels found it right, and as clear as was demanded.
"""

import math
import sys
from collections.abc import Iterator, Sequence
from statistics import median
from time import thread_time
from typing import NamedTuple

import numpy as np
import typer

from benchmarks.clutter.by_family import LIMIT, PATIENCE, Alone, Count, Pieces, Seed, of_places
from benchmarks.harness.command import command
from benchmarks.judges.clearances import least_clearance
from benchmarks.places import Place, make
from benchmarks.places.place import right
from sinuous.base.checks import Floats
from sinuous.kernels.tables import CLEARANCE_MARGIN
from sinuous.solver.solver import Solver

AGAINST = {
    "as ever": "as ever",
    "a trace demanded": "as ever",
    "without room": "as ever",
    "thicker": "thicker",
    "demanded": "thicker",
}
"""The ways, and which one each is held against."""

SHARE = 0.5
"""Of the clearance of the hidden shape, what is demanded."""

TRACE = 1e-6
"""A clearance that changes nothing, in radii."""

CONTACT = 0.02
"""Clearance below which an answer is in contact, in radii."""

TURNS, ENOUGH = 8, 0.3
"""Most solves in each way, and seconds after which there are no more than two."""

SAME = 1e-3
"""How far shapes are apart that count as the same: rad, and mean lengths of a segment."""


class Row(NamedTuple):
    """One place, solved in one way: whether it is, and right; CPU time; clearance in radii; what was demanded."""

    family: str
    way: str
    solved: bool
    milliseconds: float
    clearance: float
    demanded: float
    q: Floats


def examined(place: tuple[str, int]) -> list[Row]:
    """Solve one place in all ways."""
    at = make(*place)
    hidden = least_clearance(at.robot, at.scene, at.hidden_q[None])[0]
    clearance, trace = SHARE * max(0.0, float(hidden)), TRACE * max(at.robot.radii)
    thicker = [each.changed(radius=each.radius + clearance) for each in at.robot.segments]
    robots = {
        "as ever": at.robot,
        "a trace demanded": at.robot.changed(clearance=trace),
        "without room": at.robot,
        "thicker": at.robot.changed(segments=thicker),
        "demanded": at.robot.changed(clearance=clearance),
    }
    made = {way: Solver(own, at.scene, tolerance=at.tolerance, time=PATIENCE * LIMIT) for way, own in robots.items()}
    made["without room"]._prepared._settings[CLEARANCE_MARGIN] = 0.0
    demanded = {"a trace demanded": trace, "thicker": clearance, "demanded": clearance}
    answers, spent = {way: solver.solve(at.targets) for way, solver in made.items()}, dict.fromkeys(made, math.inf)
    began = thread_time()
    for turn in range(TURNS):
        for way, solver in made.items():
            now = thread_time()
            answers[way] = solver.solve(at.targets)
            spent[way] = min(spent[way], thread_time() - now)
        if turn and thread_time() - began > ENOUGH:
            break
    return [_row(at, way, found.solved, found.q, spent[way], demanded.get(way, 0.0)) for way, found in answers.items()]


def _row(at: Place, way: str, claimed: bool, q: Floats, spent: float, demanded: float) -> Row:
    solved = claimed and spent <= LIMIT and right(at, q)
    clearance = float(least_clearance(at.robot, at.scene, q[None])[0]) if solved else 0.0
    kept = clearance >= demanded * (1.0 - 1e-9)
    return Row(at.family, way, solved and kept, 1e3 * spent, clearance / max(at.robot.radii), demanded, q)


def _alike(a: Row, b: Row) -> bool:
    """Whether both ways found the same shape."""
    unit = np.array([1.0, 1.0, float(a.q[:, 2].mean())])
    return bool(np.abs((a.q - b.q) / unit).max() < SAME)


def tables(rows: Sequence[Row]) -> Iterator[str]:
    """Yield Markdown: solved, median and p95, times as parts of those it is held against, and answers in contact."""
    yield (
        "| family | way | solved | median, ms | p95, ms | held against | its time: median | p95 | worst | "
        "same shape: median | p95 | worst | in contact |"
    )
    yield "|---|---|---:|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|"
    for family in [*dict.fromkeys(row.family for row in rows), "all"]:
        own = {way: [row for row in rows if row.way == way and family in (row.family, "all")] for way in AGAINST}
        for way, found in own.items():
            pairs = [(a, b) for a, b in zip(own[AGAINST[way]], found, strict=True) if a.solved and b.solved]
            both = [b.milliseconds / a.milliseconds for a, b in pairs]
            same = [b.milliseconds / a.milliseconds for a, b in pairs if _alike(a, b)]
            spent, good = [row.milliseconds for row in found], [row for row in found if row.solved]
            touching = sum(row.clearance < CONTACT for row in good)
            yield (
                f"| {family} | {way} | {len(good)}/{len(found)} | {median(spent):.3f} | "
                f"{float(np.quantile(spent, 0.95)):.1f} | {AGAINST[way]}, {len(both)} | {_spread(both)} | "
                f"{len(same)}: {_spread(same)} | {touching} |"
            )


def _spread(ratios: Sequence[float]) -> str:
    """Median, 95 % and worst of ratios, as cells of a table."""
    if not ratios:
        return " |  | "
    return f"{median(ratios):.3f} | {float(np.quantile(ratios, 0.95)):.2f} | {max(ratios):.2f}"


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
