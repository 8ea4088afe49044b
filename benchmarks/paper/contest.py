"""Methods that solve the same problems in turns, and what became of every answer once it was verified."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness.times import Times
from benchmarks.judges.collisions import Body
from benchmarks.judges.judge import judge
from benchmarks.paper.entrants import Entrant
from benchmarks.problems import ProblemSet
from sinuous.answer.solution import Solution
from sinuous.answer.verification import Verification, verify
from sinuous.base.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.solver.solver import Solver

BLOCK = 10
"""Problems that a method gets at a time: a minute in which the machine is slow is shared by all."""

WARM = 1
"""Solves before each block whose time does not count."""

STOLEN, TRIES = 1e-3, 3
"""Seconds without the processor from which on a solve is repeated, and how often it is tried: budgets are by the clock,
and a busy machine would let slow methods fail."""

Record = dict[str, Any]
"""Plain values of one solve, for the journal: see `Judge.record`."""


class Judge:
    """Verifies answers to one set of problems, by two codes that share nothing with the methods or with each other."""

    def __init__(self, problems: ProblemSet) -> None:
        self.problems = problems
        self._body = Body(problems.robot, problems.scene) if len(problems.scene) else None
        self._seen: dict[tuple[int, bytes], tuple[Verification, bool]] = {}

    def record(self, number: int, solution: Solution, seconds: float, *, keep: bool) -> Record:
        """Judge the answer to problem `number`.

        Of the record, `right` says that `verify()` and the judges of the bench both found the targets met, the limits
        kept and the body clear; `claimed` is what the method says. Errors, `excess` (beyond the limits) and
        `clearance` are those that `verify()` computed. `q` is there when it is to be kept.
        """
        key = number, solution.q.tobytes()
        if key not in self._seen:  # repeats give the same answers
            self._seen[key] = self._look(number, solution.q)
        found, confirmed = self._seen[key]
        record: Record = {
            "seconds": seconds,
            "claimed": solution.solved,
            "right": solution.solved and found.ok and confirmed,
            "status": str(solution.status),
            "position": found.position_error,
            "angle": found.angle_error,
            "excess": found.excess,
            "clearance": found.clearance,
            "iterations": solution.iterations,
            "starts": solution.starts,
            "start": solution.start,
        }
        if keep:
            record["q"] = solution.q.tolist()
        return record

    def _look(self, number: int, q: Floats) -> tuple[Verification, bool]:
        p = self.problems
        found = verify(Problem(p.robot, p.targets[number], p.scene, p.tolerance), q)
        return found, bool(judge(p.robot, [p.targets[number]], q[None], p.tolerance, self._body).right[0])


def solve_in_turns(
    entrants: Sequence[Entrant], problems: ProblemSet, *, seconds: float, seed: int, keep: bool = False
) -> dict[str, list[Record]]:
    """Let every method solve every problem from cold, a block at a time, each for at most `seconds`."""
    solvers = {entrant.label: entrant.solver(problems, seconds, seed) for entrant in entrants}
    judge_of = Judge(problems)
    records: dict[str, list[Record]] = {label: [] for label in solvers}
    for first in range(0, len(problems.targets), BLOCK):
        numbers = range(first, min(first + BLOCK, len(problems.targets)))
        for label, solver in solvers.items():
            timed = [_undisturbed(solver, problems.targets[i]) for i in [*[first] * WARM, *numbers]][WARM:]
            records[label] += [judge_of.record(i, *answer, keep=keep) for i, answer in zip(numbers, timed, strict=True)]
    return records


def _undisturbed(solver: Solver, target: Target, start: Solution | None = None) -> tuple[Solution, float]:
    """Solve, and take the time around the call; again where another process had the processor meanwhile."""
    for _ in range(TRIES):
        worked, began = thread_time(), perf_counter()
        solution = solver.solve(target, start)
        seconds = perf_counter() - began
        if seconds - (thread_time() - worked) < STOLEN:
            break
    return solution, seconds


class Followed(NamedTuple):
    """What a method found along a path, and the seconds that preparing it for the scene took, once compiled."""

    solutions: list[Solution]
    prepared: float


def follow_in_turns(
    entrants: Sequence[Entrant], problems: ProblemSet, *, seconds: float, seed: int
) -> dict[str, Followed]:
    """Let every method follow the targets as a path, each from the last solved, some waypoints at a time in turns."""
    found: dict[str, Followed] = {}
    tracks: dict[str, Iterator[Solution]] = {}
    for entrant in entrants:
        entrant.solver(problems, seconds, seed)
        began = perf_counter()
        solver = entrant.solver(problems, seconds, seed)
        found[entrant.label] = Followed([], perf_counter() - began)
        tracks[entrant.label] = _follow(solver, problems.targets)
    for _ in range(0, len(problems.targets), BLOCK):
        for label, track in tracks.items():
            found[label].solutions.extend(islice(track, BLOCK))
    return found


def _follow(solver: Solver, targets: Sequence[Target]) -> Iterator[Solution]:
    """Follow a path as `track` does, with an answer that does not count at the beginning of each block."""
    start: Solution | None = None
    for i, target in enumerate(targets):
        if i % BLOCK == 0:
            for _ in range(WARM):
                solver.solve(target, start)
        solution, _ = _undisturbed(solver, target, start)
        start = solution if solution.solved else start
        yield solution


def judge_track(judge_of: Judge, followed: Followed, *, keep: bool = False) -> list[Record]:
    """Judge what `follow_in_turns` found for one method.

    Of the records, `motion` is how far the point of the backbone that moved most is from where it was at the confirmed
    waypoint before; `prepared`, of the first, is what `Followed` says.
    """
    solutions = followed.solutions
    records = [judge_of.record(i, one, one.seconds, keep=keep) for i, one in enumerate(solutions)]
    for i, j in pairwise([i for i, record in enumerate(records) if record["right"]]):
        before, after = judge_of.problems.robot.backbone(np.stack([solutions[i].q, solutions[j].q]), 4)
        records[j]["motion"] = float(np.linalg.norm(after - before, axis=-1).max())
    records[0]["prepared"] = followed.prepared
    return records


@dataclass(frozen=True)
class Tally:
    """What became of many solves by one method.

    Attributes
    ----------
    runs, right, wrong : int
        Solves, those that verification confirmed, and those whose claim it rejected.
    times : Times
        Of the confirmed ones; all NaN without any.
    position, angle : float
        Median errors of the confirmed ones, length unit and rad.
    iterations : float
        Median of the confirmed ones.
    first : int
        How many of the confirmed ones came from the first start.
    """

    runs: int
    right: int
    wrong: int
    times: Times
    position: float
    angle: float
    iterations: float
    first: int

    @classmethod
    def of(cls, records: Sequence[Record]) -> "Tally":
        """Sum up records."""
        good = [record for record in records if record["right"]]
        return cls(
            runs=len(records),
            right=len(good),
            wrong=sum(record["claimed"] and not record["right"] for record in records),
            times=Times.of([r["seconds"] for r in good]) if good else Times(0, *[float("nan")] * 4),
            position=_median(good, "position"),
            angle=_median(good, "angle"),
            iterations=_median(good, "iterations"),
            first=sum(record["starts"] <= 1 for record in good),
        )

    @property
    def percent(self) -> float:
        """Share of confirmed ones."""
        return 100.0 * self.right / self.runs if self.runs else float("nan")


def _median(records: Sequence[Record], key: str) -> float:
    return float(np.median([record[key] for record in records])) if records else float("nan")


def all_records(pieces: Iterable[dict[str, list[Record]]]) -> dict[str, list[Record]]:
    """Put the records of several pieces together, method by method."""
    together: dict[str, list[Record]] = {}
    for piece in pieces:
        for label, records in piece.items():
            together.setdefault(label, []).extend(records)
    return together
