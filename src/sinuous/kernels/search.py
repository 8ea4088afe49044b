"""One solve: starts one after the other until the first that is solved and proved, or the best of all."""

import math

from sinuous.kernels.body import CLEAR, PER_SEGMENT, UNDECIDED
from sinuous.kernels.clock import now
from sinuous.kernels.compile import kernel
from sinuous.kernels.newton import ANGLE, MERIT, POSITION, SEEN, Problem, carve_state, carve_work, descend, linearise, state_size
from sinuous.kernels.starts import face, low_discrepancy, single_arc
from sinuous.kernels.targets import HAS_POSITION, end_segment
from sinuous.kernels.targets import POSITION as PLACE
from sinuous.kernels.vectors import Array, Vec, copy, get_vec
from sinuous.kernels.verdicts import POSSIBLE, verdict_of

SOLVED, UNPROVED, FAILED, LATE = 0, 1, 2, 3
GIVEN, ARC, RANDOM = 0, 1, 2
DRAWS = 4


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


def workspace_size(segments: int, actuators: int, obstacles: int, targets: int) -> int:
    """Numbers (float64) that a search needs as workspace: more than enough, whatever the layout of its parts."""
    capacity = 6 * targets + (segments * PER_SEGMENT if obstacles > 0 else 0) + actuators
    return 2 * (34 * segments + 17 + 27 * capacity) + 16 * segments + obstacles + 2


@kernel
def search(
    limits: Array,
    actuation: Array,
    base: Array,
    tool: Array,
    scene: Array,
    targets: Array,
    mount: float,
    unit: float,
    margin: float,
    position_tolerance: float,
    angle_tolerance: float,
    given: Array,
    first: int,
    most: int,
    seed: int,
    iterations: int,
    seconds: float,
    buffer: Array,
    best: Array,
) -> tuple[int, int, int, int, float, float, float, bool, float]:
    """Fill `best` (n, 3) with the best configuration found.

    Starts are counted: those of `given` (g, n, 3), the single arc, then the low-discrepancy sequence; this call tries number
    `first` up to, without it, `most`. Returns status, iterations, starts, kind of the best start, position error, angle
    error, clearance (proved, when solved; else the least seen), whether limits bound the best, and its merit.
    """
    problem = Problem(limits, actuation, base, tool, scene, targets, mount, unit, margin, position_tolerance, angle_tolerance)
    size = state_size(problem)
    state, trial = carve_state(buffer, problem), carve_state(buffer[size:], problem)
    work = carve_work(buffer[2 * size :], problem)
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
        kind = GIVEN if index < given.shape[0] else (ARC if index == given.shape[0] else RANDOM)
        if kind == GIVEN:
            copy(given[index], state.q)
        elif kind == ARC and tip >= 0:
            single_arc(limits, state.frames, tip, goal, state.q)
        else:
            least_merit = math.inf
            for c in range(DRAWS):
                low_discrepancy(limits, DRAWS * (index - given.shape[0]) + c, seed, trial.q)
                if tip >= 0:
                    face(trial.frames, tool, tip, goal, trial.q)
                linearise(problem, trial, work, 0)
                if trial.norms[MERIT] < least_merit:
                    least_merit = trial.norms[MERIT]
                    copy(trial.q, state.q)
        index += 1
        state, trial, verdict, used, proved, bound = descend(problem, state, trial, work, iterations, deadline)
        total += used
        if verdict == CLEAR or state.norms[MERIT] < least:
            copy(state.q, best)
            least, off, turn = state.norms[MERIT], state.norms[POSITION], state.norms[ANGLE]
            status, clearance, best_kind, stopped = FAILED, state.norms[SEEN], kind, bound
            if verdict == CLEAR:
                status, clearance = SOLVED, proved
                break
            if verdict == UNDECIDED:
                status = UNPROVED
        if now(work.clock) > deadline:
            if status == FAILED:
                status = LATE
            break
    if impossible != POSSIBLE:
        status = impossible
    return status, total, index - first, best_kind, off, turn, clearance, stopped, least
