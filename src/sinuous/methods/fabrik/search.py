"""From a configuration to links and back, and one start of forward and backward reaching: FABRIKc and FABRIKx.

With one segment a section this is FABRIKc (Zhang et al. 2018); with segments that stretch, what others call exFABRIKc.
With several segments a section, bent in a fixed proportion, it is FABRIKx (Kolpashchikov, Gerget & Danilov 2022):
sections of variable curvature, approximated by arcs, whose two links differ. What was chosen where the papers could not
be had is said in `sinuous.methods.fabrik.links`.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain import arc
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.maths.vectors import (
    Array,
    Mat,
    Vec,
    add_scaled,
    copy,
    dot,
    get_vec,
    mat_mat,
    mat_vec,
    put_vec,
    sub,
    vec_mat,
)
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.judge import (
    Check,
    begin,
    begin_from,
    carve_check,
    check_size,
    end,
    offer,
    target_errors,
)
from sinuous.kernels.step.limits import retract
from sinuous.kernels.step.targets import direction_vector
from sinuous.kernels.tables import GOAL, MAX_LENGTH, METHOD_OPTIONS, MIN_LENGTH, ORIENTATION, TARGET_POSITION
from sinuous.methods.fabrik import links as fabrik
from sinuous.methods.fabrik.links import Chain, cap_of, carve_chain, group, links, reach_back, reach_out

PATIENCE = 25
"""Iterations in a row that gain less than a hundredth before a start is given up."""

Work = namedtuple("Work", ["chain", "q", "kept"])
"""Scratch of one solve: the links, the configuration (n, 3) that they stand for, and the best of one start."""


PER_SEGMENT, BESIDE = 6 + fabrik.PER_SEGMENT, fabrik.BESIDE
"""Numbers (float64) that the scratch takes from a buffer: for every segment, and beside."""


def workspace_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that a search needs as workspace."""
    return check_size(segments, obstacles) + PER_SEGMENT * segments + BESIDE


@kernel
def carve(buffer: Array, segments: int, sections: int) -> Work:
    """Lay out the scratch at the beginning of `buffer`."""
    n = segments
    return Work(
        carve_chain(buffer[6 * n :], n, sections),
        buffer[: 3 * n].reshape((n, 3)),
        buffer[3 * n : 6 * n].reshape((n, 3)),
    )


@kernel
def settle(limits: Array, chain: Chain, frames: Array, stretch: bool, q: Array) -> None:
    """Take over the configuration `q`, as far as sections can have it: fills the chain, `frames`, and `q` anew."""
    for i in range(chain.bends.shape[0]):
        begin, end = chain.first[i], chain.first[i + 1]
        bx = by = total = 0.0
        for k in range(begin, end):
            ux, uy, length = retract(limits, k, q[k, 0], q[k, 1], q[k, 2])
            bx, by, total = bx + ux, by + uy, total + length
            chain.part[k] = length
        low, high = 0.0, math.inf
        for k in range(begin, end):
            chain.part[k] = chain.part[k] / total if total > 0.0 and end - begin > 1 else 1.0 / (end - begin)
            if chain.part[k] > 0.0:
                low, high = (
                    max(low, limits[k, MIN_LENGTH] / chain.part[k]),
                    min(high, limits[k, MAX_LENGTH] / chain.part[k]),
                )
        chain.lengths[i] = total
        chain.low[i], chain.high[i] = (low, high) if stretch else (total, total)
        bend = math.hypot(bx, by)
        chain.bends[i] = min(bend, cap_of(chain, limits, i, total))
        _lay(chain, i, bx / bend if bend > 0.0 else 1.0, by / bend if bend > 0.0 else 0.0, frames, q)
        rotation, position = frame(frames, begin)
        near, _ = links(chain, i, chain.bends[i])
        put_vec(chain.joints, i, 0, add_scaled(position, near * total, axis_of(rotation)))
        put_vec(chain.points, i, 0, position)
        put_vec(chain.tangents, i, 0, axis_of(rotation))
    rotation, position = frame(frames, q.shape[0])
    put_vec(chain.points, chain.bends.shape[0], 0, position)
    put_vec(chain.tangents, chain.bends.shape[0], 0, axis_of(rotation))


@kernel
def axis_of(rotation: Mat) -> Vec:
    """The z axis of a frame: the tangent of the backbone."""
    return rotation[0][2], rotation[1][2], rotation[2][2]


