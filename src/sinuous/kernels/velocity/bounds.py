"""What bounds a control step: limits and rates of segments and actuators.

All bounds hold for no motion at all, so they never contradict each other: a limit that is exceeded already is one not
to be exceeded further, and so is a gap that is used up. What is only wished for may stay unmet. Bounds of actuators are
linear, and listed beforehand (`add_actuators`). Those of segments are discs and cones: a *cut* is the tangent plane at
the place where a step leaves one, found when it does (`worst_cut`); what curvature leaves over is put right afterwards
(`take`).
"""

import math
from collections import namedtuple

from sinuous.kernels.maths.vectors import ZERO, Array, scale
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import MAX_BEND, MAX_CURVATURE, MAX_LENGTH, MIN_LENGTH
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.layout import Control, StepRequest

ACTUATOR_INSET = 2e-9
"""How far within the limits of actuators a step aims, in units of the metric: more than what it may leave them by."""

BEND_TOLERANCE = 1e-4
"""By how much a step may leave a limit of a bend, as a share of how far it bends: it is put right afterwards."""

RATE_INSET = 1e-3
"""How far within the rates of a bend a step aims, as a share of them: so that few straight cuts make a round bound."""

LENGTH_TOLERANCE = 1e-9
"""By how much it may leave a limit or a rate of a length, in units of the metric."""

Cut = namedtuple("Cut", ["excess", "weights", "soft", "kind"])
"""A bound of one segment that a step leaves: by how much, in units of the metric; weights of its coordinates, so that
their sum has to be less by that excess; 1 for a mere wish; and its kind."""

NO_CUT = Cut(0.0, ZERO, 0, -1)

Limits = namedtuple("Limits", ["limits", "rates", "root", "start"])
"""What bounds the segments: their limits (n, 18), their rates (n, 7), the root of the metric (n, 9), and where the step
began (n, 3). No more than that: these are examined some hundred times in a control step, and all that a call hands over
takes time."""


def along(weights: Array, motion: Array) -> float:
    """What a row of weights (3 n or more,) sees of a motion (n, 3)."""
    total = 0.0
    for k in range(motion.shape[0]):
        total += weights[3 * k] * motion[k, 0] + weights[3 * k + 1] * motion[k, 1] + weights[3 * k + 2] * motion[k, 2]
    return total


def size_of(root: Array, motion: Array) -> float:
    """Norm of a motion (n, 3) in the metric with this root (n, 9): rad, and lengths of a mean segment."""
    total = 0.0
    for k in range(motion.shape[0]):
        for i in range(3):
            unit = root[k, 4 * i]
            if unit > 0.0:
                total += (motion[k, i] / unit) ** 2
    return math.sqrt(total)


def normalise(control: Control, at: int) -> float:
    """Divide the weights of bound `at` by their norm in the metric, and return that; 0 where nothing can move it."""
    row, size = control.bounds[at], 0.0
    for k in range(control.q.shape[0]):
        for i in range(3):
            size += (control.root[k, 4 * i] * row[3 * k + i]) ** 2
    size = math.sqrt(size)
    if not size > 1e-12:
        return 0.0
    for i in range(3 * control.q.shape[0]):
        row[i] /= size
    return size


def _value_of(actuator: Array, q: Array) -> float:
    """Value of an actuator with these derivatives (3 n or more,) at the configuration `q` (n, 3)."""
    total = 0.0
    for k in range(q.shape[0]):
        for i in range(3):
            total += actuator[3 * k + i] * q[k, i]
    return total


def _range_of(actuator: Array, began: float) -> tuple[float, float, bool, bool]:
    """Least and greatest value that an actuator may have in a step, and whether these are its limits, not its rates.

    `actuator` are its columns, `began` the value that it began with.
    """
    least, most = min(actuator[v.LOWEST], began), max(actuator[v.HIGHEST], began)
    slowest, fastest = began - actuator[v.LARGEST_CHANGE], began + actuator[v.LARGEST_CHANGE]
    return max(least, slowest), min(most, fastest), least >= slowest, most <= fastest


