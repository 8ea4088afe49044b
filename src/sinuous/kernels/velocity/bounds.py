"""What bounds a control step: limits and rates of segments and actuators.

All bounds hold for no motion at all, so they never contradict each other: a limit that is exceeded already is one not
to be exceeded further, and so is a gap that is used up. What is only wished for may stay unmet. Bounds of actuators are
linear, and listed beforehand (`add_actuators`). Those of segments are discs and cones: a *cut* is the tangent plane at
the place where a step leaves one, found when it does (`worst_cut`); what curvature leaves over is put right afterwards
(`move_within_bounds`).

`start` (n, 3) is where the step begins, `step` (n, 3) a motion, `rates` (7,) those of a segment, and `actuator` (3 n +
5,) a row of actuators, see `layout`.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain.kinematics import shorten
from sinuous.kernels.compile import apart
from sinuous.kernels.maths.vectors import ZERO, Array, dot, get_mat, get_vec, mat_vec, scale, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import (
    bend_cap,
    bends_in_plane,
    curved_bend,
    in_plane,
    plane_bend,
    plane_range,
    possible_bend,
)
from sinuous.kernels.tables import (
    BEND_SCALE,
    HIGH_BEND,
    LENGTH_SCALE,
    LOW_BEND,
    MAX_BEND,
    MAX_CURVATURE,
    MAX_LENGTH,
    MIN_LENGTH,
    PLANE,
)
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

ROUNDING = 1e-12
"""What is off a plane (rad), or a value that is held (relative to what it is the sum of), and counts as on it."""

LEVEL = 1e-6
"""How far from a value that is held a step may end and be brought back to it, in units of the metric."""

Cut = namedtuple("Cut", ["excess", "weights", "soft", "kind"])
"""A bound of one segment that a step leaves: by how much, in units of the metric; weights of its coordinates, so that
their sum has to be less by that excess; 1 for a mere wish; and its kind."""

NO_CUT = Cut(0.0, ZERO, 0, -1)

Limits = namedtuple("Limits", ["limits", "rates", "root", "start"])
"""What bounds the segments: their limits (n, 35), their rates (n, 7), the root of the metric (n, 9), and where the step
began (n, 3). No more than that: these are examined some hundred times in a control step, and all that a call hands over
takes time."""


def along(weights: Array, motion: Array) -> float:
    """What a row of weights (3 n or more,) sees of a motion (n, 3)."""
    total = 0.0
    for k in range(motion.shape[0]):
        total += weights[3 * k] * motion[k, 0] + weights[3 * k + 1] * motion[k, 1] + weights[3 * k + 2] * motion[k, 2]
    return total


def size_of(limits: Array, motion: Array) -> float:
    """Norm of a motion (n, 3) in the metric of segments with these limits (n, 35): rad, and lengths of a mean one."""
    total = 0.0
    for k in range(motion.shape[0]):
        bend, stretch = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE]
        if bend > 0.0:
            ux, uy = possible_bend(limits, k, motion[k, 0], motion[k, 1])
            total += (ux / bend) ** 2
            total += (uy / bend) ** 2
        if stretch > 0.0:
            total += (motion[k, 2] / stretch) ** 2
    return math.sqrt(total)


def normalise(control: Control, at: int) -> float:
    """Divide the weights of bound `at` by their norm in the metric, and return that; 0 where nothing can move it."""
    row, size = control.bounds[at], 0.0
    for k in range(control.q.shape[0]):
        x, y, z = vec_mat((row[3 * k], row[3 * k + 1], row[3 * k + 2]), get_mat(control.root, k, 0))
        size += x * x
        size += y * y
        size += z * z
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


def _side(within: Limits, k: int, side: float, excess: float, slope: float, left: float, kind: int) -> Cut:
    """The cut of a bend in a plane that is beyond a bound by `excess`, to one `side` (1 or -1); else as `_disc`."""
    limits = within.limits
    if not excess > left:
        return NO_CUT
    size = math.hypot(limits[k, BEND_SCALE], within.root[k, 8] * slope)
    weights = (side * limits[k, PLANE] / size, side * limits[k, PLANE + 1] / size, -slope / size)
    return Cut(excess / size, weights, int(kind == v.ACCELERATION_LIMIT), kind)


@apart
def _plane_cut(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of the bend of segment `k`, which bends in one plane, that the step from `q` leaves the most."""
    limits, rates, start, worst = within.limits, within.rates[k], within.start, NO_CUT
    if limits[k, BEND_SCALE] == 0.0:
        return worst
    z = in_plane(limits, k, q[k, 0] + step[k, 0], q[k, 1] + step[k, 1])
    began, length = in_plane(limits, k, start[k, 0], start[k, 1]), q[k, 2] + step[k, 2]
    curved, growth = curved_bend(limits, k, length)
    before = in_plane(limits, k, rates[v.CHANGE_BEFORE], rates[v.CHANGE_BEFORE + 1])
    for i in range(2):
        side = 1.0 - 2.0 * i
        cap = limits[k, HIGH_BEND] if i == 0 else -limits[k, LOW_BEND]
        cut = _side(within, k, side, side * z - max(cap, side * began), 0.0, LENGTH_TOLERANCE, v.BEND_LIMIT)
        if cut.excess > worst.excess:
            worst = cut
        if curved < math.inf:
            beyond = side * z - curved - max(0.0, side * began - curved_bend(limits, k, start[k, 2])[0])
            left = LENGTH_TOLERANCE + BEND_TOLERANCE * abs(z - in_plane(limits, k, q[k, 0], q[k, 1]))
            cut = _side(within, k, side, beyond, growth, left, v.CURVATURE_LIMIT)
            if cut.excess > worst.excess:
                worst = cut
        change = side * (z - began)
        cut = _side(within, k, side, change - rates[v.BEND_CHANGE], 0.0, LENGTH_TOLERANCE, v.BEND_RATE_LIMIT)
        if cut.excess > worst.excess:
            worst = cut
        change -= side * before + rates[v.BEND_SECOND]
        cut = _side(within, k, side, change, 0.0, LENGTH_TOLERANCE, v.ACCELERATION_LIMIT)
        if cut.excess > worst.excess:
            worst = cut
    return worst


