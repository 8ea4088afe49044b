"""One solve: starts one after the other until the first that is solved and proved, or the best of all."""

import math

from sinuous.kernels.body import CLEAR, PER_SEGMENT, UNDECIDED
from sinuous.kernels.clock import now
from sinuous.kernels.compile import kernel
from sinuous.kernels.newton import (
    ANGLE,
    MERIT,
    POSITION,
    SEEN,
    MISSED,
    Problem,
    Work,
    carve_state,
    carve_work,
    descend,
    linearise,
    met,
    proof,
    state_size,
)
from sinuous.kernels.preferences import Wishes, improve
from sinuous.kernels.starts import face, scattered, single_arc
from sinuous.kernels.targets import HAS_POSITION, end_segment
from sinuous.kernels.targets import POSITION as PLACE
from sinuous.kernels.vectors import Array, Vec, copy, get_vec
from sinuous.kernels.verdicts import POSSIBLE, verdict_of

SOLVED, UNPROVED, FAILED, LATE = 0, 1, 2, 3
GIVEN, ARC, RANDOM = 0, 1, 2
SETTINGS = (
    "mount",
    "unit",
    "margin",
    "position_tolerance",
    "angle_tolerance",
    "coarse",
    "depth",
    "iterations",
    "start",
    "bends",
    "clearance",
)
"""What `search` is set to, in this order: see `newton.Problem`, most iterations from one start, and the preferences."""

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
    problem: Problem, memory: Array, work: Work, given: Array, index: int, seed: int, tip: int, goal: Vec
) -> int:
    """Put start number `index` into the state at 0; returns its kind.

    Of scattered shapes several are drawn, and the one that is closest to the targets is taken: a look costs less than a descent.
    """
    state, trial = carve_state(memory, problem), carve_state(memory[state_size(problem) :], problem)
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
        linearise(problem, trial, work, problem.coarse, 0.0)
        if draw == 0 or trial.norms[MERIT] < least:
            least = trial.norms[MERIT]
            copy(trial.q, state.q)
    return RANDOM


@kernel
def _prefer(
    problem: Problem,
    memory: Array,
    work: Work,
    wishes: tuple[float, float, float],
    reference: Array,
    best: Array,
    proved: tuple[float, float, float],
    iterations: int,
    deadline: float,
) -> tuple[int, float, float, float]:
    """Improve the solved `best` and prove it again; what cannot be proved is not taken.

    `proved` are position error, angle error and proved clearance of `best`; returns iterations, and the same of what is in `best`
    then.
    """
    copy(best, work.solved)
    copy(reference, work.reference)
    wanted = Wishes(wishes[0], wishes[1], wishes[2], work.reference)
    used = improve(problem, memory, work, wanted, best, iterations, deadline)
    state = carve_state(memory, problem)
    copy(best, state.q)
    linearise(problem, state, work, problem.depth, 0.0)
    verdict, clearance = proof(problem, state, work)
    if verdict == CLEAR and met(problem, state):
        return used, state.norms[POSITION], state.norms[ANGLE], clearance
    copy(work.solved, best)
    return used, proved[0], proved[1], proved[2]


def workspace_size(segments: int, actuators: int, obstacles: int, targets: int) -> int:
    """Numbers (float64) that a search needs as workspace: more than enough, whatever the layout of its parts."""
    capacity = 6 * targets + (segments * PER_SEGMENT if obstacles > 0 else 0) + actuators
    return 3 * (34 * segments + 18 + 27 * capacity) + 22 * segments + obstacles + 2


@kernel
def search(
    limits: Array,
    actuation: Array,
    poses: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    given: Array,
    first: int,
    most: int,
    seed: int,
    seconds: float,
    buffer: Array,
    best: Array,
) -> tuple[int, int, int, int, float, float, float, bool, float]:
    """Fill `best` (n, 3) with the best configuration found.

    `poses` (2, 12) are the base and the tool; `settings` is laid out as `SETTINGS` says; `buffer` is workspace. Starts are
    counted: those of `given` (g, n, 3), the single arc, then scattered shapes; this call tries number `first`
    up to, without it, `most`. Returns status, iterations, starts, kind of the best start, position error, angle
    error, clearance (proved, when solved; else the least seen), whether limits bound the best, and its merit.
    """
    problem = Problem(
        limits,
        actuation,
        poses[0:1],
        poses[1:2],
        scene,
        targets,
        settings[0],
        settings[1],
        settings[2],
        settings[3],
        settings[4],
        int(settings[5]),
        int(settings[6]),
    )
    iterations = int(settings[7])
    wishes = (settings[8], settings[9], settings[10])
    size = state_size(problem)
    memory, work = buffer[: 3 * size], carve_work(buffer[3 * size :], problem)
    wanted = wishes[0] > 0.0 or wishes[1] > 0.0 or wishes[2] > 0.0
    deadline = now(work.clock) + seconds
    tip, goal = _goal(problem)
    impossible = verdict_of(problem)
    if impossible != POSSIBLE:
        most = min(most, first + given.shape[0] + 1)
    status, total, best_kind, least = FAILED, 0, GIVEN, math.inf
    off = turn = clearance = math.inf
    stopped = False
    index = first
    while index < most:
        kind = _start(problem, memory, work, given, index, seed, tip, goal)
        index += 1
        at, verdict, used, seen, bound = descend(problem, memory, 0, work, iterations, deadline)
        total += used
        state = carve_state(memory[at:], problem)
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
    if status == SOLVED and wanted:
        reference = given[0] if given.shape[0] > 0 else best
        used, off, turn, clearance = _prefer(
            problem, memory, work, wishes, reference, best, (off, turn, clearance), iterations, deadline
        )
        total += used
    if impossible != POSSIBLE:
        status = impossible
    return status, total, index - first, best_kind, off, turn, clearance, stopped, least
