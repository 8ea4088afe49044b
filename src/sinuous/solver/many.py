"""Many independent targets: chunks of them go to compiled code in all threads, what is left goes on one by one."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.solutions import Beyond, Solutions
from sinuous.answer.solve_again import SolveAgain
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.compile import cores
from sinuous.kernels.tables import CODE, RECORD_WIDTH, SOLVED, STARTS, TARGET_WIDTH, Budget, Outcome, answer_size
from sinuous.methods.method import Prepared, as_outcomes
from sinuous.model.joints import is_pair
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import on_rows
from sinuous.problem.target_sets import ManyProblems
from sinuous.solver.attempts import UNDECIDED
from sinuous.solver.strategy import Strategy
from sinuous.solver.thread_pool import share_jobs

LARGEST_CALL = 1024
"""Most problems that are handed over in one call."""

SMALLEST_FREE_CALL = 64
"""Fewest problems of one call without obstacles, if there are so many: a call costs as much as three such solves."""

SMALLEST_CALL_AMONG_OBSTACLES = 4
"""Fewest problems of one call among obstacles, if there are so many."""

CHUNKS_PER_WORKER = 4
"""Chunks a worker, where there are enough problems: some take a thousand times as long as others."""

MOST_WORKERS = 1024

GoOn = Callable[[Outcome, Problem, Floats], Outcome]
"""Goes on with a problem that its first call left undecided, from its initial configurations."""

Advance = Callable[[int], object]
"""Called with how many more targets are done, in any thread."""


class Many:
    """The answers to many questions while they are found.

    Parameters
    ----------
    questions : ManyProblems
    method : Prepared
    strategy : Strategy
    workers : int
        Most threads.
    starts : int
        Most starts of a question.
    advance : callable
    """

    def __init__(
        self, questions: ManyProblems, method: Prepared, strategy: Strategy, workers: int, starts: int, advance: Advance
    ) -> None:
        self._questions, self._method, self._strategy = questions, method, strategy
        self._workers, self._starts, self._advance = workers, starts, advance
        self._answers = np.empty((len(questions.target_sets), answer_size(len(questions.robot))))
        self._repeats = np.zeros(len(self._answers), np.bool_)  # answers that hardly differ from what is remembered
        self._beyond: dict[int, Beyond] = {}

    def begin(self, budget: Budget) -> None:
        """Make the first call for every question; before that, what it needs is compiled or loaded."""
        shape = self._questions.initial.shape[1:]
        nothing = np.empty((0, 1, TARGET_WIDTH)), np.empty((0, *shape)), budget, self._answers[:0]
        self._method.run_many(self._questions.scene, *nothing)

        def begin(chunk: tuple[int, int]) -> None:
            first, last = chunk
            rows = on_rows(self._questions.robot, self._questions.target_sets.chunk(first, last))
            initial = np.array(self._questions.initial[first:last], order="C")
            answers = self._answers[first:last]
            if initial.shape[1]:
                self._method.run_many(self._questions.scene, rows, initial, budget, answers, initial[:, 0])
            else:
                starts = self._strategy.remembered(rows)
                self._method.run_many(self._questions.scene, rows, starts, budget, answers)
                self._repeats[first:last] = self._strategy.recalled(starts, answers)
            self._advance(last - first - len(self._open(answers)))

        least = SMALLEST_CALL_AMONG_OBSTACLES if len(self._questions.scene) else SMALLEST_FREE_CALL
        most = min(LARGEST_CALL, len(self._answers) // (CHUNKS_PER_WORKER * self._workers))
        share_jobs(begin, _chunks(self._questions.target_sets.runs(), least, most), self._workers)

    def decide(self, code: int) -> None:
        """Give every question the same verdict."""
        self._answers[:, CODE] = code

    def go_on(self, go_on: GoOn) -> None:
        """Go on with what is undecided."""

        def one(i: int) -> None:
            outcome = as_outcomes(self._answers[i : i + 1])[0]
            initial = np.array(self._questions.initial[i], order="C")
            best = go_on(outcome, self._questions.problem(i), initial)
            best.write(self._answers[i])
            if best.route is not None or best.cell == best.cell:
                self._beyond[i] = Beyond(best.cell, best.route)
            self._advance(1)

        share_jobs(one, self._open(self._answers), self._workers, alone=0.0)

    def learn(self) -> None:
        """Keep what is solved for later questions, in the order of the targets, where there is a memory."""
        if not self._strategy.remembers:
            return
        new = self._answers[(self._answers[:, CODE] == SOLVED) & ~self._repeats, RECORD_WIDTH:]
        self._strategy.learn(new.reshape(-1, len(self._questions.robot), 3))

    def _open(self, answers: Floats) -> list[int]:
        """Which answers (m, 11 + 3 n) to the first call leave something to be tried, and starts to try it with."""
        undecided = np.logical_or.reduce([answers[:, CODE] == code for code in UNDECIDED])
        return np.flatnonzero(undecided & (answers[:, STARTS] < self._starts)).tolist()

    def solutions(self, resolver: SolveAgain) -> Solutions:
        """Return what was found."""
        return Solutions(self._questions, self._answers, resolver, self._beyond)


def _chunks(runs: list[tuple[int, int]], least: int, most: int) -> Iterator[tuple[int, int]]:
    """Cut runs into chunks, small ones first: what they take tells whether a second thread is worth while."""
    size = least
    for first, last in runs:
        at = first
        while at < last:
            end = min(last, at + size)
            yield at, end
            at, size = end, max(least, min(2 * size, most))


def read_initial(robot: Robot, count: int, initial: Any) -> Floats:
    """Check initial configurations for so many targets; returns them as (count, g, n, 3), where g is 0 or 1."""
    n = len(robot)
    if initial is None:
        return np.broadcast_to(np.empty((1, 0, n, 3)), (count, 0, n, 3))
    listed = is_pair(initial) or (isinstance(initial, list) and any(map(is_pair, initial)))
    given = _listed(robot, robot.configuration("initial", initial) if listed else initial)
    if given.ndim == 2:
        return np.broadcast_to(checks.array("initial", given, (n, 3)), (count, 1, n, 3))
    each = checks.rows("initial", given, n, 3)
    if len(each) != count:
        raise InputError("initial", "", len(each), f"{count} configurations, one for each target, or one for all")
    return each[:, None]


def _listed(robot: Robot, initial: Any) -> Any:
    """Initial configurations as an array, which is not checked yet."""
    if isinstance(initial, Solution | Solutions):
        return initial.configuration
    if isinstance(initial, np.ndarray):
        return initial
    if not np.iterable(initial):
        raise InputError("initial", "", initial, "configurations")
    listed = [each.configuration if isinstance(each, Solution) else each for each in initial]
    if listed and np.ndim(listed[0]) == 1:  # rows of one for all
        return checks.array("initial", listed, (len(robot), 3))
    return np.array(
        [checks.array(f"initial[{i}]", each, (len(robot), 3)) for i, each in enumerate(listed)], np.float64
    ).reshape(-1, len(robot), 3)


def read_workers(workers: Any) -> int:
    """Check a number of threads; by default one a core."""
    return cores() if workers is None else checks.integer("workers", workers, 1, MOST_WORKERS)
