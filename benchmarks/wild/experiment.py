"""`python -m benchmarks wild`: anything that can be built, with a hidden solution each, and every claim judged."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from benchmarks.harness.experiment import Divided, Experiment, Plan
from benchmarks.wild import calls, motions, trials, worlds

SECTION = "wild problems, each with a hidden solution that is clear of obstacles and of itself; budget 1 s"
AUDIT = (
    "what an audit of the proofs strained, each problem with a hidden solution; budget 1 s, of bounds and huge 0.05 s, "
    "under load 0.2 s, with joints 0.3 s"
)

CALLS = "public calls of odd robots"
SECTIONS = (
    "motions of wild worlds: what is called proved, looked at by the judges",
    "public calls of odd robots in odd scenes: whether each ends in an answer",
)

BLOCK, BLOCKS, AUDITED = 22, 100, 10
"""Worlds of one share, about a thousand problems; shares of one round, 100,000 problems; those of one audited kind."""

MADE, MADES = 100, 5
"""Motions, or calls, of one share; shares of one kind of these, in one round."""

MOST = 30
"""Of 100,000 problems, how many may be not solved within the budget."""


def wild(plan: Plan) -> Experiment:
    """First what is short: what an audit asked for, motions and calls; then wild worlds.

    Every round has fresh problems, and all of them are counted together.
    """
    seed, count, rounds = plan.seed, plan.count, plan.rounds
    parts: dict[str, Divided] = {}

    def shares(work: Callable[[range], Any], size: int, many: int) -> list[Callable[[], Any]]:
        return [partial(work, range(i * size, (i + 1) * size)) for i in range(many)]

    for kind, make in worlds.AUDITED.items():
        work, summed = partial(trials.tallied, partial(make, seed)), partial(trials.lines_of, AUDIT, kind, math.inf)
        parts[kind] = Divided(shares(work, count(BLOCK, 10), count(AUDITED, 1) * rounds), summed)
    for kind, judge in (motions.KINDS | {CALLS: calls.called}).items():
        words = ("answered", "exceptions") if kind == CALLS else ("proved", "false claims")
        summed = partial(trials.lines_of_judged, SECTIONS[kind == CALLS], kind, *words)
        parts[kind] = Divided(shares(partial(made, judge, seed), count(MADE, 2), count(MADES, 1) * rounds), summed)
    work, summed = partial(trials.tallied, partial(worlds.make, seed)), partial(trials.lines_of, SECTION, "wild", MOST)
    parts["wild"] = Divided(shares(work, count(BLOCK, 10), count(BLOCKS, 1) * rounds), summed)
    return Experiment("wild", plan, parts)


def made(judge: Callable[[int, int], trials.Judged], seed: int, numbers: range) -> list[trials.Judged]:
    """Make and judge motions, or calls."""
    return [judge(seed, number) for number in numbers]
