"""The search of every method but our own: starts one after the other until one is solved, and the record of it.

A method brings its kernel `follow`, which follows one start; all else is the same for all. It is called as

    follow(problem, check, scratch, options, start, answer) -> iterations, solved

with `scratch` (w,), a buffer of as many numbers as the method asked for, and the `options` of the method. It hands its
answers to `judge.offer`, and returns `NO_START` iterations where the method has no start of this number.
"""

import math
from collections import namedtuple
from collections.abc import Callable

from sinuous.kernels import tables as t
from sinuous.kernels.clock import allow, begin, now, over
from sinuous.kernels.compile import entry_around, kernel
from sinuous.kernels.maths.vectors import Array, copy, put_vec
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.starts import face, most_distal, scattered, single_arc, widest
from sinuous.kernels.solve.verdicts import POSSIBLE, verdict_of
from sinuous.kernels.tables import Budget
from sinuous.methods.judge import Answer, Check, carve_check, finish

Start = namedtuple("Start", ["initial", "index", "first", "seed"])
"""One start of a search: the initial configurations (g, n, 3; rad and length unit); its place among all starts, of
which these are the first; the number of the method's own start that comes after them; and the seed of those that are
random."""

NO_START = -1
"""Iterations of a start that does not exist: the search ends."""

Follow = Callable[[Problem, Check, Array, Array, Start, Answer], tuple[int, bool]]

Search = Callable[[Array, Array, Array, Array, Array, Budget, Array, Array], None]


@kernel
def own_number(start: Start) -> int:
    """Number of a start among the method's own; -1 for an initial configuration."""
    given = start.initial.shape[0]
    return start.first + start.index - given if start.index >= given else -1


@kernel
def begin_from(problem: Problem, check: Check, start: Start, q: Array) -> int:
    """Put a start into `q` (n, 3): an initial configuration, or one of `begin_own`; returns its source."""
    number = own_number(start)
    if number < 0:
        copy(start.initial[start.index], q)
        return t.GIVEN
    return begin_own(problem, check, number, start.seed, q)


@kernel
def begin_own(problem: Problem, check: Check, number: int, seed: int, q: Array) -> int:
    """Put own start `number` into `q` (n, 3): 0 is the single arc, all others are scattered; returns its source."""
    tip, goal = most_distal(problem)
    if number == 0 and tip >= 0:
        single_arc(problem.limits, check.frames, tip, goal, q)
        return t.ARC
    scattered(problem.limits, number, seed, widest(number), q)
    face(problem.targets, check.frames, problem.tool, q)
    return t.RANDOM


@kernel
def open_record(problem: Problem, check: Check, given: int, budget: Budget, answer: Answer) -> int:
    """Open the record and the time of a search; returns the number of its starts.

    They are `given` initial configurations and the method's own of the `budget`. What is proved impossible is tried
    from the initial configurations and once more.
    """
    first, last, _, seconds = budget
    record = answer.record
    began = allow(check.clock, seconds)
    impossible = verdict_of(problem)
    for j in range(record.shape[0]):
        record[j] = 0.0
    record[t.CODE] = t.FAILED if impossible == POSSIBLE else impossible
    record[t.POSITION_ERROR] = record[t.ANGLE_ERROR] = record[t.MERIT] = math.inf
    record[t.CLEARANCE] = record[t.SELF_CLEARANCE] = math.inf
    record[t.SECONDS] = began
    for k in range(answer.best.shape[0]):
        put_vec(
            answer.best, k, 0, (0.0, 0.0, 0.5 * (problem.limits[k, t.MIN_LENGTH] + problem.limits[k, t.MAX_LENGTH]))
        )
    own = last - first if impossible == POSSIBLE else min(last - first, 1)
    return given + own


@kernel
def close_record(problem: Problem, check: Check, iterations: int, starts: int, late: bool, answer: Answer) -> None:
    """Close the record of a search; where nothing could be kept, the best is the straight robot, and FAILED."""
    record = answer.record
    if record[t.MERIT] == math.inf:
        _, off, turn, clearance, self_clearance, _, merit = finish(problem, check, answer.best)
        record[t.POSITION_ERROR], record[t.ANGLE_ERROR], record[t.MERIT] = off, turn, merit
        record[t.CLEARANCE], record[t.SELF_CLEARANCE] = clearance, self_clearance
    if late and record[t.CODE] == t.FAILED:
        record[t.CODE] = t.LATE
    record[t.ITERATIONS], record[t.STARTS] = iterations, starts
    record[t.SECONDS] = now(check.clock) - record[t.SECONDS]


def search_by(follow: Follow) -> Search:
    """Make the search of the method that `follow` belongs to, to be called from Python.

    It is made around `follow`, because code that is handed over as an argument cannot be kept on disk.
    """

    def search(
        robot: Array,
        scene: Array,
        settings: Array,
        targets: Array,
        initial: Array,
        budget: Budget,
        workspace: Array,
        answers: Array,
    ) -> None:
        """Solve m problems, each from its starts until one is solved, there are no more, or time is over.

        `robot`, `scene` and `settings` are groups, laid out as `tables` says; `targets` (m, t, 15); `initial`
        (m, g, n, 3). `workspace` is scratch of the check (`judge.check_size`), then of the method. Fills `answers`
        (m, 11 + 3 n): record and configuration of each.
        """
        n, options = int(robot[0]), settings[t.METHOD_OPTIONS :]
        for i in range(targets.shape[0]):
            problem = read_problem(robot, scene, settings, targets[i])
            check, scratch = carve_check(workspace, problem)
            if i == 0:
                begin(check.clock)
            best, record = answer_of(answers, i, n)
            answer = Answer(best, record)
            count = open_record(problem, check, initial.shape[1], budget, answer)
            total, index, late, solved = 0, 0, False, False
            while index < count and not late and not solved:
                start = Start(initial[i], index, budget[0], budget[2])
                used, solved = follow(problem, check, scratch, options, start, answer)
                if used < 0:
                    break
                total += used
                index += 1
                late = not solved and over(check.clock)
            close_record(problem, check, total, index, late, answer)

    return entry_around(follow, search)
