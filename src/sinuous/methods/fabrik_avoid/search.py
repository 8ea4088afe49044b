"""Forward and backward reaching that steps aside: joints are pushed away from what the body runs into (Wu et al. 2022).

One iteration is FABRIKc's. Then every segment is looked at in some places; where one is inside an obstacle, the joints
that shape it (its key points) are moved away from the obstacle, along the gradient of the distance, before the next
iteration reaches for the target again. Nothing is done while nothing overlaps. The paper could not be had; chosen here
are the places, that the deepest of a segment counts, that its own joint moves by all of a push and the joint before by
half, and that the push aims a little beyond contact, farther whenever the proof of the whole body finds an overlap
that the places had missed.
"""

import math

from sinuous.kernels.body.glance import deepest
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import obstacle
from sinuous.kernels.maths.vectors import Array, add_scaled, copy, get_vec, put_vec
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.judge import (
    Check,
    begin,
    begin_from,
    carve_check,
    end,
    has_obstacles,
    offer,
    target_errors,
)
from sinuous.kernels.tables import METHOD_OPTIONS
from sinuous.methods.fabrik.links import Chain, group
from sinuous.methods.fabrik.search import BESIDE, PER_SEGMENT, Work, carve, reach, settle

PATIENCE = 40
"""Iterations in a row that gain less than a hundredth before a start is given up."""


@kernel
def push_away(
    problem: Problem, chain: Chain, frames: Array, q: Array, looks: int, strength: float, margin: float
) -> float:
    """Move the joints of segments that overlap; returns the deepest overlap that was seen."""
    if not has_obstacles(problem):
        return 0.0
    overlap = travel = 0.0
    for k in range(q.shape[0]):
        rotation, position = frame(frames, k)
        clearance, which, place = deepest(problem, rotation, position, get_vec(q, k, 0), k, travel, looks)
        travel += q[k, 2]
        overlap = max(overlap, -clearance)
        if clearance < 0.0:
            _, away = obstacle(problem.scene, which, place)
            way = strength * (margin - clearance)
            put_vec(chain.joints, k, 0, add_scaled(get_vec(chain.joints, k, 0), way, away))
            if k > 0:
                put_vec(chain.joints, k - 1, 0, add_scaled(get_vec(chain.joints, k - 1, 0), 0.5 * way, away))
    return overlap


@kernel
def descend(
    problem: Problem,
    check: Check,
    work: Work,
    options: Array,
    deadline: float,
    kind: int,
    best: Array,
    record: Array,
) -> tuple[int, bool]:
    """Reach and step aside until an answer is solved, nothing is gained any more, or time is over.

    Begins at `work.chain`; offers what meets the target, and the best of all at the end. Returns the number of
    iterations, and whether an answer is solved.
    """
    most, looks, strength, margin = int(options[0]), int(options[1]), options[2], options[3] * problem.unit
    least, slow = math.inf, 0
    copy(work.q, work.kept)
    for iteration in range(most):
        reach(problem, work.chain, check.frames, work.q)
        off, turn = target_errors(problem, check.frames)
        overlap = push_away(problem, work.chain, check.frames, work.q, looks, strength, margin)
        wrong = (off + overlap) / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        if off <= problem.position_tolerance and turn <= problem.angle_tolerance and overlap == 0.0:
            if offer(problem, check, work.q, kind, best, record):
                return iteration + 1, True
            margin *= 2.0
        if slow >= PATIENCE or (iteration % 16 == 15 and now(check.clock) > deadline):
            return iteration + 1, offer(problem, check, work.kept, kind, best, record)
    return most, offer(problem, check, work.kept, kind, best, record)


@kernel
def _solve(
    problem: Problem,
    check: Check,
    work: Work,
    initial: Array,
    first: int,
    most: int,
    seed: int,
    seconds: float,
    options: Array,
    best: Array,
    record: Array,
) -> None:
    deadline, last = begin(problem, check, initial, first, most, seconds, best, record)
    total, index, late, done = 0, 0, False, False
    while index < last and not late and not done:
        kind = begin_from(problem, check, initial, index, first, seed, work.q)
        index += 1
        settle(problem.limits, work.chain, check.frames, options[4] != 0.0, work.q)
        used, done = descend(problem, check, work, options, deadline, kind, best, record)
        total += used
        late = not done and now(check.clock) > deadline
    end(problem, check, total, index, late, best, record)


@entry
def search(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: tuple[int, int, int, float],
    workspace: Array,
    answers: Array,
) -> None:
    """Solve m problems; see `sinuous.methods.compiled`.

    `options`: most iterations from one start, places of a segment that are looked at, how far a push goes as a share
    of what is missing, clearance that it aims for in robot lengths, and whether lengths may change.
    """
    n, options = int(robot[0]), settings[METHOD_OPTIONS:]
    first, most, seed, seconds = budget
    work = carve(workspace, n, n)
    group(work.chain, n, 1, 0.0)
    for i in range(targets.shape[0]):
        problem = read_problem(robot, scene, settings, targets[i])
        best, record = answer_of(answers, i, n)
        check = carve_check(workspace[PER_SEGMENT * n + BESIDE :], problem)
        _solve(problem, check, work, initial[i], first, most, seed, seconds, options, best, record)
