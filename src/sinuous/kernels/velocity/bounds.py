"""What bounds the motion of a tick: limits and rates of segments and actuators, contacts.

All bounds hold for no motion at all, so they never contradict each other: a limit that is exceeded already is one not
to be exceeded further, and so is a gap that is used up. What is only wished for may stay unmet.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import ZERO, Array, scale
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import MAX_BEND, MAX_CURVATURE, MAX_LENGTH, MIN_LENGTH
from sinuous.kernels.velocity.asked import (
    BEFORE,
    BEND_CHANGE,
    BEND_TURN,
    CHANGE,
    LAST,
    LEAST,
    LENGTH_CHANGE,
    LENGTH_TURN,
    MOST,
    TURN,
    Asked,
)
from sinuous.kernels.velocity.working import (
    ACCELERATION,
    ACTUATOR,
    ACTUATOR_RATE,
    BEND,
    BEND_RATE,
    CURVATURE,
    GAP,
    HIGH,
    KIND_HIGH,
    KIND_LOW,
    LENGTH,
    LENGTH_RATE,
    LOW,
    OTHER,
    SEGMENT,
    WISHED_HIGH,
    WISHED_LOW,
    Tick,
)

INSET = 2e-9
"""How far within the limits of actuators a step aims, in units of the metric: more than what it may leave them by."""

CUT = 1e-4
"""By how much a step may leave a limit of a bend, as a share of how far it bends: it is put right afterwards."""

ROOM = 1e-3
"""How far within the rates of a bend a step aims, as a share of them: so that few straight cuts make a round bound."""

LEFT = 1e-9
"""By how much it may leave a limit or a rate of a length, in units of the metric."""

Cut = namedtuple("Cut", ["excess", "weights", "soft", "kind"])
"""A bound of one segment that a step leaves: by how much, in units of the metric; weights of its coordinates, so that
their sum has to be less by that excess; 1 for a mere wish; and what it is called."""

NO_CUT = Cut(0.0, ZERO, 0, -1)

Limits = namedtuple("Limits", ["limits", "boxes", "root", "start"])
"""What bounds the segments: their limits (n, 7), their rates (n, 7), the root of the metric (n, 9), and where the tick
began (n, 3). No more than that: these are looked at some hundred times in a tick, and all that a call hands over takes
time."""


@kernel
def add_lines(asked: Asked, tick: Tick, start: Array, first: int) -> int:
    """Write the bounds of actuators, from row `first` on; `start` (n, 3) is where the tick began."""
    n, at = tick.q.shape[0], first
    own = 3 * n
    for j in range(asked.lines.shape[0]):
        line, row = asked.lines[j], tick.bounds[at]
        began = value = size = 0.0
        for k in range(n):
            for i in range(3):
                weight = line[3 * k + i]
                row[3 * k + i] = weight
                began, value = began + weight * start[k, i], value + weight * tick.q[k, i]
                size += (tick.root[k, 4 * i] * weight) ** 2
        size = math.sqrt(size)
        if not size > 1e-12:
            continue
        for i in range(own):
            row[i] /= size
        least, most = min(line[own + LEAST], began), max(line[own + MOST], began)
        slowest, fastest = began - line[own + CHANGE], began + line[own + CHANGE]
        row[own + KIND_LOW] = ACTUATOR if least >= slowest else ACTUATOR_RATE
        row[own + KIND_HIGH] = ACTUATOR if most <= fastest else ACTUATOR_RATE
        low, high = (max(least, slowest) - value) / size, (min(most, fastest) - value) / size
        inset = min(INSET, 0.5 * (high - low))
        row[own + LOW], row[own + HIGH] = low + inset, high - inset
        aim = began + line[own + LAST] - value
        row[own + WISHED_LOW], row[own + WISHED_HIGH] = (aim - line[own + TURN]) / size, (aim + line[own + TURN]) / size
        row[own + GAP], row[own + SEGMENT], row[own + OTHER] = math.inf, -1.0, j
        at += 1
    return at


@kernel
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
    return Cut((most - cap) / size, weights, int(kind == ACCELERATION), kind)


@kernel
def _bend_cut(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of the bend of segment `k` that the step from `q` leaves the most."""
    limits, root, box, start = within.limits, within.root, within.boxes[k], within.start
    dx, dy = step[k, 0], step[k, 1]
    ux, uy, length = q[k, 0] + dx, q[k, 1] + dy, q[k, 2] + step[k, 2]
    x0, y0 = start[k, 0], start[k, 1]
    bent, left = math.hypot(x0, y0), CUT * math.hypot(dx, dy)
    worst = _disc(root, k, (ux, uy), max(limits[k, MAX_BEND], bent), 0.0, left, BEND)
    curvature = limits[k, MAX_CURVATURE]
    if curvature < math.inf:
        cap = curvature * length + max(0.0, bent - curvature * start[k, 2])
        cut = _disc(root, k, (ux, uy), cap, curvature, left, CURVATURE)
        if cut.excess > worst.excess:
            worst = cut
    cap = box[BEND_CHANGE]
    cut = _disc(root, k, (ux - x0, uy - y0), (1.0 - ROOM) * cap, 0.0, ROOM * cap, BEND_RATE)
    if cut.excess > worst.excess:
        worst = cut
    cap, vx, vy = box[BEND_TURN], ux - x0 - box[BEFORE], uy - y0 - box[BEFORE + 1]
    cut = _disc(root, k, (vx, vy), (1.0 - ROOM) * cap, 0.0, ROOM * cap, ACCELERATION)
    return cut if cut.excess > worst.excess else worst


