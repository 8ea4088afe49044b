"""`python -m benchmarks worlds`: very many small worlds, to find false claims that are rare."""

from collections import Counter
from collections.abc import Collection, Iterator
from functools import partial
from typing import Any

import numpy as np

from benchmarks.clutter.figures import COUNTED, LIMIT
from benchmarks.clutter.trials import Attempt, Task, Trial, examine
from benchmarks.harness import reference
from benchmarks.harness.experiment import Findings, Piece
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.solvers.parallel import Abreast

FAMILY = "small world"
COUNT, QUICK = 100_000, 200
TOGETHER = 100
"""Worlds of one piece: what an interrupt may cost a process."""

SECTION = "small worlds with doors, boxes only"
SHOWN = 40
"""Most seeds that a line lists."""


class Worlds(Abreast):
    """The experiment; see `Experiment`. `benchmarks.places.make("small world", number)` makes a world again.

    Parameters
    ----------
    plan : Plan
        World i has the number `COUNT * seed + i`.
    """

    name = "worlds"
    divisible = True
    protocol = f"world i is benchmarks.places.make({FAMILY!r}, {COUNT} * seed + i); {COUNTED}"

    def __init__(self, plan: Plan) -> None:
        self.plan = plan

    def settings(self) -> dict[str, Any]:
        """Return nothing: seed and size determine everything."""
        return {}

    def pieces(self) -> Iterator[Piece]:
        """Yield the worlds in their order, a hundred a piece."""
        begin = COUNT * self.plan.seed
        for first in range(begin, begin + self.plan.count(COUNT, QUICK), TOGETHER):
            yield f"worlds {first} to {first + TOGETHER - 1}", partial(measure, range(first, first + TOGETHER))

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterator[Piece]:
        """Nothing: no baseline is kept of it."""
        return iter(())

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Count what came of all worlds."""
        measured = [pieces[name] for name, _ in self.pieces() if name in pieces]
        if not measured:
            return Findings()
        seconds = np.concatenate([piece["seconds"] for piece in measured])
        solved = sum(piece["solved"] for piece in measured)
        statuses: Counter[str] = sum((Counter(piece["statuses"]) for piece in measured), Counter())
        note = ", ".join(f"{status} {count}" for status, count in statuses.most_common())
        share = 100.0 * solved / len(seconds)
        goal = Goal(99.0, at_most=False)
        lines = [
            Line(
                SECTION,
                "solved and proved within 1 s, and found right by the judges",
                share,
                "%",
                goal,
                Times.of(seconds),
                (solved, len(seconds)),
                f"{note}{_listed('not solved', measured, 'missed')}",
            )
        ]
        for key, what in (("lies", 'false "solved"'), ("excuses", 'false "impossible"')):
            count = sum(len(piece[key]) for piece in measured)
            listed = _listed("numbers", measured, key)
            lines.append(Line(SECTION, what, count, "", Goal(0, correctness=True), note=listed.lstrip("; ")))
        return Findings(lines, busy=max(piece["busy"] for piece in measured))


def measure(numbers: range) -> dict[str, Any]:
    """Try some worlds, and look how busy the machine is."""
    before = reference.look()
    found = summed([examine(Task(FAMILY, number)) for number in numbers])
    return {"busy": max(before.busy, reference.look().busy), **found}


def summed(trials: list[Trial]) -> dict[str, Any]:
    """Return what a journal keeps of some worlds: times, statuses, and the numbers of those to look at."""
    return {
        "seconds": [trial.ours.seconds for trial in trials],
        "solved": sum(_good(trial.ours) for trial in trials),
        "statuses": dict(Counter(trial.ours.status for trial in trials)),
        "missed": [[trial.seed, trial.ours.status] for trial in trials if not _good(trial.ours)],
        "lies": [[trial.seed, trial.ours.status] for trial in trials if trial.ours.claimed and not trial.ours.right],
        "excuses": [[trial.seed, trial.ours.status] for trial in trials if trial.ours.false and not trial.ours.claimed],
    }


def _good(attempt: Attempt) -> bool:
    return attempt.solved and attempt.seconds <= LIMIT


def _listed(what: str, measured: list[dict[str, Any]], key: str) -> str:
    """Numbers and statuses, to begin a search with; nothing when there are none."""
    found = [f"{number} ({status})" for piece in measured for number, status in piece[key]]
    return f"; {what}: {', '.join(found[:SHOWN])}{' ...' if len(found) > SHOWN else ''}" if found else ""
