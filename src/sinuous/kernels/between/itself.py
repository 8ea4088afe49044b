"""The proof that the body does not run through itself during an interval of time.

Whether two places concern each other is asked at both ends of the interval: turns are convex in time, lengths linear.
Most pairs of segments are far from each other, or do not concern each other; `pairs` looks at those that are left.
"""

import math

from sinuous.kernels.between.obstacles import Aim, wanted
from sinuous.kernels.between.pairs import Course, apart, clear_couple, couple_of, never_concern
from sinuous.kernels.between.sweep import FRACTION, LEAST, LOW, SEGMENT, WHEN, WHICH, Sweep
from sinuous.kernels.body.chords import arc_chord
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.self_pairs import HALF_TURN, NO_LENGTH, least_of_run, meets_itself, own_gap
from sinuous.kernels.body.self_proof import PAIR_LOOKS
from sinuous.kernels.clock import spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.tables import RADIUS


@kernel
def _most_curved(qa: Array, qb: Array, k: int) -> float:
    """Largest curvature of segment `k` on its way: at an end, for bends are convex in time, and lengths linear."""
    first = math.hypot(qa[k, 0], qa[k, 1]) / max(qa[k, 2], NO_LENGTH)
    return max(first, math.hypot(qb[k, 0], qb[k, 1]) / max(qb[k, 2], NO_LENGTH))


@kernel
def passed_over(limits: Array, qa: Array, qb: Array) -> float:
    """Lower bound of the gaps of pairs of one run that turn by less than pi, at all times; see `self_pairs`."""
    n = limits.shape[0]
    low, length, curvature = math.inf, 0.0, 0.0
    for k in range(n):
        length += max(qa[k, 2], qb[k, 2])
        curvature = max(curvature, _most_curved(qa, qb, k))
        if k == n - 1 or limits[k + 1, RADIUS] != limits[k, RADIUS]:
            low = min(low, least_of_run(limits[k, RADIUS], length, curvature))
            length = curvature = 0.0
    return low


@kernel
def cannot_meet(limits: Array, qa: Array, qb: Array) -> bool:
    """Whether the body is of one radius, and turns by less than pi from base to tip at all times."""
    first = second = 0.0
    for k in range(limits.shape[0]):
        if limits[k, RADIUS] != limits[0, RADIUS]:
            return False
        first += math.hypot(qa[k, 0], qa[k, 1])
        second += math.hypot(qb[k, 0], qb[k, 1])
    return max(first, second) < HALF_TURN


@kernel
def _alone(limits: Array, qa: Array, qb: Array, k: int) -> float:
    """Lower bound of the gaps of segment `k` with itself; infinite where it never comes back to itself.

    Those of places that turn by less than half a turn are bounded by `passed_over`.
    """
    radius, length = limits[k, RADIUS], max(qa[k, 2], qb[k, 2])
    bend = max(math.hypot(qa[k, 0], qa[k, 1]), math.hypot(qb[k, 0], qb[k, 1]))
    if radius == 0.0 or bend < HALF_TURN or length < math.pi * radius:
        return math.inf
    shortest = min(qa[k, 2], qb[k, 2])
    return arc_chord(bend / max(shortest, NO_LENGTH), shortest) - 2.0 * radius


@kernel
def _see_alone(course: Course, i: int, seen: Array) -> bool:
    """Keep the gap of segment `i` with itself at the ends of an interval; say whether it is an overlap."""
    least = math.inf
    for at_end in range(2):
        shape = course.last if at_end else course.first
        if meets_itself(shape, i):
            gap, t = own_gap(shape, i)
            least = min(least, gap)
            if gap < seen[LEAST]:
                seen[LEAST], seen[WHEN], seen[SEGMENT] = gap, course.begin + at_end * course.h, i
                seen[FRACTION], seen[WHICH] = t, i
    return least < 0.0


@kernel
def list_pairs(sweep: Sweep) -> None:
    """List all pairs of segments."""
    n, count = sweep.q.shape[1], 0
    for i in range(n):
        for j in range(i, n):
            sweep.pairs[count] = i * n + j
            count += 1
    sweep.left[0] = count


@kernel
def clear_of_itself(course: Course, sweep: Sweep, level: int, aim: Aim, seen: Array) -> int:
    """Prove that the body does not run through itself during an interval; undecided pairs are left for its halves.

    The gaps that `passed_over` bounds are not among them. `level`: halvings of time. Returns the verdict, and keeps in
    `seen` (6,) what was found, `WHICH` the other segment. TOUCHING ends the work: nothing proves the interval. The pair
    that touches comes first in its halves, where it decides, too.
    """
    n, pairs, count, most = course.first.q.shape[0], sweep.pairs, 0, sweep.left[level]
    for e in range(most):
        i, j = pairs[e] // n, pairs[e] % n
        verdict = CLEAR
        if i == j:
            sure = _alone(course.first.limits, course.first.q, course.last.q, i) - aim.rounding
            verdict = TOUCHING if _see_alone(course, i, seen) else _judge(sure, aim, seen)
        elif not never_concern(course, i, j):
            needed = course.first.limits[i, RADIUS] + course.first.limits[j, RADIUS]
            verdict = _judge(apart(course, i, j) - needed - aim.rounding, aim, seen)
            if verdict != CLEAR:
                verdict, looks = clear_couple(course, couple_of(course, i, j), aim, seen)
                spend(sweep.clock, PAIR_LOOKS * looks)
        if verdict == TOUCHING:
            pairs[e], pairs[0] = pairs[0], pairs[e]
            sweep.left[level + 1] = most
            return TOUCHING
        if verdict != CLEAR:
            pairs[e], pairs[count] = pairs[count], pairs[e]
            count += 1
    sweep.left[level + 1] = count
    return CLEAR if count == 0 else UNDECIDED


@kernel
def _judge(low: float, aim: Aim, seen: Array) -> int:
    """Keep a lower bound of gaps, if it is as good as it has to be."""
    if not (low > 0.0 and low >= wanted(aim, seen)):
        return UNDECIDED
    seen[LOW] = min(seen[LOW], low)
    return CLEAR