@kernel
def _cut_of(within: Limits, q: Array, step: Array, k: int) -> Cut:
    """The bound of segment `k` that the step from `q` leaves the most; its kind is -1 where it leaves none."""
    worst, stretch, box, l0 = _bend_cut(within, q, step, k), within.root[k, 8], within.boxes[k], within.start[k, 2]
    if not stretch > 0.0:
        return worst
    length, along = q[k, 2] + step[k, 2], (0.0, 0.0, 1.0 / stretch)
    least, most = min(within.limits[k, MIN_LENGTH], l0), max(within.limits[k, MAX_LENGTH], l0)
    shortest, longest = l0 - box[LENGTH_CHANGE], l0 + box[LENGTH_CHANGE]
    under, over = (max(least, shortest) - length) / stretch, (length - min(most, longest)) / stretch
    if under > max(LEFT, worst.excess):
        worst = Cut(under, scale(-1.0, along), 0, LENGTH if least >= shortest else LENGTH_RATE)
    if over > max(LEFT, worst.excess):
        worst = Cut(over, along, 0, LENGTH if most <= longest else LENGTH_RATE)
    off = length - l0 - box[BEFORE + 2]
    beyond = (abs(off) - box[LENGTH_TURN]) / stretch
    if beyond > max(LEFT, worst.excess):
        worst = Cut(beyond, scale(1.0 if off > 0.0 else -1.0, along), 1, ACCELERATION)
    return worst


@kernel
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


@kernel
def _put_within(problem: Problem, asked: Asked, tick: Tick, start: Array, k: int) -> None:
    """Put segment `k` of `tick.trial` within its limits and rates: by rounding, when the step has kept its bounds."""
    limits, box, q = problem.limits, asked.boxes[k], tick.trial
    x0, y0, l0, curvature = start[k, 0], start[k, 1], start[k, 2], limits[k, MAX_CURVATURE]
    bent = math.hypot(x0, y0)
    least = max(min(limits[k, MIN_LENGTH], l0), l0 - box[LENGTH_CHANGE])
    q[k, 2] = min(max(q[k, 2], least), max(limits[k, MAX_LENGTH], l0), l0 + box[LENGTH_CHANGE])
    cap, bend = max(limits[k, MAX_BEND], bent), math.hypot(q[k, 0], q[k, 1])
    if curvature < math.inf:
        cap = min(cap, curvature * q[k, 2] + max(0.0, bent - curvature * l0))
    if bend > cap:
        q[k, 0], q[k, 1] = q[k, 0] * cap / bend, q[k, 1] * cap / bend
    change = math.hypot(q[k, 0] - x0, q[k, 1] - y0)
    if change > box[BEND_CHANGE]:  # towards the start, where all of them hold: they are convex
        t = box[BEND_CHANGE] / change
        q[k, 0], q[k, 1], q[k, 2] = x0 + t * (q[k, 0] - x0), y0 + t * (q[k, 1] - y0), l0 + t * (q[k, 2] - l0)


@kernel
def _share_of_lines(asked: Asked, tick: Tick, start: Array) -> float:
    """Largest share, of the way from `tick.q` to `tick.trial`, that keeps the limits and rates of actuators."""
    n, t = tick.q.shape[0], 1.0
    for j in range(asked.lines.shape[0]):
        line = asked.lines[j]
        began = value = aim = 0.0
        for k in range(n):
            for i in range(3):
                weight = line[3 * k + i]
                began, value = began + weight * start[k, i], value + weight * tick.q[k, i]
                aim += weight * tick.trial[k, i]
        least = max(min(line[3 * n + LEAST], began), began - line[3 * n + CHANGE])
        most = min(max(line[3 * n + MOST], began), began + line[3 * n + CHANGE])
        if aim > most:
            t = min(t, max(0.0, (most - value) / (aim - value)))
        elif aim < least:
            t = min(t, max(0.0, (least - value) / (aim - value)))
    return t


@kernel
def take(problem: Problem, asked: Asked, tick: Tick, start: Array) -> None:
    """Fill `tick.trial` with where `tick.step` leads, within all limits and rates."""
    n = tick.q.shape[0]
    for k in range(n):
        for i in range(3):
            tick.trial[k, i] = tick.q[k, i] + tick.step[k, i]
        _put_within(problem, asked, tick, start, k)
    t = _share_of_lines(asked, tick, start)
    if t < 1.0:
        for k in range(n):
            for i in range(3):
                tick.trial[k, i] = tick.q[k, i] + t * (tick.trial[k, i] - tick.q[k, i])
