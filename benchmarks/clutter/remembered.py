"""What remembered starts bring: `python -m benchmarks.clutter.remembered [--piece FAMILY] [--count N]`.

One place of each family is solved once, and then for many targets along and about its hidden shape: those of shapes
that the judge finds free, a random walk away from it. A solver with a memory is asked all targets, one after the
other, and then one without; times are CPU times of the thread, so that other work on the machine hardly matters.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np
import typer

from benchmarks.clutter.by_family import Alone, Pieces, of_families, quantiles, tell, timed
from benchmarks.harness.command import command
from benchmarks.judges.kinematics import tip_poses
from benchmarks.places import Place, make
from benchmarks.places.place import feasible, right
from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.problem.target import Target
from sinuous.solver.memory import Memory
from sinuous.solver.solver import Solver

SHORTEST, LONGEST = 1e-3, 0.5
"""Standard deviation of a step away from a shape, rad, drawn between these with equal shares of each size."""

LENGTH_SHARE = 0.3
"""The same of lengths, in longest lengths of a segment a radian."""

PATIENCE = 60
"""Draws for each target."""


class Row(NamedTuple):
    """What many targets in one place came to.

    Attributes
    ----------
    family : str
    targets : int
    solved, solved_without : int
        Of these, with a memory and without, as the judge finds.
    wrong : int
        Solutions that the judge refutes.
    remembered : int
        Solutions that began from a remembered shape.
    kept : int
        Shapes in the memory in the end.
    spent, spent_without : tuple of float
        Median, 95th percentile and worst time, ms.
    """

    family: str
    targets: int
    solved: int
    solved_without: int
    wrong: int
    remembered: int
    kept: int
    spent: tuple[float, ...]
    spent_without: tuple[float, ...]


def targets_about(place: Place, count: int, rng: np.random.Generator) -> Iterator[Place]:
    """Yield the same place with other hidden shapes and targets, all feasible: at most `count`."""
    lengths = np.array([segment.length for segment in place.robot.segments])
    scale = np.array([1.0, 1.0, LENGTH_SHARE * lengths[:, 1].max()])
    shapes = [place.hidden_q]
    for _ in range(PATIENCE * count):
        step = np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST)))
        q = shapes[rng.integers(len(shapes))] + step * scale * rng.standard_normal(place.hidden_q.shape)
        q[:, 2] = np.clip(q[:, 2], lengths[:, 0], lengths[:, 1])
        tip = tip_poses(place.robot, q[None])[0]
        direction = None if place.target.direction is None else tip[:3, 2]
        other = replace(place, targets=(Target(tip[:3, 3], direction=direction),), hidden_q=q)
        if feasible(other):
            shapes.append(q)
            yield other
            if len(shapes) > count:
                return


def measured(family: str, seed: int, count: int) -> Row:
    """Ask all targets of one place."""
    place = make(family, seed)
    memory = Memory(place.robot)
    solvers = [Solver(place.robot, place.scene, memory=kept, tolerance=place.tolerance) for kept in (memory, None)]
    for solver in solvers:
        solver.solve(place.targets)
    others = list(targets_about(place, count, np.random.default_rng(seed)))
    found: list[list[tuple[Solution, bool, float]]] = []
    for solver in solvers:
        asked = [timed(solver, other, runs=1) for other in others]
        found.append([(one, right(other, one.q), spent) for other, (one, spent) in zip(others, asked, strict=True)])
    solved, without = ([one for one in answers if one[0].solved] for answers in found)
    return Row(
        family,
        len(found[0]),
        sum(fine for _, fine, _ in solved),
        sum(fine for _, fine, _ in without),
        sum(not fine for _, fine, _ in solved + without),
        Counter(solution.start for solution, _, _ in solved)["remembered"],
        len(memory),
        *(quantiles([spent for _, _, spent in answers]) for answers in found),
    )


def table(rows: Sequence[Row]) -> Iterator[str]:
    """Yield Markdown: a line a family, and one of all."""
    yield "| family | targets | solved, without | wrong | remembered | kept | ms: median, p95, worst | without |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|"
    for row in rows:
        times = ("{:.2f}, {:.2f}, {:.1f}".format(*each) for each in (row.spent, row.spent_without))
        yield (
            f"| {row.family} | {row.targets} | {row.solved}, {row.solved_without} | {row.wrong} | {row.remembered} "
            f"| {row.kept} | {next(times)} | {next(times)} |"
        )


def run(
    piece: Pieces = None,
    seed: Annotated[int, typer.Option(help="Of the place of each family.")] = 0,
    count: Annotated[int, typer.Option(help="Targets in each place.")] = 200,
    alone: Alone = False,
) -> None:
    """Print what remembered starts bring, by family of places."""
    checks.integer("--seed", seed, 0, 2**31 - 1)
    checks.integer("--count", count, 1, 10_000)
    rows = of_families(partial(measured, seed=seed, count=count), piece, alone)
    tell(table(rows), any(row.wrong for row in rows))


main = command(run, "benchmarks.clutter.remembered")


if __name__ == "__main__":
    sys.exit(main())
