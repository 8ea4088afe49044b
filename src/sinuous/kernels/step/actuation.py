"""Limits of actuators: linear in the configuration, one or all segments before them.

Row j of `actuation` (p, 7): first and last segment, weights of bend_x, bend_y and length (3), low, high. `first ==
last`: a chamber along one segment. `first == 0`: a tendon that runs through all segments up to its last, and sees the
sum of their coordinates. Rows are in the order of their last segment. Within these limits the configurations are a
convex set.
"""

import math

from sinuous.kernels.body.rows import HARD, IDLE, Rows
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, dot, get_vec, put_vec, scale, sub
from sinuous.kernels.tables import LAST_SEGMENT, MAX_VALUE, MIN_VALUE, WEIGHTS


def runs_through(actuation: Array, j: int) -> bool:
    """Whether limit `j` sees the sum over several segments."""
    return bool(actuation[j, 0] < actuation[j, LAST_SEGMENT])


def admissible_step(actuation: Array, q: Array, aim: Array) -> float:
    """Largest t in [0, 1] for which `q + t (aim - q)` keeps all limits, when `q` does."""
    t = 1.0
    j = 0
    total, change = ZERO, ZERO
    for k in range(q.shape[0]):
        own = get_vec(q, k, 0)
        move = sub(get_vec(aim, k, 0), own)
        total, change = add(total, own), add(change, move)
        while j < actuation.shape[0] and actuation[j, LAST_SEGMENT] == k:
            weights = get_vec(actuation, j, WEIGHTS)
            if runs_through(actuation, j):
                value, slope = dot(weights, total), dot(weights, change)
            else:
                value, slope = dot(weights, own), dot(weights, move)
            if value + t * slope > actuation[j, MAX_VALUE]:
                t = max(0.0, (actuation[j, MAX_VALUE] - value) / slope) if slope > 0.0 else 0.0
            elif value + t * slope < actuation[j, MIN_VALUE]:
                t = max(0.0, (actuation[j, MIN_VALUE] - value) / slope) if slope < 0.0 else 0.0
            j += 1
    return t


def hold_back(actuation: Array, q: Array, aim: Array) -> None:
    """Shorten the motion from `q` to `aim` so that `aim` keeps all limits."""
    if actuation.shape[0] == 0:
        return
    t = admissible_step(actuation, q, aim)
    if t >= 1.0:
        return
    t *= 1.0 - 1e-12
    for k in range(q.shape[0]):
        own = get_vec(q, k, 0)
        put_vec(aim, k, 0, add(own, scale(t, sub(get_vec(aim, k, 0), own))))


def straighten(actuation: Array, q: Array, straight: Array) -> None:
    """Make every bend of `q` smaller by the same factor until all limits are kept; `straight` is scratch."""
    if actuation.shape[0] == 0:
        return
    for k in range(q.shape[0]):
        put_vec(straight, k, 0, (0.0, 0.0, q[k, 2]))
    hold_back(actuation, straight, q)


def add_rows(actuation: Array, k: int, first: int, rows: Rows, at: int) -> tuple[int, int]:
    """Reserve an idle row for every limit that ends at segment `k`; returns the next limit and the next free row."""
    j = first
    while j < actuation.shape[0] and actuation[j, LAST_SEGMENT] == k:
        weights = get_vec(actuation, j, WEIGHTS)
        through = runs_through(actuation, j)
        rows.kind[at] = IDLE
        put_vec(rows.twist, at, 0, ZERO)
        put_vec(rows.twist, at, 3, ZERO)
        put_vec(rows.inner, at, 0, ZERO if through else weights)
        put_vec(rows.total, at, 0, weights if through else ZERO)
        rows.value[at] = 0.0
        at += 1
        j += 1
    return j, at


def bind(actuation: Array, q: Array, step: Array, rows: Rows) -> int:
    """Turn the row of every limit that the step would leave into one that moves up to it. Returns how many are new."""
    count = 0
    j = 0
    total, change = ZERO, ZERO
    for k in range(q.shape[0]):
        own, move = get_vec(q, k, 0), get_vec(step, k, 0)
        total, change = add(total, own), add(change, move)
        at = rows.start[k]
        while j < actuation.shape[0] and actuation[j, LAST_SEGMENT] == k:
            if rows.kind[at] == IDLE:
                left = _slack(actuation, j, total if runs_through(actuation, j) else own)
                weights = get_vec(actuation, j, WEIGHTS)
                wanted = dot(weights, change if runs_through(actuation, j) else move)
                slack = 1e-9 * (abs(left[0]) + abs(left[1])) if math.isfinite(left[0] + left[1]) else 1e-12
                if wanted > left[1] + slack or wanted < left[0] - slack:
                    rows.kind[at] = HARD
                    rows.value[at] = left[1] if wanted > left[1] else left[0]
                    count += 1
            at += 1
            j += 1
    return count


def _slack(actuation: Array, j: int, at: Vec) -> tuple[float, float]:
    value = dot(get_vec(actuation, j, WEIGHTS), at)
    return actuation[j, MIN_VALUE] - value, actuation[j, MAX_VALUE] - value


def release(rows: Rows) -> None:
    """Leave out the rows of all limits."""
    for i in range(rows.start[rows.start.shape[0] - 1]):
        if rows.kind[i] == HARD:
            rows.kind[i] = IDLE
