"""The damped step within all constraints, by the dual active-set method.

Let H be the matrix of the damped step without any constraint, and `c` the weights of a constraint, `c . dq >= value`.
The least motion that keeps them all is `dq + sum of x_a H^-1 c_a` with multipliers `x >= 0` where
`(c_a . H^-1 c_b + softness_a [a = b]) x_b >= value_a - c_a . dq`, and one of the two holds with equality: the dual of
a quadratic program (Nocedal & Wright, chapter 16; Lawson & Hanson 1974; Goldfarb & Idnani 1983 for adding the
constraint that is violated the most). `H^-1 c` comes from the two sweeps that made the step, see `step.coupling`.

The step is free first; then the constraint that it violates the most is added to the working set, until it violates
none. Those of contacts and actuators are listed in `bounds`, those of single segments are found when they are
violated (`bounds.worst_cut`). All compete by how much they are violated, in the metric. Where the working set is full,
the step is left as it is, and `move_within_bounds` brings it within what is left out: it is shorter than the best one.

`start` (n, 3) is where the step begins; `rows` (b, 3 n + 10) are bounds.
"""

import math

from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array, copy, put_vec, scale
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.dense import solve_symmetric
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.body import answer_weights, move_freely
from sinuous.kernels.velocity.bounds import LENGTH_TOLERANCE, Cut, Limits, along, size_of, worst_cut
from sinuous.kernels.velocity.layout import Control, StepRequest, WorkingSet

HARD_VARIANCE = 1e-13
"""Variance of constraints that must hold: enough for two that say the same."""

SOFT_VARIANCE_RATIO = 1e-3
"""Variance of what is only wished for, as a share of that of what is asked."""

LEAST_DAMPING = 1e-8
"""Least damping."""

GAIN = 100.0
"""How far coordinates may move, as a multiple of the motion that is asked for (rad, and robot lengths)."""

TRIES = 8
"""Most tries to find the damping with which they move that far."""

CUTS_FOR_WISHES = 12
"""Most cuts for the wishes of one segment, on average."""


def most_violated(working: WorkingSet, count: int) -> tuple[int, float]:
    """The constraint of the working set, among those that are not active, that is violated the most, and by how much.

    -1 where there is none.
    """
    worst, excess = -1, 0.0
    for a in range(count):
        if working.active[a] == 0:
            missing = working.about[a, v.CONSTRAINT_VALUE]
            for b in range(count):  # who is not active has no multiplier
                missing -= working.system[a, b] * working.about[b, v.MULTIPLIER]
            if missing > excess:
                worst, excess = a, missing
    return worst, excess


def _solve_active(working: WorkingSet, count: int) -> int:
    """Solve for the multipliers of the m active constraints, into column m of `scratch`; returns m."""
    m = 0
    for a in range(count):
        if working.active[a] != 0:
            working.listed[m] = a
            m += 1
    for i in range(m):
        a = working.listed[i]
        for j in range(i, m):  # what is below the diagonal is never read
            working.scratch[i, j] = working.system[a, working.listed[j]]
        working.scratch[i, m] = working.about[a, v.CONSTRAINT_VALUE]
    solve_symmetric(working.scratch, m)
    return m


def activate(working: WorkingSet, count: int, a: int) -> None:
    """Make constraint `a` active, too, and find all multipliers: constraints whose own would be negative are let go."""
    working.active[a] = 1
    for _ in range(2 * count + 2):
        m = _solve_active(working, count)
        fraction = 1.0
        for i in range(m):
            multiplier = working.scratch[i, m]
            if multiplier <= 0.0:
                before = working.about[working.listed[i], v.MULTIPLIER]
                fraction = min(fraction, before / (before - multiplier) if before > multiplier else 0.0)
        left = False
        for i in range(m):
            b, multiplier = working.listed[i], working.scratch[i, m]
            before = working.about[b, v.MULTIPLIER]
            moved = before + fraction * (multiplier - before)
            if fraction < 1.0 and multiplier <= 0.0 and moved <= 1e-12 * (abs(multiplier) + before):
                moved, left = 0.0, True
                working.active[b] = 0
            working.about[b, v.MULTIPLIER] = moved
        if not left:
            return


def _combine(working: WorkingSet, count: int, step: Array) -> None:
    """Fill `step` (n, 3) with the step that the multipliers make."""
    copy(working.free, step)
    for a in range(count):
        if working.active[a] != 0:
            multiplier = working.about[a, v.MULTIPLIER]
            for k in range(step.shape[0]):
                for i in range(3):
                    step[k, i] += multiplier * working.replies[a, 3 * k + i]


def _worst_bound(rows: Array, step: Array) -> tuple[float, int, int]:
    """By how much a step (n, 3) violates the bound that it violates the most, which one, and which of its sides.

    Sides, as the columns from LOW on: 0 and 1 what must be at least and at most, 2 and 3 what is wished for.
    """
    worst, which, side = 0.0, -1, 0
    own = 3 * step.shape[0]
    for at in range(rows.shape[0]):
        value, taken = along(rows[at], step), int(rows[at, own + v.TAKEN])
        for i in range(4):
            excess = value - rows[at, own + v.LOW + i] if i % 2 == 1 else rows[at, own + v.LOW + i] - value
            if excess > worst and (taken >> i) & 1 == 0:
                worst, which, side = excess, at, i
    return worst, which, side


