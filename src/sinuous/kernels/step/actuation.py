"""Limits of actuators: linear in the configuration, one or all segments before them.

Row j of `actuation` (p, 7): first and last segment, weights of bend_x, bend_y and length (3), low, high. `first ==
last`: a chamber along one segment. `first < last`: a tendon that runs through all segments up to its last, and sees the
sum of their coordinates; `first` is the same for all of these, 0 where no joint stands before the segments. Rows are in
the order of their last segment. Within these limits the configurations are a convex set.

Where the low and the high limit are the same, a value is held: what it leaves of single segments is in their limits
(`sinuous.model.coordinates`), and the rest stays a row here that binds in every step.

`aim` (n, 3), `home` (n, 3) are configurations, `step` (n, 3) is a motion.
"""

import math

from sinuous.kernels.body.rows import HARD, IDLE, Rows
from sinuous.kernels.chain.kinematics import shorten
from sinuous.kernels.compile import apart
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, dot, get_vec, mat_vec, put_vec, scale, sub, vec_mat
from sinuous.kernels.step.limits import free_root, project_segment
from sinuous.kernels.tables import FIRST_SEGMENT, HOME, LAST_SEGMENT, MAX_VALUE, MIN_VALUE, WEIGHTS

EQUALITY_ROUNDING = 1e-13
"""What a value that is held may be off by, relative to what it is the sum of."""

NO_SUMS = -1
"""In place of the segment from which on limits see sums: there is no limit."""

LEVELLINGS, SETTLINGS = 8, 60
"""Most rounds of projections on values that are held, and of these and limits of segments by turns."""


def runs_through(actuation: Array, j: int) -> bool:
    """Whether limit `j` sees the sum over several segments."""
    return bool(actuation[j, FIRST_SEGMENT] < actuation[j, LAST_SEGMENT])


def sums_from(actuation: Array) -> int:
    """The segment from which on limits may see sums: joints before it move no tendon. `NO_SUMS` without any limit."""
    first = NO_SUMS
    for j in range(actuation.shape[0]):
        if runs_through(actuation, j):
            return int(actuation[j, FIRST_SEGMENT])
        first = 0
    return first


def is_equality(actuation: Array, j: int) -> bool:
    """Whether limit `j` leaves one value."""
    return bool(actuation[j, MIN_VALUE] == actuation[j, MAX_VALUE])


def has_equalities(actuation: Array) -> bool:
    """Whether any limit leaves one value."""
    count = 0
    for j in range(actuation.shape[0]):
        count += int(is_equality(actuation, j))
    return count > 0


def _rounding(weights: Vec, total: Vec, value: float) -> float:
    """What a value may be off by, and count as the one that is left."""
    sizes = abs(weights[0]) + abs(weights[1]) + abs(weights[2] * total[2]) + abs(value)
    return EQUALITY_ROUNDING * sizes


def meet_held_values(limits: Array, actuation: Array, q: Array) -> bool:
    """Bring `q` to what limits with one value leave, by the least motion; says whether it is there.

    Row by row (Kaczmarz), within the planes of bends, but with no other limit of segments.
    """
    for _ in range(LEVELLINGS):
        there = True
        for j in range(actuation.shape[0]):
            if is_equality(actuation, j):
                weights, total, spread, last = (
                    get_vec(actuation, j, WEIGHTS),
                    ZERO,
                    0.0,
                    int(actuation[j, LAST_SEGMENT]),
                )
                for k in range(int(actuation[j, FIRST_SEGMENT]), last + 1):
                    seen = vec_mat(weights, free_root(limits, k))
                    spread += dot(seen, seen)
                    total = add(total, get_vec(q, k, 0))
                gap = actuation[j, MIN_VALUE] - dot(weights, total)
                there = there and abs(gap) <= _rounding(weights, total, actuation[j, MIN_VALUE])
                if spread > 0.0:
                    for k in range(int(actuation[j, FIRST_SEGMENT]), last + 1):
                        root = free_root(limits, k)
                        move = scale(gap / spread, mat_vec(root, vec_mat(weights, root)))
                        put_vec(q, k, 0, add(get_vec(q, k, 0), move))
        if there:
            return True
    return False