def add_actuators(asked: StepRequest, control: Control, start: Array, first: int) -> int:
    """Write the bounds of actuators, from row `first` on, and return the next free row.

    `start` (n, 3) is where the step began.
    """
    at, own = first, 3 * control.q.shape[0]
    for j in range(asked.actuators.shape[0]):
        actuator, row = asked.actuators[j], control.bounds[at]
        for i in range(own):
            row[i] = actuator[i]
        size = normalise(control, at)
        if size == 0.0:
            continue
        began, value = _value_of(actuator, start), _value_of(actuator, control.q)
        least, most, by_limit, by_other_limit = _range_of(actuator[own:], began)
        row[own + v.KIND_LOW] = v.ACTUATOR_LIMIT if by_limit else v.ACTUATOR_RATE_LIMIT
        row[own + v.KIND_HIGH] = v.ACTUATOR_LIMIT if by_other_limit else v.ACTUATOR_RATE_LIMIT
        low, high = (least - value) / size, (most - value) / size
        inset = min(ACTUATOR_INSET, 0.5 * (high - low))
        row[own + v.LOW], row[own + v.HIGH] = low + inset, high - inset
        aim, second = began + actuator[own + v.LAST_CHANGE] - value, actuator[own + v.SECOND_DIFFERENCE]
        row[own + v.WISHED_LOW], row[own + v.WISHED_HIGH] = (aim - second) / size, (aim + second) / size
        row[own + v.GAP], row[own + v.BOUND_SEGMENT], row[own + v.BOUND_OTHER] = math.inf, -1.0, j
        at += 1
    return at


def _disc(root: Array, k: int, bend: tuple[float, float], cap: float, slope: float, left: float, kind: int) -> Cut:
    """The cut of a `bend` that is beyond `cap`, which grows by `slope` with the length.

    Nothing, where that is not more than `left`.
    """
    x, y = bend
    most = math.hypot(x, y)
    if not (most > cap + left and root[k, 0] > 0.0):
        return NO_CUT
    size = math.hypot(root[k, 0], root[k, 8] * slope)
    weights = (x / (most * size), y / (most * size), -slope / size)
    return Cut((most - cap) / size, weights, int(kind == v.ACCELERATION_LIMIT), kind)


