"""The proof that the body does not run through itself during an interval of time.

Whether two places may concern each other is asked at both ends of the interval: turns are convex in time. Most pairs of
segments are far from each other, or do not concern each other; `body.self_pieces` examines those that are left.

`qa` (n, 3) and `qb` (n, 3) are the first and the last configuration, `seen` (6,) what is known of clearances of the
body from itself.
"""

import math

from sinuous.kernels.body import self_pieces
from sinuous.kernels.body.chords import arc_chord
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.self_pairs import (
    HALF_TURN,
    NO_LENGTH,
    QUARTER_TURN,
    TURNED,
    Shape,
    begin_of,
    end_of,
    enough_between,
    least_of_run,
    may_touch,
    meets_itself,
    middle_of,
    own_gap,
)
from sinuous.kernels.body.self_pieces import Swept, nearest_places, pair_of
from sinuous.kernels.body.self_proof import PAIR_WORK
from sinuous.kernels.certificate.obstacles import Accuracy, good_enough
from sinuous.kernels.certificate.sweep import LEAST_SEEN, PROVED_BOUND, Sweep, note_least
from sinuous.kernels.chain.rates import BEND_RATE, LENGTH_RATE, TURNING
from sinuous.kernels.clock import spend
from sinuous.kernels.maths.vectors import Array, norm, sub
from sinuous.kernels.tables import RIGID, SELF_RADIUS


def _most_curved(qa: Array, qb: Array, k: int) -> float:
    """Largest curvature of segment `k` on its way: at an end, for bends are convex in time, and lengths linear."""
    first = math.hypot(qa[k, 0], qa[k, 1]) / max(qa[k, 2], NO_LENGTH)
    return max(first, math.hypot(qb[k, 0], qb[k, 1]) / max(qb[k, 2], NO_LENGTH))


def passed_over(limits: Array, qa: Array, qb: Array) -> float:
    """Lower bound of the gaps of pairs of one run that turn by less than pi, at all times; see `self_pairs`."""
    n = limits.shape[0]
    low, length, curvature = math.inf, 0.0, 0.0
    for k in range(n):
        if limits[k, RIGID] == 0.0:
            length += max(qa[k, 2], qb[k, 2])
            curvature = max(curvature, _most_curved(qa, qb, k))
        if k == n - 1 or limits[k + 1, SELF_RADIUS] != limits[k, SELF_RADIUS] or limits[k, RIGID] != 0.0:
            low = min(low, least_of_run(limits[k, SELF_RADIUS], length, curvature))
            length = curvature = 0.0
    return low


def cannot_meet(limits: Array, qa: Array, qb: Array) -> bool:
    """Whether the body turns so little from base to tip, at all times, that no two places of it are examined."""
    first = second = 0.0
    enough = HALF_TURN
    for k in range(limits.shape[0]):
        if limits[k, RIGID] != 0.0:
            return False
        if limits[k, SELF_RADIUS] != limits[0, SELF_RADIUS]:
            enough = QUARTER_TURN
        first += math.hypot(qa[k, 0], qa[k, 1])
        second += math.hypot(qb[k, 0], qb[k, 1])
    return max(first, second) < enough


def _alone(limits: Array, qa: Array, qb: Array, k: int) -> float:
    """Lower bound of the gaps of segment `k` with itself; infinite where it never comes back to itself.

    Those of places that turn by less than half a turn are bounded by `passed_over`.
    """
    radius, length = limits[k, SELF_RADIUS], max(qa[k, 2], qb[k, 2])
    bend = max(math.hypot(qa[k, 0], qa[k, 1]), math.hypot(qb[k, 0], qb[k, 1]))
    if radius <= 0.0 or bend < HALF_TURN or length < math.pi * radius:
        return math.inf
    shortest = min(qa[k, 2], qb[k, 2])
    return arc_chord(bend / max(shortest, NO_LENGTH), shortest) - 2.0 * radius


def _see_alone(swept: Swept, i: int, seen: Array) -> bool:
    """Keep the gap of segment `i` with itself at the ends of an interval; say whether it is an overlap."""
    least = math.inf
    for at_end in range(2):
        shape = swept.last if at_end else swept.first
        if meets_itself(shape, i):
            gap, t = own_gap(shape, i)
            least = min(least, gap)
            note_least(seen, gap, swept.begin + at_end * swept.h, i, t, i)
    return least < 0.0


