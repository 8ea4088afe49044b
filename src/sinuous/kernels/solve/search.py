"""One solve: starts one after the other until the first that is solved and proved, or the best of all.

`initial` (g, n, 3) are configurations that are given, `best` (n, 3) is the best so far.
"""

import math

import numpy as np

from sinuous.kernels import tables as t
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.kernels.clock import allow, begin, late, now, over
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.fields import solids
from sinuous.kernels.maths.vectors import Array, Vec, copy
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.clearance import increase_clearance
from sinuous.kernels.solve.starts import find_most_distal, put_single_arc, turn_to_targets, widest_bend
from sinuous.kernels.solve.verdicts import POSSIBLE, verdict_of
from sinuous.kernels.step.newton import descend, linearise
from sinuous.kernels.step.scattered import scattered
from sinuous.kernels.step.states import ANGLE, MERIT, POSITION, State, Work, carve, pick
from sinuous.kernels.tables import Budget

Numbers = tuple[int, int, int, int, float, float, float, float, bool, float, float]
"""The record of one search, see `sinuous.kernels.tables`."""

BRIEF = 5
"""Steps of Newton's method that meet targets nearby, where nothing is in the way."""

DRAWS = 4
"""Random shapes that are examined for one start."""


def _put_start(
    problem: Problem, state: State, trial: State, work: Work, number: int, seed: int, tip: int, goal: Vec
) -> int:
    """Put the method's own start `number` into `state`; returns its source.

    Number 0 is the single arc. All others are scattered shapes: several are drawn, and the one that is closest to the
    targets is taken, because an evaluation costs less than a descent.
    """
    if number == 0 and tip >= 0:
        put_single_arc(problem.limits, state.frames, tip, goal, state.q)
        return t.ARC
    least = math.inf
    for draw in range(DRAWS):
        scattered(problem.limits, DRAWS * number + draw, seed, widest_bend(number), trial.q)
        turn_to_targets(problem.limits, problem.targets, trial.frames, problem.tool, trial.q)
        linearise(problem, trial, work, problem.coarse_depth, solids.INTERPOLATED, 0.0, False)
        if late(work.clock) and draw > 0:
            break
        if draw == 0 or trial.norms[MERIT] < least:
            least = trial.norms[MERIT]
            copy(trial.q, state.q)
    return t.RANDOM


def _solve(
    problem: Problem,
    states: State,
    work: Work,
    initial: Array,
    budget: Budget,
    iterations: int,
    wish: float,
    margin: float,
    best: Array,
) -> Numbers:
    """Solve one problem; fills `best` (n, 3) and returns the record.

    From configurations that are given the way leads past obstacles with the clearance `wish`, where that is possible.
    What is solved in contact is led away from it up to the clearance `margin`. Where several are given, each is
    followed briefly first: one mostly leads past everything in a few steps, and a descent in contact takes a hundred
    times as long.
    What is impossible is asked after the first start: most problems are solved by then.
    """
    first, last, seed, seconds = budget
    began = allow(work.clock, seconds)
    tip, goal = find_most_distal(problem)
    g = initial.shape[0]
    count = g + last - first
    impossible = POSSIBLE
    status, total, source, least = t.FAILED, 0, t.GIVEN, math.inf
    off = turn = clearance = self_clearance = math.inf
    stopped = False
    at, index, brief = int(np.int64(0)), 0, g > 1  # a mere 0 would have everything compiled once more, for it
    while index < count:
        kind = t.GIVEN
        if index < g:
            copy(initial[index], pick(states, at).q)
        else:
            kind = _put_start(problem, pick(states, at), pick(states, 1 - at), work, first + index - g, seed, tip, goal)
        index += 1
        at, verdict, used, seen, self_seen, bound = descend(
            problem, states, at, work, BRIEF if brief else iterations, wish if index <= g else 0.0, brief
        )
        total += used
        state = pick(states, at)
        if verdict == CLEAR or (state.norms[MERIT] < least and not brief) or index == 1:
            copy(state.q, best)
            least, off, turn = state.norms[MERIT], state.norms[POSITION], state.norms[ANGLE]
            clearance, self_clearance = seen, self_seen
            status, source, stopped = t.UNPROVED if verdict == UNDECIDED else t.FAILED, kind, bound
            if verdict == CLEAR:
                status = t.SOLVED
                break
        if index == 1 and not brief:
            impossible = verdict_of(problem)
            if impossible != POSSIBLE:
                count = min(count, g + 1)
        if over(work.clock):
            if status == t.FAILED:
                status = t.LATE
            break
        if brief and index == g:
            brief, index = False, 0
    if index == 0:
        impossible = verdict_of(problem)
    known = (off, turn, clearance, self_clearance, least)
    wanted = margin if status == t.SOLVED else 0.0
    used, (off, turn, clearance, self_clearance, least) = increase_clearance(problem, states, work, wanted, known, best)
    total += used
    if impossible != POSSIBLE and status != t.SOLVED:
        status = impossible
    spent = now(work.clock) - began
    return status, total, index, source, off, turn, clearance, self_clearance, stopped, least, spent


@shared
def _read_and_solve(
    robot: Array,
    scene: Array | None,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: Budget,
    workspace: Array,
    best: Array,
    begins: bool,
) -> Numbers:
    """Solve one problem; arguments as for `search`, and whether a call from Python begins with it."""
    problem = read_problem(robot, scene, settings, targets)
    states, work = carve(workspace, problem)
    if begins:
        begin(work.clock)
    iterations, wish, margin = (
        int(settings[t.MAX_ITERATIONS]),
        settings[t.WISHED_CLEARANCE],
        settings[t.CLEARANCE_MARGIN],
    )
    return _solve(problem, states, work, initial, budget, iterations, wish, margin, best)


@entry
def search(
    robot: Array,
    scene: Array | None,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: Budget,
    workspace: Array,
    best: Array,
) -> Numbers:
    """Solve from the configurations `initial` (g, n, 3), the single arc, then scattered shapes; targets (t, 15).

    `robot`, `scene` and `settings` are groups, laid out as `sinuous.kernels.tables` says; `scene` is `None` without
    obstacles. `budget` holds the numbers of
    the own starts to try, from the first up to, without it, the last; a seed; and seconds. `workspace` (w,) is scratch,
    see `states.workspace_size`. Fills `best` (n, 3) with the best configuration found and returns its record.
    """
    return _read_and_solve(robot, scene, settings, targets, initial, budget, workspace, best, True)


@entry
def search_many(
    robot: Array,
    scene: Array | None,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: Budget,
    workspace: Array,
    answers: Array,
) -> None:
    """Solve m problems as `search` does one.

    `targets` (m, t, 15), `initial` (m, g, n, 3); fills `answers` (m, 11 + 3 n): record and configuration of each.
    """
    for i in range(targets.shape[0]):
        best, record = answer_of(answers, i, initial.shape[2])
        found = _read_and_solve(robot, scene, settings, targets[i], initial[i], budget, workspace, best, i == 0)
        record[t.CODE], record[t.ITERATIONS], record[t.STARTS], record[t.SOURCE], record[t.POSITION_ERROR] = found[:5]
        record[t.ANGLE_ERROR], record[t.CLEARANCE], record[t.SELF_CLEARANCE], record[t.BOUND] = found[5:9]
        record[t.MERIT], record[t.SECONDS] = found[9:]
