"""DLS: damped least squares on the geometric Jacobian of the tip.

Wampler 1986, Nakamura & Hanafusa 1986: with the error e of the tip (position in robot lengths, rotation vector in rad)
and its Jacobian J, the step is `J' (J J' + mu I)^-1 e`. Chosen here: mu is a share of |e|^2 (the damping by the error
of Chan & Lawrence 1988, so the last steps are Newton's); an error longer than a bound is shortened to it (Buss & Kim
2005); lengths count in units of their mean; a step that leaves the limits is put back within them, segment by segment.
The system has at most six rows, whatever the number of segments.
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

from sinuous.kernels.body.rows import Rows, carve_rows, pick_rows
from sinuous.kernels.chain.kinematics import forward_with_columns, frame
from sinuous.kernels.clock import SEGMENT_WORK, spend
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, copy, put_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import possible_bend, project_segment
from sinuous.kernels.step.targets import add_rows
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE
from sinuous.methods.method import Capabilities, Options, count, number
from sinuous.methods.search import Answer, Check, Start, begin_from, offer, search_by

MOST_ROWS = 6
"""Rows of a target: a position and a rotation."""

LEAST_DAMPING = 1e-12
"""What is added to the diagonal at least: the system stays solvable where the Jacobian is singular."""

PATIENCE = 20
"""Steps in a row that gain less than a hundredth before a start is given up."""

Work = namedtuple("Work", ["q", "kept", "columns", "jacobian", "system", "solution", "rows"])
"""Scratch of one solve: the configuration, the best of one start, columns (n, 18), Jacobian (6, 3 n) in scaled
coordinates, its square (6, 6), the solution (6,) of the system, and the rows of the target."""


def scratch_size(n: int) -> int:
    """Numbers (float64) of the scratch for n segments."""
    return 3 * n + 3 * n + 18 * n + MOST_ROWS * 3 * n + MOST_ROWS * MOST_ROWS + MOST_ROWS + n + 1 + 28 * MOST_ROWS


def carve(buffer: Array, n: int) -> Work:
    """Lay out the scratch in `buffer`, for n segments."""
    q, rest = cut(buffer, n, 3)
    kept, rest = cut(rest, n, 3)
    columns, rest = cut(rest, n, 18)
    jacobian, rest = cut(rest, MOST_ROWS, 3 * n)
    system, rest = cut(rest, MOST_ROWS, MOST_ROWS)
    rows = pick_rows(carve_rows(rest[MOST_ROWS:], 1, n, MOST_ROWS), 0)
    return Work(q, kept, columns, jacobian, system, rest[:MOST_ROWS], rows)


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
            own = possible_bend(limits, k, jacobian[i, 3 * k], jacobian[i, 3 * k + 1])
            jacobian[i, 3 * k], jacobian[i, 3 * k + 1] = own


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


def descend(problem: Problem, check: Check, work: Work, most: int, damping: float, clamp: float) -> int:
    """Step until the target is met, nothing is gained any more, or time is over.

    Begins at `work.q`; fills `work.kept` with the best and returns the number of steps.
    """
    for k in range(work.q.shape[0]):
        put_vec(work.q, k, 0, project_segment(problem.limits, k, work.q[k, 0], work.q[k, 1], work.q[k, 2]))
    origin = frame(check.frames, 0)[1]
    least, slow, iteration = math.inf, 0, 0
    while True:
        forward_with_columns(problem.limits, work.q, check.frames, work.columns)
        count, off, turn = add_rows(problem.targets, 0, check.frames, problem.tool, origin, problem.unit, work.rows, 0)
        wrong = off / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
        if met or slow >= PATIENCE or iteration >= most or spend(check.clock, SEGMENT_WORK * work.q.shape[0]):
            return iteration
        step(problem, work, count, damping, clamp)
        iteration += 1


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` are the fields of `Dls`."""
    work = carve(scratch, problem.limits.shape[0])
    source = begin_from(problem, check, start, work.q)
    used = descend(problem, check, work, int(options[0]), options[1], options[2])
    return used, offer(problem, check, work.kept, source, answer)


search = search_by(follow)


@dataclass(frozen=True, repr=False)
class Dls(Options):
    """Options of the method `dls`.

    Attributes
    ----------
    iterations : int
        Most steps from one start.
    damping : float
        What is added to the diagonal, as a share of the squared error (robot lengths and rad).
    clamp : float
        Largest error that one step goes for, in robot lengths and rad together.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "dls"
    capabilities: ClassVar[Capabilities] = Capabilities(
        "Wampler 1986, Nakamura & Hanafusa 1986", rotation=True, orientation_alone=True, planes=True
    )

    iterations: int = count(200, 1, 1_000_000)
    damping: float = number(0.1, low=0.0)
    clamp: float = number(0.5, above=0.0)

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return scratch_size(segments)