def _bend_cut(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of the bend of segment `k` that the step from `q` leaves the most."""
    limits, root, rates, start = within.limits, within.root, within.rates[k], within.start
    dx, dy = step[k, 0], step[k, 1]
    ux, uy, length = q[k, 0] + dx, q[k, 1] + dy, q[k, 2] + step[k, 2]
    x0, y0 = start[k, 0], start[k, 1]
    bent, left = math.hypot(x0, y0), BEND_TOLERANCE * math.hypot(dx, dy)
    worst = _disc(root, k, (ux, uy), max(limits[k, MAX_BEND], bent), 0.0, left, v.BEND_LIMIT)
    curvature = limits[k, MAX_CURVATURE]
    if curvature < math.inf:
        cap = curvature * length + max(0.0, bent - curvature * start[k, 2])
        cut = _disc(root, k, (ux, uy), cap, curvature, left, v.CURVATURE_LIMIT)
        if cut.excess > worst.excess:
            worst = cut
    cap = rates[v.BEND_CHANGE]
    cut = _disc(root, k, (ux - x0, uy - y0), (1.0 - RATE_INSET) * cap, 0.0, RATE_INSET * cap, v.BEND_RATE_LIMIT)
    if cut.excess > worst.excess:
        worst = cut
    cap, vx, vy = rates[v.BEND_SECOND], ux - x0 - rates[v.CHANGE_BEFORE], uy - y0 - rates[v.CHANGE_BEFORE + 1]
    cut = _disc(root, k, (vx, vy), (1.0 - RATE_INSET) * cap, 0.0, RATE_INSET * cap, v.ACCELERATION_LIMIT)
    return cut if cut.excess > worst.excess else worst


def _cut_of(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of segment `k` that the step from `q` leaves the most; its kind is -1 where it leaves none."""
    worst, stretch, rates, l0 = _bend_cut(within, q, step, k), within.root[k, 8], within.rates[k], within.start[k, 2]
    if not stretch > 0.0:
        return worst
    length, axis = q[k, 2] + step[k, 2], (0.0, 0.0, 1.0 / stretch)
    least, most = min(within.limits[k, MIN_LENGTH], l0), max(within.limits[k, MAX_LENGTH], l0)
    shortest, longest = l0 - rates[v.LENGTH_CHANGE], l0 + rates[v.LENGTH_CHANGE]
    under, over = (max(least, shortest) - length) / stretch, (length - min(most, longest)) / stretch
    if under > max(LENGTH_TOLERANCE, worst.excess):
        worst = Cut(under, scale(-1.0, axis), 0, v.LENGTH_LIMIT if least >= shortest else v.LENGTH_RATE_LIMIT)
    if over > max(LENGTH_TOLERANCE, worst.excess):
        worst = Cut(over, axis, 0, v.LENGTH_LIMIT if most <= longest else v.LENGTH_RATE_LIMIT)
    off = length - l0 - rates[v.CHANGE_BEFORE + 2]
    beyond = (abs(off) - rates[v.LENGTH_SECOND]) / stretch
    if beyond > max(LENGTH_TOLERANCE, worst.excess):
        worst = Cut(beyond, scale(1.0 if off > 0.0 else -1.0, axis), 1, v.ACCELERATION_LIMIT)
    return worst


def worst_cut(within: Limits, q: Array, step: Array, wishes: bool) -> tuple[Cut, int]:
    """The bound of a segment that the step from `q` (n, 3) leaves the most, and which segment; -1 where there is none.

    Segments that leave a mere wish the most count only with `wishes`.
    """
    worst, where = NO_CUT, -1
    for k in range(q.shape[0]):
        cut = _cut_of(within, q, step, k)
        if cut.kind >= 0 and cut.excess > worst.excess and (wishes or cut.soft == 0):
            worst, where = cut, k
    return worst, where


def _put_within(problem: Problem, asked: StepRequest, control: Control, start: Array, k: int) -> None:
    """Put segment `k` of `control.trial` within its limits and rates: by rounding, when the step has kept bounds."""
    limits, rates, q = problem.limits, asked.rates[k], control.trial
    x0, y0, l0, curvature = start[k, 0], start[k, 1], start[k, 2], limits[k, MAX_CURVATURE]
    bent = math.hypot(x0, y0)
    least = max(min(limits[k, MIN_LENGTH], l0), l0 - rates[v.LENGTH_CHANGE])
    q[k, 2] = min(max(q[k, 2], least), max(limits[k, MAX_LENGTH], l0), l0 + rates[v.LENGTH_CHANGE])
    cap, bend = max(limits[k, MAX_BEND], bent), math.hypot(q[k, 0], q[k, 1])
    if curvature < math.inf:
        cap = min(cap, curvature * q[k, 2] + max(0.0, bent - curvature * l0))
    if bend > cap:
        q[k, 0], q[k, 1] = q[k, 0] * cap / bend, q[k, 1] * cap / bend
    change = math.hypot(q[k, 0] - x0, q[k, 1] - y0)
    if change > rates[v.BEND_CHANGE]:  # towards the start, where all of them hold: they are convex
        t = rates[v.BEND_CHANGE] / change
        q[k, 0], q[k, 1], q[k, 2] = x0 + t * (q[k, 0] - x0), y0 + t * (q[k, 1] - y0), l0 + t * (q[k, 2] - l0)


def _share_of_actuators(asked: StepRequest, control: Control, start: Array) -> float:
    """Largest share, of the way from `control.q` to `control.trial`, that keeps the limits and rates of actuators."""
    own, t = 3 * control.q.shape[0], 1.0
    for j in range(asked.actuators.shape[0]):
        actuator = asked.actuators[j]
        value, aim = _value_of(actuator, control.q), _value_of(actuator, control.trial)
        least, most, _, _ = _range_of(actuator[own:], _value_of(actuator, start))
        if aim > most:
            t = min(t, max(0.0, (most - value) / (aim - value)))
        elif aim < least:
            t = min(t, max(0.0, (least - value) / (aim - value)))
    return t


def take(problem: Problem, asked: StepRequest, control: Control, start: Array) -> None:
    """Fill `control.trial` with where `control.step` leads, within all limits and rates."""
    n = control.q.shape[0]
    for k in range(n):
        for i in range(3):
            control.trial[k, i] = control.q[k, i] + control.step[k, i]
        _put_within(problem, asked, control, start, k)
    t = _share_of_actuators(asked, control, start)
    if t < 1.0:
        for k in range(n):
            for i in range(3):
                control.trial[k, i] = control.q[k, i] + t * (control.trial[k, i] - control.q[k, i])