def _add_bound(control: Control, count: int, at: int, side: int, softness: float) -> None:
    """Make one side of a bound constraint number `count` of the working set."""
    working, row, own = control.working, control.bounds[at], 3 * control.q.shape[0]
    row[own + v.TAKEN] += 1 << side
    sign = -1.0 if side % 2 == 1 else 1.0
    for i in range(own):
        working.weights[count, i] = sign * row[i]
    working.about[count, v.CONSTRAINT_VALUE] = sign * row[own + v.LOW + side]
    working.about[count, v.CONSTRAINT_VARIANCE] = softness if side >= 2 else HARD_VARIANCE
    working.about[count, v.CONSTRAINT_KIND] = row[own + (v.KIND_HIGH if side % 2 == 1 else v.KIND_LOW)]
    working.about[count, v.CONSTRAINT_SEGMENT], working.about[count, v.CONSTRAINT_OTHER] = (
        row[own + v.BOUND_SEGMENT],
        row[own + v.BOUND_OTHER],
    )
    _add(control, count)


def _add_cut(control: Control, count: int, cut: Cut, k: int, softness: float) -> None:
    """Make a cut of segment `k` constraint number `count` of the working set."""
    working = control.working
    for i in range(3 * control.q.shape[0]):
        working.weights[count, i] = 0.0
    put_vec(working.weights, count, 3 * k, scale(-1.0, cut.weights))
    working.about[count, v.CONSTRAINT_VALUE] = along(working.weights[count], control.step) + cut.excess
    working.about[count, v.CONSTRAINT_VARIANCE] = softness if cut.soft else HARD_VARIANCE
    (
        working.about[count, v.CONSTRAINT_KIND],
        working.about[count, v.CONSTRAINT_SEGMENT],
        working.about[count, v.CONSTRAINT_OTHER],
    ) = cut.kind, k, -1.0
    _add(control, count)


def _dot(a: Array, b: Array) -> float:
    """Product of `a` (w,) and `b` (w,)."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    return total


def _add(control: Control, count: int) -> None:
    """Compute what constraint number `count` moves, and make it active; its weights and its value are there."""
    working = control.working
    moved = shaped(working.replies[count], (control.q.shape[0], 3))
    answer_weights(control, control.body, count, moved)
    for b in range(count + 1):
        working.system[count, b] = working.system[b, count] = _dot(working.weights[b], working.replies[count])
    working.system[count, count] += working.about[count, v.CONSTRAINT_VARIANCE]
    working.about[count, v.CONSTRAINT_VALUE] -= along(working.weights[count], working.free)
    working.about[count, v.MULTIPLIER] = 0.0
    activate(working, count + 1, count)


def _constrained(problem: Problem, asked: StepRequest, control: Control, start: Array, bounds: int, mu: float) -> int:
    """Fill `control.step` with the step of damping `mu` within all constraints; returns the size of the working set."""
    working, q, step, rows = control.working, control.q, control.step, control.bounds[:bounds]
    within, n = Limits(problem.limits, asked.rates, control.root, start), q.shape[0]
    for at in range(bounds):
        rows[at, 3 * n + v.TAKEN] = 0.0
    move_freely(control, control.body, mu)
    count = wishes = 0
    _combine(working, count, step)
    for _ in range(4 * working.active.shape[0]):
        again, missing = most_violated(working, count)
        worst, which, side = _worst_bound(rows, step)
        cut, where = worst_cut(within, q, step, wishes < CUTS_FOR_WISHES * n)
        if max(missing, worst) <= LENGTH_TOLERANCE and where < 0:
            break
        if missing > LENGTH_TOLERANCE and missing >= max(worst, cut.excess):
            activate(working, count, again)
        elif count == working.active.shape[0]:
            break
        elif worst >= cut.excess:
            _add_bound(control, count, which, side, SOFT_VARIANCE_RATIO * mu)
            count += 1
        else:
            _add_cut(control, count, cut, where, SOFT_VARIANCE_RATIO * mu)
            wishes += cut.soft
            count += 1
        _combine(working, count, step)
    return count


def constrained_step(
    problem: Problem, asked: StepRequest, control: Control, start: Array, bounds: int, mu: float, most: float
) -> int:
    """Fill `control.step` with the constrained step of the least damping, from `mu` on, that moves by at most `most`.

    Near a singular shape a small motion of the tip would take a large one of the body. The step that is no longer than
    `most` and comes nearest to what is asked is one of larger damping (Levenberg, Marquardt), and continuous in the
    shape. It is found by false position in the logarithms of damping and size (the Illinois rule). Returns how many
    constraints are in the working set.
    """
    count = _constrained(problem, asked, control, start, bounds, mu)
    size = size_of(problem.limits, control.step)
    if size <= most or mu >= 1.0 / (GAIN * GAIN):
        return count
    low, high, above = math.log(mu), math.log(1.0 / (GAIN * GAIN)), math.log(size / most)
    count = _constrained(problem, asked, control, start, bounds, math.exp(high))
    size = size_of(problem.limits, control.step)
    if size >= most or size == 0.0:
        return count
    below = math.log(size / most)
    for _ in range(TRIES):
        middle = (low * below - high * above) / (below - above)
        count = _constrained(problem, asked, control, start, bounds, math.exp(middle))
        size = size_of(problem.limits, control.step)
        found = math.log(max(size, 1e-300) / most)
        if abs(found) < 1e-3:
            break
        if found > 0.0:
            low, above, below = middle, found, 0.5 * below
        else:
            high, below, above = middle, found, 0.5 * above
    return count