@kernel
def _lay(chain: Chain, i: int, nx: float, ny: float, frames: Array, q: Array) -> None:
    """Write the segments of section i, bent towards (nx, ny), to `q` and `frames`."""
    rotation, position = frame(frames, chain.first[i])
    for k in range(chain.first[i], chain.first[i + 1]):
        bend, length = chain.share[k] * chain.bends[i], chain.part[k] * chain.lengths[i]
        turn, shift = arc.pose(nx * bend, ny * bend, length)
        rotation, position = compose(rotation, position, turn, shift)
        put_frame(frames, k + 1, rotation, position)
        put_vec(q, k, 0, (nx * bend, ny * bend, length))


@kernel
def unfold(chain: Chain, frames: Array, q: Array) -> None:
    """Write the configuration that the chain stands for to `q`, and its frames."""
    for i in range(chain.bends.shape[0]):
        local = vec_mat(get_vec(chain.tangents, i + 1, 0), frame(frames, chain.first[i])[0])
        side = math.hypot(local[0], local[1])
        nx, ny = (local[0] / side, local[1] / side) if side > 0.0 else (1.0, 0.0)
        _lay(chain, i, nx, ny, frames, q)


@kernel
def end_goal(problem: Problem, frames: Array) -> tuple[Vec, Vec, bool]:
    """Where the target wants the end of the backbone, its tangent there, and whether that is asked for.

    A tool is brought along with the end that the robot has now, turned by the least rotation that points the tool
    where it is wanted; without a tool this is the target itself.
    """
    goal = get_vec(problem.targets, 0, TARGET_POSITION)
    rotation, _ = frame(frames, frames.shape[0] - 1)
    aimed = problem.targets[0, ORIENTATION] != 0.0
    offset, shift = frame(problem.tool, 0)
    if aimed:
        wanted = get_vec(problem.targets, 0, GOAL)
        if offset[2][2] == 1.0 and shift[0] == 0.0 and shift[1] == 0.0:
            return add_scaled(goal, -shift[2], wanted), wanted, True
        turn = direction_vector(axis_of(mat_mat(rotation, offset)), wanted)
        rotation = mat_mat(rotation_of(turn), rotation)
    return sub(goal, mat_vec(rotation, shift)), axis_of(rotation), aimed


@kernel
def rotation_of(turn: Vec) -> Mat:
    """The rotation by a rotation vector (Rodrigues)."""
    square = dot(turn, turn)
    S, G, _, _ = arc.coefficients(square)
    cosine = 1.0 - G * square
    x, y, z = turn
    return (
        (cosine + G * x * x, G * x * y - S * z, G * x * z + S * y),
        (G * x * y + S * z, cosine + G * y * y, G * y * z - S * x),
        (G * x * z - S * y, G * y * z + S * x, cosine + G * z * z),
    )


@kernel
def reach(problem: Problem, chain: Chain, frames: Array, q: Array) -> None:
    """One iteration: back from the target and out again to it; fills `q` and `frames` of the chain's segments."""
    goal, wanted, aimed = end_goal(problem, frames)
    rotation, base = frame(frames, chain.first[0])
    reach_back(chain, problem.limits, goal, wanted, aimed)
    reach_out(chain, problem.limits, base, axis_of(rotation), wanted, aimed)
    unfold(chain, frames, q)


@kernel
def descend(problem: Problem, check: Check, work: Work, most: int, deadline: float) -> int:
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
        if met or slow >= PATIENCE or (iteration % 16 == 15 and now(check.clock) > deadline):
            return iteration + 1
    return most


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
    total, index, late = 0, 0, False
    while index < last and not late:
        kind = begin_from(problem, check, initial, index, first, seed, work.q)
        index += 1
        settle(problem.limits, work.chain, check.frames, options[3] != 0.0, work.q)
        total += descend(problem, check, work, int(options[0]), deadline)
        if offer(problem, check, work.kept, kind, best, record):
            break
        late = now(check.clock) > deadline
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

    `options`: most iterations from one start, segments of a section, their taper, and whether lengths may change.
    """
    n, options = int(robot[0]), settings[METHOD_OPTIONS:]
    first, most, seed, seconds = budget
    pieces = int(options[1])
    work = carve(workspace, n, (n + pieces - 1) // pieces)
    group(work.chain, n, pieces, options[2])
    for i in range(targets.shape[0]):
        problem = read_problem(robot, scene, settings, targets[i])
        best, record = answer_of(answers, i, n)
        check = carve_check(workspace[PER_SEGMENT * n + BESIDE :], problem)
        _solve(problem, check, work, initial[i], first, most, seed, seconds, options, best, record)
