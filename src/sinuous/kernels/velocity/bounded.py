"""The damped step within all bounds: free first, then with every row taken in that it leaves, the worst one first."""

import math

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, put_vec, scale
from sinuous.kernels.problem import Problem
from sinuous.kernels.step import sweeps
from sinuous.kernels.velocity.asked import Asked
from sinuous.kernels.velocity.bounds import LEFT, Cut, Limits, worst_cut
from sinuous.kernels.velocity.held import HARD, along, combine, most_left, push, take_in
from sinuous.kernels.velocity.working import (
    HIGH,
    KIND_HIGH,
    KIND_LOW,
    LOW,
    OTHER,
    SEGMENT,
    SOFTNESS,
    TAKEN,
    VALUE,
    WHAT,
    WHERE,
    WHICH,
    WISHED_HIGH,
    WISHED_LOW,
    Tick,
)

SOFT = 1e-3
"""Variance of what is only wished for, as a share of that of what is asked."""

EXACT = 1e-8
"""Least damping."""

GAIN = 100.0
"""How far coordinates may move, as a multiple of the motion that is asked for (rad, and robot lengths)."""

TRIES = 8
"""Most tries to find the damping with which they move that far."""

CUTS_FOR_WISHES = 12
"""Most cuts for the wishes of one segment, on average."""


@kernel
def _worst_bound(rows: Array, step: Array) -> tuple[float, int, int]:
    """By how much a step (n, 3) leaves the bound that it leaves the most, which one, and which of its sides.

    Sides: 0 and 1 what must be at least and at most, 2 and 3 what is wished for.
    """
    worst, which, side = 0.0, -1, 0
    own = 3 * step.shape[0]
    for at in range(rows.shape[0]):
        row = rows[at]
        value, taken = along(row, step), int(row[own + TAKEN])
        if taken & 1 == 0 and row[own + LOW] - value > worst:
            worst, which, side = row[own + LOW] - value, at, 0
        if taken & 2 == 0 and value - row[own + HIGH] > worst:
            worst, which, side = value - row[own + HIGH], at, 1
        if taken & 4 == 0 and row[own + WISHED_LOW] - value > worst:
            worst, which, side = row[own + WISHED_LOW] - value, at, 2
        if taken & 8 == 0 and value - row[own + WISHED_HIGH] > worst:
            worst, which, side = value - row[own + WISHED_HIGH], at, 3
    return worst, which, side


@kernel
def _take_bound(tick: Tick, count: int, at: int, side: int, softness: float) -> None:
    """Make one side of a bound row `count` of those held."""
    held, row, own = tick.held, tick.bounds[at], 3 * tick.q.shape[0]
    row[own + TAKEN] += 1 << side
    sign = -1.0 if side % 2 == 1 else 1.0
    for i in range(own):
        held.weights[count, i] = sign * row[i]
    held.about[count, VALUE] = sign * row[own + LOW + side]
    held.about[count, SOFTNESS] = softness if side >= 2 else HARD
    held.about[count, WHAT] = row[own + (KIND_HIGH if side % 2 == 1 else KIND_LOW)]
    held.about[count, WHERE], held.about[count, WHICH] = row[own + SEGMENT], row[own + OTHER]
    take_in(tick, count)


@kernel
def _take_cut(tick: Tick, count: int, cut: Cut, k: int, softness: float) -> None:
    """Make a cut of segment `k` row `count` of those held."""
    held = tick.held
    for i in range(3 * tick.q.shape[0]):
        held.weights[count, i] = 0.0
    put_vec(held.weights, count, 3 * k, scale(-1.0, cut.weights))
    held.about[count, VALUE] = along(held.weights[count], tick.step) + cut.excess
    held.about[count, SOFTNESS] = softness if cut.soft else HARD
    held.about[count, WHAT], held.about[count, WHERE], held.about[count, WHICH] = cut.kind, k, -1.0
    take_in(tick, count)


@kernel
def bounded(problem: Problem, asked: Asked, tick: Tick, start: Array, bounds: int, mu: float) -> int:
    """Fill `tick.step` with the step of damping `mu` that keeps all bounds; returns how many rows were taken in."""
    held, q, step, rows = tick.held, tick.q, tick.step, tick.bounds[:bounds]
    within, n = Limits(problem.limits, asked.boxes, tick.root, start), q.shape[0]
    for at in range(bounds):
        rows[at, 3 * n + TAKEN] = 0.0
    sweeps.forward(tick.columns, tick.root, tick.none, tick.rows, mu, False)
    sweeps.backward(tick.columns, tick.root, tick.none, tick.rows, held.free, False)
    count = wishes = 0
    combine(held, count, step)
    for _ in range(4 * held.active.shape[0]):
        again, missing = most_left(held, count)
        worst, which, side = _worst_bound(rows, step)
        cut, where = worst_cut(within, q, step, wishes < CUTS_FOR_WISHES * n)
        if max(missing, worst) <= LEFT and where < 0:
            break
        if missing > LEFT and missing >= max(worst, cut.excess):
            push(held, count, again)
            combine(held, count, step)
            continue
        if count == held.active.shape[0]:
            break
        if worst >= cut.excess:
            _take_bound(tick, count, which, side, SOFT * mu)
        else:
            _take_cut(tick, count, cut, where, SOFT * mu)
            wishes += cut.soft
        count += 1
        push(held, count, count - 1)
        combine(held, count, step)
    return count


@kernel
def size_of(tick: Tick, motion: Array) -> float:
    """Norm of a motion (n, 3) in the metric: rad, and lengths of a mean segment."""
    total = 0.0
    for k in range(motion.shape[0]):
        for i in range(3):
            unit = tick.root[k, 4 * i]
            if unit > 0.0:
                total += (motion[k, i] / unit) ** 2
    return math.sqrt(total)


@kernel
def damped(problem: Problem, asked: Asked, tick: Tick, start: Array, bounds: int, mu: float, most: float) -> int:
    """Fill `tick.step` with the bounded step of the least damping, from `mu` on, that moves by no more than `most`.

    Near a singular shape a small motion of the tip would take a large one of the body. The step that is no longer than
    `most` and comes nearest to what is asked is one of larger damping (Levenberg, Marquardt), and continuous in the
    shape. Returns how many rows were taken in.
    """
    count = bounded(problem, asked, tick, start, bounds, mu)
    size = size_of(tick, tick.step)
    if size <= most or mu >= 1.0 / (GAIN * GAIN):
        return count
    low, high = math.log(mu), math.log(1.0 / (GAIN * GAIN))
    above, below = math.log(size / most), math.nan
    count = bounded(problem, asked, tick, start, bounds, math.exp(high))
    size = size_of(tick, tick.step)
    if size >= most or size == 0.0:
        return count
    below = math.log(size / most)
    for _ in range(TRIES):
        middle = (low * below - high * above) / (below - above)
        count = bounded(problem, asked, tick, start, bounds, math.exp(middle))
        size = size_of(tick, tick.step)
        found = math.log(max(size, 1e-300) / most)
        if abs(found) < 1e-3:
            break
        if found > 0.0:
            low, above, below = middle, found, 0.5 * below
        else:
            high, below, above = middle, found, 0.5 * above
    return count
