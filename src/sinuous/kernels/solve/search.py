"""One solve: starts one after the other until the first that is solved and proved, or the best of all."""

import math

import numpy as np

from sinuous.kernels.body.body import CLEAR, UNDECIDED
from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields import solids
from sinuous.kernels.maths.vectors import Array, Vec, copy, get_vec
from sinuous.kernels.solve.starts import face, scattered, single_arc
from sinuous.kernels.solve.verdicts import POSSIBLE, verdict_of
from sinuous.kernels.step.newton import MISSED, descend, linearise
from sinuous.kernels.step.states import ANGLE, MERIT, POSITION, SEEN, Problem, State, Work, carve, make_problem, pick
from sinuous.kernels.step.targets import HAS_POSITION, end_segment
from sinuous.kernels.step.targets import POSITION as PLACE

SOLVED, UNPROVED, FAILED, LATE = 0, 1, 2, 3
GIVEN, ARC, RANDOM = 0, 1, 2
OUTCOME = (
    "code",
    "iterations",
    "starts",
    "kind",
    "position_error",
    "angle_error",
    "clearance",
    "bound",
    "merit",
    "seconds",
)
"""What `search` says of a problem: status and kind of the best start, as the constants here; clearance is proved when
solved, else the least that was seen; `bound` says whether limits bound the best; `merit` is its squared residual."""

Numbers = tuple[int, int, int, int, float, float, float, bool, float, float]

DRAWS = 4
"""Random shapes that are looked at for one start."""


@kernel
def _goal(problem: Problem) -> tuple[int, Vec]:
    """Segment and position of the most distal target that has one (-1: none has)."""
    tip = -1
    goal = (0.0, 0.0, 0.0)
    for i in range(problem.targets.shape[0]):
        k = end_segment(problem.targets, i, problem.limits.shape[0])
        if problem.targets[i, HAS_POSITION] != 0.0 and k >= tip:
            tip, goal = k, get_vec(problem.targets, i, PLACE)
    return tip, goal


@kernel
def _start(
    problem: Problem, state: State, trial: State, work: Work, given: Array, index: int, seed: int, tip: int, goal: Vec
) -> int:
    """Put start number `index` into `state`; returns its kind.

    Of scattered shapes several are drawn, and the one that is closest to the targets is taken: a look costs less than
    a descent.
    """
    if index < given.shape[0]:
        copy(given[index], state.q)
        return GIVEN
    if index == given.shape[0] and tip >= 0:
        single_arc(problem.limits, state.frames, tip, goal, state.q)
        return ARC
    least = math.inf
    for draw in range(DRAWS):
        scattered(problem.limits, DRAWS * (index - given.shape[0]) + draw, seed, trial.q)
        if tip >= 0:
            face(trial.frames, problem.tool, tip, goal, trial.q)
        linearise(problem, trial, work, problem.coarse, solids.STEP, 0.0)
        if draw == 0 or trial.norms[MERIT] < least:
            least = trial.norms[MERIT]
            copy(trial.q, state.q)
    return RANDOM


@kernel
def _solve(
    problem: Problem,
    states: State,
    work: Work,
    given: Array,
    first: int,
    most: int,
    seed: int,
    iterations: int,
    seconds: float,
    best: Array,
) -> Numbers:
    """Solve one problem; fills `best` and returns what `OUTCOME` lists."""
    began = now(work.clock)
    deadline = began + seconds
    tip, goal = _goal(problem)
    impossible = verdict_of(problem)
    if impossible != POSSIBLE:
        most = min(most, first + given.shape[0] + 1)
    status, total, best_kind, least = FAILED, 0, GIVEN, math.inf
    off = turn = clearance = math.inf
    stopped = False
    at, index = int(np.int64(0)), first  # a mere 0 would have everything compiled once more, for it
    while index < most:
        kind = _start(problem, pick(states, at), pick(states, 1 - at), work, given, index, seed, tip, goal)
        index += 1
        at, verdict, used, seen, bound = descend(problem, states, at, work, iterations, deadline)
        total += used
        state = pick(states, at)
        if verdict == CLEAR or state.norms[MERIT] < least:
            copy(state.q, best)
            least, off, turn = state.norms[MERIT], state.norms[POSITION], state.norms[ANGLE]
            clearance = state.norms[SEEN] if verdict == MISSED else seen
            status, best_kind, stopped = FAILED, kind, bound
            if verdict == CLEAR:
                status = SOLVED
                break
            if verdict == UNDECIDED:
                status = UNPROVED
        if now(work.clock) > deadline:
            if status == FAILED:
                status = LATE
            break
    if impossible != POSSIBLE and status != SOLVED:
        status = impossible
    spent = now(work.clock) - began
    return status, total, index - first, best_kind, off, turn, clearance, stopped, least, spent


@entry
def search(
    limits: Array,
    actuation: Array,
    poses: Array,
    table: Array,
    store: Array,
    settings: Array,
    targets: Array,
    given: Array,
    first: int,
    most: int,
    seed: int,
    seconds: float,
    buffer: Array,
    best: Array,
) -> Numbers:
    """Solve for the targets (t, 15), from the starts `given` (g, n, 3), the single arc, then scattered shapes.

    `poses` (2, 12) are the base and the tool; `table` (m, 18) and `store` (s,) are the scene; `settings` is laid out as
    `states.SETTINGS` says; `buffer` is workspace. Starts are counted; this call tries number `first` up to, without it,
    `most`, for at most `seconds`. Fills `best` (n, 3) with the best configuration found and returns what `OUTCOME`
    lists.
    """
    problem = make_problem(limits, actuation, poses, table, store, settings, targets)
    states, work = carve(buffer, problem)
    return _solve(problem, states, work, given, first, most, seed, int(settings[7]), seconds, best)


@entry
def search_many(
    limits: Array,
    actuation: Array,
    poses: Array,
    table: Array,
    store: Array,
    settings: Array,
    targets: Array,
    given: Array,
    first: int,
    most: int,
    seed: int,
    seconds: float,
    buffer: Array,
    best: Array,
    outcomes: Array,
) -> None:
    """Solve m problems as `search` does one.

    `targets` (m, t, 15), `given` (m, g, n, 3); fills `best` (m, n, 3) and `outcomes` (m, 10).
    """
    states, work = carve(buffer, make_problem(limits, actuation, poses, table, store, settings, targets[0]))
    for i in range(targets.shape[0]):
        problem = make_problem(limits, actuation, poses, table, store, settings, targets[i])
        found = _solve(problem, states, work, given[i], first, most, seed, int(settings[7]), seconds, best[i])
        outcomes[i, 0], outcomes[i, 1], outcomes[i, 2], outcomes[i, 3], outcomes[i, 4] = found[:5]
        outcomes[i, 5], outcomes[i, 6], outcomes[i, 7], outcomes[i, 8], outcomes[i, 9] = found[5:]