def _apart(swept: Swept, i: int, j: int) -> float:
    """Lower bound of the distance of segments i < j during an interval, from balls about them at both ends of it.

    A bend moves what is half the length between away from what is the other half, at most.
    """
    first, last, rates = swept.first, swept.last, swept.rates
    stretching = 0.0
    for k in range(i, j + 1):
        stretching += rates[k, LENGTH_RATE]
    bending = rates[j, TURNING] + rates[j, BEND_RATE] - rates[i, TURNING]
    length = max(end_of(first, j) - begin_of(first, i), end_of(last, j) - begin_of(last, i))
    lost = 0.5 * swept.h * (0.5 * bending * length + stretching)
    return 0.5 * (_balls(first, i, j) + _balls(last, i, j)) - lost


def _balls(shape: Shape, i: int, j: int) -> float:
    """Lower bound of the distance between places of segments i and j, from balls about them."""
    middles = norm(sub(middle_of(shape, i), middle_of(shape, j)))
    return middles - 0.5 * float(shape.q[i, 2] + shape.q[j, 2])


def _never_concern(swept: Swept, i: int, j: int) -> bool:
    """Whether no two places of segments i < j concern each other during an interval."""
    first, last = swept.first, swept.last
    if may_touch(first.limits, i, j):
        return True
    most = max(first.spans[j + 1, TURNED] - first.spans[i, TURNED], last.spans[j + 1, TURNED] - last.spans[i, TURNED])
    needed = first.limits[i, SELF_RADIUS] + first.limits[j, SELF_RADIUS]
    return bool(most < enough_between(first, i, j) or needed == 0.0)


def list_pairs(limits: Array, sweep: Sweep) -> None:
    """List all pairs of segments, and of links those that concern each other."""
    n, count = sweep.q.shape[1], 0
    for i in range(n):
        for j in range(i, n):
            if limits[i, RIGID] == 0.0 or not (i == j or may_touch(limits, i, j)):
                sweep.pairs[count] = i * n + j
                count += 1
    sweep.left[0] = count


def clear_of_itself(swept: Swept, sweep: Sweep, level: int, accuracy: Accuracy, seen: Array) -> int:
    """Prove that the body does not run through itself during an interval; undecided pairs are left for its halves.

    The gaps that `passed_over` bounds are not among them. `level`: halvings of time. Returns the verdict, and keeps in
    `seen` (6,) what was found, `WHICH` the other segment. TOUCHING ends the work: nothing proves the interval. The pair
    that touches comes first in its halves, where it decides, too.
    """
    n, pairs, count, most = swept.first.q.shape[0], sweep.pairs, 0, sweep.left[level]
    worth = 0.0 if accuracy.slack >= 1.0 else math.inf
    own = self_pieces.GapAccuracy(
        0.0, worth, 0.0, accuracy.slack, accuracy.finest, accuracy.finest, accuracy.rounding, True
    )
    for e in range(most):
        i, j = pairs[e] // n, pairs[e] % n
        verdict = CLEAR
        if i == j:
            sure = _alone(swept.first.limits, swept.first.q, swept.last.q, i) - accuracy.rounding
            verdict = TOUCHING if _see_alone(swept, i, seen) else _accept_bound(sure, accuracy, seen)
        elif not _never_concern(swept, i, j):
            needed = swept.first.limits[i, SELF_RADIUS] + swept.first.limits[j, SELF_RADIUS]
            verdict = _accept_bound(_apart(swept, i, j) - needed - accuracy.rounding, accuracy, seen)
            if verdict != CLEAR:
                sure, gap, s, _, when, evaluations = nearest_places(swept, pair_of(swept, i, j), own, seen[LEAST_SEEN])
                note_least(seen, gap, when, i, s, j)
                verdict = TOUCHING if gap < 0.0 else _accept_bound(sure, accuracy, seen)
                spend(sweep.clock, PAIR_WORK * evaluations)
        if verdict == TOUCHING:
            pairs[e], pairs[0] = pairs[0], pairs[e]
            sweep.left[level + 1] = most
            return TOUCHING
        if verdict != CLEAR:
            pairs[e], pairs[count] = pairs[count], pairs[e]
            count += 1
    sweep.left[level + 1] = count
    return CLEAR if count == 0 else UNDECIDED


def _accept_bound(low: float, accuracy: Accuracy, seen: Array) -> int:
    """Keep a lower bound of gaps, if it is as good as it has to be."""
    if not good_enough(low, accuracy, seen):
        return UNDECIDED
    seen[PROVED_BOUND] = min(seen[PROVED_BOUND], low)
    return CLEAR
