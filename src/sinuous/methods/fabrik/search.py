"""One start of forward and backward reaching: FABRIKc and FABRIKx.

With one segment a section this is FABRIKc (Zhang et al. 2018); with segments that stretch, what others call exFABRIKc.
With several segments a section, bent in a fixed proportion, it is FABRIKx (Kolpashchikov, Gerget & Danilov 2022):
sections of variable curvature, approximated by arcs, whose two links differ. What was chosen where the papers could not
be had is said in `sinuous.methods.fabrik.links`.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem
from sinuous.kernels.solve.driver import Start, begin_from, driver
from sinuous.kernels.solve.judge import Answer, Check, check_size, offer, target_errors
from sinuous.kernels.tables import METHOD_OPTIONS, Budget
from sinuous.methods.fabrik import links
from sinuous.methods.fabrik.conversion import axis_of, end_goal, fold, unfold
from sinuous.methods.fabrik.links import Chain, carve_chain, group, reach_back, reach_out

PATIENCE = 25
"""Iterations in a row that gain less than a hundredth before a start is given up."""

Work = namedtuple("Work", ["chain", "q", "kept"])
"""Scratch of one solve: the links, the configuration (n, 3) that they stand for, and the best of one start."""


PER_SEGMENT, BESIDE = 6 + links.PER_SEGMENT, links.BESIDE
"""Numbers (float64) that the scratch takes from a buffer: for every segment, and beside."""


def workspace_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that a search needs as workspace."""
    return check_size(segments, obstacles) + PER_SEGMENT * segments + BESIDE


@kernel
def carve(buffer: Array, segments: int, sections: int) -> Work:
    """Lay out the scratch at the beginning of `buffer` (w,), for so many segments and sections."""
    n = segments
    return Work(
        carve_chain(buffer[6 * n :], n, sections),
        buffer[: 3 * n].reshape((n, 3)),
        buffer[3 * n : 6 * n].reshape((n, 3)),
    )


@kernel
def reach(problem: Problem, chain: Chain, frames: Array, q: Array) -> None:
    """One iteration: back from the target and out again to it; fills `q` (n, 3) and `frames` (n + 1, 12)."""
    goal, wanted, aimed = end_goal(problem, frames)
    rotation, base = frame(frames, chain.first[0])
    reach_back(chain, problem.limits, goal, wanted, aimed)
    reach_out(chain, problem.limits, base, axis_of(rotation), wanted, aimed)
    unfold(chain, frames, q)


@kernel
def descend(problem: Problem, check: Check, work: Work, most: int) -> int:
    """Reach back and out until the target is met, nothing is gained any more, or time is over.

    Begins at `work.chain`; fills `work.kept` with the best and returns the number of iterations.
    """
    least, slow = math.inf, 0
    copy(work.q, work.kept)
    for iteration in range(most):
        reach(problem, work.chain, check.frames, work.q)
        off, turn = target_errors(problem, check.frames)
        wrong = off / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
        if met or slow >= PATIENCE or spend(check.clock, SEGMENT_LOOKS * work.q.shape[0]):
            return iteration + 1
    return most


@kernel
def follow(
    problem: Problem, check: Check, work: Work, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.kernels.solve.driver`.

    `options` (4,): most iterations from one start, segments of a section, their taper, and whether lengths may change.
    """
    source = begin_from(problem, check, start, work.q)
    fold(problem.limits, work.chain, check.frames, options[3] != 0.0, work.q)
    used = descend(problem, check, work, int(options[0]))
    return used, offer(problem, check, work.kept, source, answer)


drive = driver(follow)


@entry
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
    """Solve m problems, laid out as `driver` says; `workspace` (w,) is scratch, see `workspace_size`."""
    n, options = int(robot[0]), settings[METHOD_OPTIONS:]
    pieces = int(options[1])
    work, rest = carve(workspace, n, (n + pieces - 1) // pieces), workspace[PER_SEGMENT * n + BESIDE :]
    group(work.chain, n, pieces, options[2])
    drive(work, (robot, scene, settings), targets, initial, budget, rest, answers)