def _cut_of(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of segment `k` that the step from `q` leaves the most; its kind is -1 where it leaves none."""
    planar = bends_in_plane(within.limits, k)
    worst = _plane_cut(within, q, step, k) if planar else _bend_cut(within, q, step, k)
    stretch, rates, l0 = within.root[k, 8], within.rates[k], within.start[k, 2]
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
    if bends_in_plane(limits, k):
        _put_in_plane(limits, rates, q, start, k)
        return
    cap, bend = max(limits[k, MAX_BEND], bent), math.hypot(q[k, 0], q[k, 1])
    if curvature < math.inf:
        cap = min(cap, curvature * q[k, 2] + max(0.0, bent - curvature * l0))
    if bend > cap:
        q[k, 0], q[k, 1] = q[k, 0] * cap / bend, q[k, 1] * cap / bend
    change = math.hypot(q[k, 0] - x0, q[k, 1] - y0)
    if change > rates[v.BEND_CHANGE]:  # towards the start, where all of them hold: they are convex
        t = rates[v.BEND_CHANGE] / change
        q[k, 0], q[k, 1], q[k, 2] = x0 + t * (q[k, 0] - x0), y0 + t * (q[k, 1] - y0), l0 + t * (q[k, 2] - l0)


@apart
def _put_in_plane(limits: Array, rates: Array, q: Array, start: Array, k: int) -> None:
    """The same for the bend of a segment in its plane; across it, it stays as it began."""
    if limits[k, BEND_SCALE] == 0.0:
        q[k, 0], q[k, 1] = start[k, 0], start[k, 1]
        return
    began = in_plane(limits, k, start[k, 0], start[k, 1])
    beyond = max(0.0, abs(began) - curved_bend(limits, k, start[k, 2])[0])
    curved = curved_bend(limits, k, q[k, 2])[0] + beyond
    low = max(min(limits[k, LOW_BEND], began), -curved, began - rates[v.BEND_CHANGE])
    high = min(max(limits[k, HIGH_BEND], began), curved, began + rates[v.BEND_CHANGE])
    z = min(max(in_plane(limits, k, q[k, 0], q[k, 1]), low), max(low, high))
    x, y = plane_bend(limits, k, began)
    off = abs(start[k, 0] - x) + abs(start[k, 1] - y)
    if off <= ROUNDING:
        q[k, 0], q[k, 1] = plane_bend(limits, k, z)
    else:
        q[k, 0] = start[k, 0] + (z - began) * limits[k, PLANE]
        q[k, 1] = start[k, 1] + (z - began) * limits[k, PLANE + 1]


def _held_value(asked: StepRequest, j: int, own: int) -> bool:
    """Whether limits of actuator `j` leave one value; `own` is where its columns begin."""
    return bool(asked.actuators[j, own + v.LOWEST] == asked.actuators[j, own + v.HIGHEST])


def _rounding_of(actuator: Array, q: Array) -> float:
    """What rounding does to the value of an actuator."""
    size = 0.0
    for k in range(q.shape[0]):
        for i in range(3):
            size += abs(actuator[3 * k + i] * q[k, i])
    return ROUNDING * size


def _can_move(limits: Array, q: Array, k: int) -> bool:
    """Whether segment `k` of `q` may move a little to all sides within its own limits, or cannot stretch."""
    z, length = in_plane(limits, k, q[k, 0], q[k, 1]), q[k, 2]
    low, high = plane_range(limits, k, length) if bends_in_plane(limits, k) else (0.0, bend_cap(limits, k, length))
    bend = z if bends_in_plane(limits, k) else math.hypot(q[k, 0], q[k, 1])
    long = limits[k, LENGTH_SCALE]
    inside = long == 0.0 or limits[k, MIN_LENGTH] + LEVEL * long < length < limits[k, MAX_LENGTH] - LEVEL * long
    under = bends_in_plane(limits, k) and bend < low + LEVEL
    return bool(inside and bend < high - LEVEL and not under)


def _level(limits: Array, asked: StepRequest, control: Control) -> None:
    """Bring `control.trial` to the values of actuators whose limits leave one, by the least motion, row by row.

    Only where they are nearly there: where a step began outside limits it need not come back. Segments at their own
    limits stay there.
    """
    own = 3 * control.q.shape[0]
    for j in range(asked.actuators.shape[0]):
        if _held_value(asked, j, own):
            _level_one(limits, asked, control, j, own)


@apart
def _level_one(limits: Array, asked: StepRequest, control: Control, j: int, own: int) -> None:
    gap, spread = asked.actuators[j, own + v.LOWEST] - _value_of(asked.actuators[j], control.trial), 0.0
    for k in range(control.q.shape[0]):
        if _can_move(limits, control.trial, k):
            seen = vec_mat(get_vec(asked.actuators, j, 3 * k), get_mat(control.root, k, 0))
            spread += dot(seen, seen)
    if spread == 0.0 or abs(gap) > LEVEL * math.sqrt(spread):
        return
    for k in range(control.q.shape[0]):
        if not _can_move(limits, control.trial, k):
            continue
        root = get_mat(control.root, k, 0)
        move = mat_vec(root, vec_mat(get_vec(asked.actuators, j, 3 * k), root))
        for i in range(3):
            control.trial[k, i] += gap / spread * move[i]


def _share_of_actuators(asked: StepRequest, control: Control, start: Array) -> float:
    """Largest share, of the way from `control.q` to `control.trial`, that keeps the limits and rates of actuators."""
    own, t = 3 * control.q.shape[0], 1.0
    for j in range(asked.actuators.shape[0]):
        actuator = asked.actuators[j]
        value, aim = _value_of(actuator, control.q), _value_of(actuator, control.trial)
        least, most, _, _ = _range_of(actuator[own:], _value_of(actuator, start))
        if _held_value(asked, j, own) and max(least - aim, aim - most) <= _rounding_of(actuator, control.trial):
            continue
        if aim > most:
            t = min(t, max(0.0, (most - value) / (aim - value)))
        elif aim < least:
            t = min(t, max(0.0, (least - value) / (aim - value)))
    return t


def move_within_bounds(problem: Problem, asked: StepRequest, control: Control, start: Array) -> None:
    """Fill `control.trial` with where `control.step` leads, within all limits and rates."""
    n = control.q.shape[0]
    for k in range(n):
        for i in range(3):
            control.trial[k, i] = control.q[k, i] + control.step[k, i]
        _put_within(problem, asked, control, start, k)
    _level(problem.limits, asked, control)
    t = _share_of_actuators(asked, control, start)
    if t < 1.0:
        shorten(control.q, control.trial, t)
