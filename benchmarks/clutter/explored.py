"""What exploring brings to plans: `python -m benchmarks.clutter.explored [--piece FAMILY] [--count N] [--rounds N]`.

The robot waits straight, or, where that is not clear, in a shape that reaches a place away from the hidden tip. One
place of each family is solved once with a memory, and explored from there and from where the robot waits. Then ways are
planned from there to the hidden shape and to targets about it that the judge finds feasible (see `remembered`), with
what was explored, which nothing is added to, and some of them without; times are CPU times of the thread. A place is
connected where the memory has a way to the shape that was solved; the judges look at every motion called proved.
"""

import sys
from collections.abc import Iterator, Sequence
from functools import partial
from time import thread_time
from typing import Annotated, NamedTuple

import numpy as np
import typer

from benchmarks.clutter.by_family import Alone, Pieces, of_families, quantiles, tell
from benchmarks.clutter.remembered import targets_about
from benchmarks.harness.command import command
from benchmarks.motion.judged import collides
from benchmarks.motion.places.into import elsewhere
from benchmarks.motion.places.motions import straight
from benchmarks.places import make
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.motion.motion import Motion
from sinuous.motion.plan import Goal, Planner
from sinuous.solver.memory import Memory
from sinuous.solver.solver import Solver
from sinuous.studies.exploring.explore import explore

WITHOUT = 5
"""Plans that are also made without a memory."""

SECONDS = 5.0
"""Budget of a plan."""

PATIENCE = 3600.0
"""Seconds of exploring, whatever the rounds."""


class Row(NamedTuple):
    """What plans in one place came to.

    Attributes
    ----------
    family : str
    explored : str
        Shapes, motions, and shares that are covered and joined.
    connected : bool
        Whether a walk leads to the shape that was solved.
    plans, solved, wrong : int
        `wrong`: of those called proved, the ones in which a judge finds a collision.
    spent, without : tuple of float
        Median, 95th percentile and worst time, ms, of those that are solved.
    solved_without : str
        Of how many.
    """

    family: str
    explored: str
    connected: bool
    plans: int
    solved: int
    wrong: int
    spent: tuple[float, ...]
    without: tuple[float, ...]
    solved_without: str


def measured(family: str, seed: int, count: int, rounds: int) -> Row | None:
    """Explore one place, and plan in it; `None` where no shape is found in which the robot could wait."""
    place = make(family, seed)
    planner = Planner(place.robot, place.scene, time=SECONDS, tolerance=place.tolerance)
    start: Floats | None = straight(place.robot)
    if planner.plan(straight(place.robot), place.hidden_q).status is Status.START_BLOCKED:
        start = elsewhere(place)
    if start is None:
        return None
    memory = Memory(place.robot)
    Solver(place.robot, place.scene, memory=memory, tolerance=place.tolerance).solve(place.targets)
    found = explore(place.robot, place.scene, time=PATIENCE, rounds=rounds, memory=memory, starts=start, workers=1)
    walker = Planner(place.robot, place.scene, memory=memory.reading(), time=SECONDS, tolerance=place.tolerance)
    parts = memory._shapes.everything.parts
    there = memory._shapes.everything.near_shapes(np.stack([start, memory.q[0]]), 1)[:, 0]
    others = targets_about(place, count, np.random.default_rng(seed))
    goals: list[Goal] = [place.hidden_q, *(list(other.targets) for other in others)]
    walker.plan(start, goals[-1])  # what is kept of the memory is made by the first plan
    planned = [_planned(walker, start, goal) for goal in goals]
    solved = [(motion, spent) for motion, spent in planned if motion.solved]
    without = [_planned(planner, start, goal) for goal in goals[:WITHOUT]]
    also = [spent for motion, spent in without if motion.solved]
    return Row(
        family,
        f"{found.shapes:,}, {found.motions:,}, {found.covered:.0%}, {found.joined:.0%}",
        bool(parts[there[0]] == parts[there[1]]),
        len(planned),
        len(solved),
        sum(bool(collides(place.robot, place.scene, motion.q)) for motion, _ in solved),
        quantiles([spent for _, spent in solved]),
        quantiles(also),
        f"{len(also)} of {len(without)}",
    )


def _planned(planner: Planner, start: Floats, goal: Goal) -> tuple[Motion, float]:
    began = thread_time()
    motion = planner.plan(start, goal)
    return motion, thread_time() - began


def table(rows: Sequence[Row]) -> Iterator[str]:
    """Yield Markdown: a line a family."""
    yield "| family | shapes, motions, covered, joined | way | solved | wrong | ms: median, p95, worst | without |"
    yield "|---|---:|---|---:|---:|---:|---:|"
    for row in rows:
        times, without = ("{:.1f}, {:.1f}, {:.0f}".format(*each) for each in (row.spent, row.without))
        yield (
            f"| {row.family} | {row.explored} | {'yes' if row.connected else 'no'} | {row.solved} of {row.plans} "
            f"| {row.wrong} | {times} | {row.solved_without}: {without} |"
        )


def run(
    piece: Pieces = None,
    seed: Annotated[int, typer.Option(help="Of the place of each family.")] = 0,
    count: Annotated[int, typer.Option(help="Targets in each place.")] = 50,
    rounds: Annotated[int, typer.Option(help="Of exploring each place.")] = 50,
    alone: Alone = False,
) -> None:
    """Print what exploring brings to plans, by family of places."""
    checks.integer("--seed", seed, 0, 2**31 - 1)
    checks.integer("--count", count, 2, 10_000)
    checks.integer("--rounds", rounds, 1, 100_000)
    work = partial(measured, seed=seed, count=count, rounds=rounds)
    rows = [row for row in of_families(work, piece, alone) if row is not None]
    tell(table(rows), any(row.wrong for row in rows))


main = command(run, "benchmarks.clutter.explored")


if __name__ == "__main__":
    sys.exit(main())
