"""Damped least squares on the geometric Jacobian of the tip.

Wampler 1986, Nakamura & Hanafusa 1986: with the error e of the tip (position in robot lengths, rotation vector in rad)
and its Jacobian J, the step is `J' (J J' + mu I)^-1 e`. Chosen here: mu is a share of |e|^2 (the damping by the error
of Chan & Lawrence 1988, so the last steps are Newton's); an error longer than a bound is shortened to it (Buss & Kim
2005); lengths count in units of their mean; a step that leaves the limits is put back within them, segment by segment.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.rows import Rows, carve_rows, pick_rows
from sinuous.kernels.chain.kinematics import forward_with_columns, frame
from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.maths.vectors import Array, copy, put_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.solve.driver import Start, begin_from, driver
from sinuous.kernels.solve.judge import Answer, Check, check_size, offer
from sinuous.kernels.step.limits import project_segment
from sinuous.kernels.step.targets import add_rows
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, Budget

MOST_ROWS = 6

LEAST_DAMPING = 1e-12

PATIENCE = 20
"""Steps in a row that gain less than a hundredth before a start is given up."""

Work = namedtuple("Work", ["q", "kept", "columns", "jacobian", "system", "solution", "rows"])
"""Scratch of one solve: the configuration, the best of one start, columns (n, 18), Jacobian (6, 3 n) in scaled
coordinates, its square (6, 6), the solution (6,) of the system, and the rows of the target."""


PER_SEGMENT, BESIDE = 6 + 18 + 3 * MOST_ROWS + 1, MOST_ROWS * (MOST_ROWS + 1 + 27) + 1
"""Numbers (float64) that the scratch takes from a buffer: for every segment, and beside."""


def workspace_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that a search needs as workspace."""
    return check_size(segments, obstacles) + PER_SEGMENT * segments + BESIDE


@kernel
def carve(buffer: Array, segments: int) -> Work:
    """Lay out the scratch at the beginning of `buffer` (w,), for so many segments."""
    n, m = segments, MOST_ROWS
    at = 24 * n + 3 * m * n
    return Work(
        buffer[: 3 * n].reshape((n, 3)),
        buffer[3 * n : 6 * n].reshape((n, 3)),
        buffer[6 * n : 24 * n].reshape((n, 18)),
        buffer[24 * n : at].reshape((m, 3 * n)),
        buffer[at : at + m * m].reshape((m, m)),
        buffer[at + m * m : at + m * (m + 1)],
        pick_rows(carve_rows(buffer[at + m * (m + 1) :], 1, n, m), 0),
    )


@kernel
def fill_jacobian(limits: Array, columns: Array, rows: Rows, count: int, jacobian: Array) -> None:
    """Fill `jacobian` (6, 3 n): derivatives of the first `count` rows in all coordinates, each in units of its scale.

    `limits` (n, 7) and `columns` (n, 18) of the segments, in the length unit and rad.
    """
    for i in range(count):
        for k in range(columns.shape[0]):
            for c in range(3):
                total = 0.0
                for j in range(6):
                    total += rows.twist[i, j] * columns[k, 6 * c + j]
                jacobian[i, 3 * k + c] = total * limits[k, LENGTH_SCALE if c == 2 else BEND_SCALE]


@kernel
def solve_damped(jacobian: Array, count: int, mu: float, system: Array, x: Array) -> None:
    """Solve `(J J' + mu I) x = x` for the first `count` rows, by Cholesky's factors.

    `jacobian` (6, 3 n), without unit; `x` (6,) is the right side, then the solution; `system` (6, 6) is scratch.
    """
    for i in range(count):
        for j in range(i + 1):
            total = mu if i == j else 0.0
            for c in range(jacobian.shape[1]):
                total += jacobian[i, c] * jacobian[j, c]
            for p in range(j):
                total -= system[i, p] * system[j, p]
            system[i, j] = math.sqrt(max(total, LEAST_DAMPING)) if i == j else total / system[j, j]
    for i in range(count):
        for p in range(i):
            x[i] -= system[i, p] * x[p]
        x[i] /= system[i, i]
    for j in range(count):
        i = count - 1 - j
        for p in range(i + 1, count):
            x[i] -= system[p, i] * x[p]
        x[i] /= system[i, i]


@kernel
def step(problem: Problem, work: Work, count: int, damping: float, clamp: float) -> None:
    """Take one step from `work.q`, whose columns and rows are known."""
    square = 0.0
    for i in range(count):
        square += work.rows.value[i] * work.rows.value[i]
    shorten = min(1.0, clamp / math.sqrt(square))
    for i in range(count):
        work.solution[i] = shorten * work.rows.value[i]
    fill_jacobian(problem.limits, work.columns, work.rows, count, work.jacobian)
    solve_damped(work.jacobian, count, damping * square + LEAST_DAMPING, work.system, work.solution)
    q = work.q
    for k in range(q.shape[0]):
        ux = uy = length = 0.0
        for i in range(count):
            ux += work.jacobian[i, 3 * k] * work.solution[i]
            uy += work.jacobian[i, 3 * k + 1] * work.solution[i]
            length += work.jacobian[i, 3 * k + 2] * work.solution[i]
        bend, stretch = problem.limits[k, BEND_SCALE], problem.limits[k, LENGTH_SCALE]
        put_vec(
            q,
            k,
            0,
            project_segment(problem.limits, k, q[k, 0] + bend * ux, q[k, 1] + bend * uy, q[k, 2] + stretch * length),
        )


@kernel
def descend(problem: Problem, check: Check, work: Work, most: int, damping: float, clamp: float) -> int:
    """Step until the target is met, nothing is gained any more, or time is over.

    Begins at `work.q`; fills `work.kept` with the best and returns the number of steps.
    """
    for k in range(work.q.shape[0]):
        put_vec(work.q, k, 0, project_segment(problem.limits, k, work.q[k, 0], work.q[k, 1], work.q[k, 2]))
    origin = frame(check.frames, 0)[1]
    least, slow, iteration = math.inf, 0, 0
    while True:
        forward_with_columns(work.q, check.frames, work.columns)
        count, off, turn = add_rows(problem.targets, 0, check.frames, problem.tool, origin, problem.unit, work.rows, 0)
        wrong = off / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
        if met or slow >= PATIENCE or iteration >= most or spend(check.clock, SEGMENT_LOOKS * work.q.shape[0]):
            return iteration
        step(problem, work, count, damping, clamp)
        iteration += 1


@kernel
def follow(
    problem: Problem, check: Check, work: Work, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.kernels.solve.driver`.

    `options` (3,): most steps from one start, damping as a share of the squared error, and the largest error (robot
    lengths and rad) of one step.
    """
    source = begin_from(problem, check, start, work.q)
    used = descend(problem, check, work, int(options[0]), options[1], options[2])
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
    n = int(robot[0])
    work, rest = carve(workspace, n), workspace[PER_SEGMENT * n + BESIDE :]
    drive(work, (robot, scene, settings), targets, initial, budget, rest, answers)