def approach_held_values(limits: Array, actuation: Array, q: Array) -> None:
    """Bring `q` within limits of segments and to what limits of actuators with one value leave, where that is near.

    Alternating projections (von Neumann); nothing where no limit has one value.
    """
    if has_equalities(actuation):
        _project_by_turns(limits, actuation, q)


@apart
def _project_by_turns(limits: Array, actuation: Array, q: Array) -> None:
    for _ in range(SETTLINGS):
        there = meet_held_values(limits, actuation, q)
        for k in range(q.shape[0]):
            own = get_vec(q, k, 0)
            kept = project_segment(limits, k, own[0], own[1], own[2])
            away = sub(kept, own)
            there = there and abs(away[0]) + abs(away[1]) + abs(away[2]) <= EQUALITY_ROUNDING * (1.0 + abs(own[2]))
            put_vec(q, k, 0, kept)
        if there:
            return


def admissible_step(actuation: Array, q: Array, aim: Array) -> float:
    """Largest t in [0, 1] for which `q + t (aim - q)` keeps all limits, when `q` does."""
    t = 1.0
    j, first = 0, sums_from(actuation)
    total, change = ZERO, ZERO
    for k in range(q.shape[0]):
        own = get_vec(q, k, 0)
        move = sub(get_vec(aim, k, 0), own)
        if k >= first:
            total, change = add(total, own), add(change, move)
        while j < actuation.shape[0] and actuation[j, LAST_SEGMENT] == k:
            weights = get_vec(actuation, j, WEIGHTS)
            if runs_through(actuation, j):
                value, slope = dot(weights, total), dot(weights, change)
            else:
                value, slope = dot(weights, own), dot(weights, move)
            if is_equality(actuation, j) and abs(slope) <= 2.0 * _rounding(weights, total, value):
                slope = 0.0
            elif value + t * slope > actuation[j, MAX_VALUE]:
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
    shorten(q, aim, (1.0 - 1e-12) * t)


def straighten(limits: Array, actuation: Array, q: Array, home: Array) -> None:
    """Bring `q` nearer to home until all limits of actuators are kept; `home` is scratch.

    Home is straight where segments may be so: every bend becomes smaller by the same factor.
    """
    if actuation.shape[0] == 0:
        return
    approach_held_values(limits, actuation, q)
    for k in range(q.shape[0]):
        x, y, length = get_vec(limits, k, HOME)
        put_vec(home, k, 0, (x, y, q[k, 2] if length < 0.0 else length))
    hold_back(actuation, home, q)


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


def bind_equalities(actuation: Array, q: Array, rows: Rows) -> None:
    """Turn the row of every limit that leaves one value into one that moves to it."""
    if has_equalities(actuation):
        _bind_equalities(actuation, q, rows)


@apart
def _bind_equalities(actuation: Array, q: Array, rows: Rows) -> None:
    j, first, total = 0, sums_from(actuation), ZERO
    for k in range(q.shape[0]):
        own = get_vec(q, k, 0)
        if k >= first:
            total = add(total, own)
        at = rows.start[k]
        while j < actuation.shape[0] and actuation[j, LAST_SEGMENT] == k:
            if is_equality(actuation, j):
                rows.kind[at] = HARD
                rows.value[at] = _slack(actuation, j, total if runs_through(actuation, j) else own)[0]
            at += 1
            j += 1


def bind(actuation: Array, q: Array, step: Array, rows: Rows) -> int:
    """Turn the row of every limit that the step would leave into one that moves up to it. Returns how many are new."""
    count = 0
    j, first = 0, sums_from(actuation)
    total, change = ZERO, ZERO
    for k in range(q.shape[0]):
        own, move = get_vec(q, k, 0), get_vec(step, k, 0)
        if k >= first:
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
