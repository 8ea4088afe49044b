"""The proof that the body does not run through itself during an interval of time.

Two places come nearer to each other by no more than the bends and stretches between them move one of them: a bend about
a place between moves it by at most the bend times its lever, the length of backbone from there, and the shorter of both
levers will do. So the gaps half-way through the interval, less what they may lose in half of it, bound the gaps at all
times; of pairs that do not concern each other then, those are looked at, too, that may at another time of the interval.
"""

import math

from sinuous.kernels.between.obstacles import Aim, Interval, wanted
from sinuous.kernels.between.sweep import (
    BEND_RATE,
    FRACTION,
    HALFWAY,
    LEAST,
    LENGTH_RATE,
    LOW,
    SEGMENT,
    STRETCHING,
    TURNING,
    WHEN,
    WHICH,
    Motion,
    Sweep,
    at_time,
    knot,
)
from sinuous.kernels.body import self_pieces
from sinuous.kernels.body.chords import arc_chord
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.self_pairs import ALONG, HALF_TURN, NO_LENGTH, TURNED, Shape, concern, least_of_run, survey
from sinuous.kernels.body.self_pieces import Pair, amount_between, closest, pair_of
from sinuous.kernels.body.self_proof import PAIR_LOOKS
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, add, norm, sub
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
    """Lower bound of the gaps of segment `k` with itself; infinite where it never comes back to itself."""
    radius, length = limits[k, RADIUS], max(qa[k, 2], qb[k, 2])
    bend = max(math.hypot(qa[k, 0], qa[k, 1]), math.hypot(qb[k, 0], qb[k, 1]))
    if radius == 0.0 or bend < HALF_TURN or length < math.pi * radius:
        return math.inf
    shortest = min(qa[k, 2], qb[k, 2])
    whole = arc_chord(bend / max(shortest, NO_LENGTH), shortest)
    return min(whole, arc_chord(_most_curved(qa, qb, k), math.pi * radius)) - 2.0 * radius


@kernel
def _lost(sweep: Sweep, interval: Interval, i: int, j: int) -> float:
    """How much nearer places of segments i < j come to each other in half of the interval, at most."""
    qa, qb, rates = sweep.q[interval.a], sweep.q[interval.b], sweep.rates
    total = 0.0
    for k in range(i, j + 1):
        total += max(qa[k, 2], qb[k, 2])
    before = lost = 0.0
    for k in range(i, j + 1):
        half = 0.5 * max(qa[k, 2], qb[k, 2])
        lost += rates[k, BEND_RATE] * min(before + half, total - before - half) + rates[k, LENGTH_RATE]
        before += 2.0 * half
    return 0.5 * interval.h * lost


@kernel
def _change(sweep: Sweep, column: int, i: int, j: int) -> float:
    """How much what a column of the spans says of segments i to j changes in the whole motion, at most."""
    before, own = (TURNING, BEND_RATE) if column == TURNED else (STRETCHING, LENGTH_RATE)
    return float(sweep.rates[j, before] + sweep.rates[j, own] - sweep.rates[i, before])


@kernel
def _loosened(sweep: Sweep, interval: Interval, pair: Pair, rounding: float) -> Pair:
    """The pair, as it has to be looked at half-way for all times of the interval."""
    needed = pair.needed + _lost(sweep, interval, pair.i, pair.j) + rounding
    enough = pair.enough - 0.5 * interval.h * _change(sweep, pair.column, pair.i, pair.j)
    return Pair(pair.i, pair.j, needed, pair.column, enough, pair.tightest)


@kernel
def _far_apart(shape: Shape, i: int, j: int) -> float:
    """Lower bound of the distance between places of segments i and j, from balls about them."""
    first, second = add(frame(shape.frames, i)[1], frame(shape.frames, i + 1)[1]), frame(shape.frames, j)[1]
    apart = 0.5 * norm(sub(first, add(second, frame(shape.frames, j + 1)[1])))
    return apart - 0.5 * float(shape.q[i, 2] + shape.q[j, 2])


@kernel
def _clear_pair(shape: Shape, sweep: Sweep, interval: Interval, pair: Pair, aim: Aim, seen: Array) -> int:
    """Prove that two segments do not touch each other during an interval."""
    loosened = _loosened(sweep, interval, pair, aim.rounding)
    if loosened.enough <= 0.0:
        return UNDECIDED
    # Pieces need not be finer than what the motion leaves open: halving the time is what helps then.
    finest = max(aim.finest, loosened.needed - pair.needed)
    look = self_pieces.Aim(wanted(aim, seen), 0.0, finest, True)
    low, gap, s, t, looks = closest(shape, loosened, look, math.inf)
    spend(sweep.clock, PAIR_LOOKS * looks)
    gap += loosened.needed - pair.needed
    if gap < seen[LEAST] and amount_between(shape, pair, pair.column, s, t) >= pair.enough:
        seen[LEAST], seen[WHEN], seen[SEGMENT] = gap, interval.begin + 0.5 * interval.h, pair.i
        seen[FRACTION], seen[WHICH] = s, pair.j
        if gap < 0.0:
            return TOUCHING
    if low > 0.0 and low >= wanted(aim, seen):
        seen[LOW] = min(seen[LOW], low)
        return CLEAR
    return UNDECIDED


@kernel
def _clear_apart(shape: Shape, sweep: Sweep, interval: Interval, i: int, j: int, aim: Aim, seen: Array) -> int:
    """The same for segments i < j; most of them are far from each other, or do not concern each other."""
    limits, spans, half = shape.limits, shape.spans, 0.5 * interval.h
    needed = limits[i, RADIUS] + limits[j, RADIUS]
    column, enough = concern(shape, i, j)
    if needed == 0.0 or spans[j + 1, column] - spans[i, column] < enough - half * _change(sweep, column, i, j):
        return CLEAR
    stretching = half * _change(sweep, ALONG, i, j)
    length = spans[j + 1, ALONG] - spans[i, ALONG] + stretching
    lost = half * 0.5 * _change(sweep, TURNED, i, j) * length + stretching
    sure = _far_apart(shape, i, j) - needed - lost - aim.rounding
    if sure > 0.0 and sure >= wanted(aim, seen):
        seen[LOW] = min(seen[LOW], sure)
        return CLEAR
    return _clear_pair(shape, sweep, interval, pair_of(shape, i, j), aim, seen)


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
def clear_of_itself(motion: Motion, sweep: Sweep, interval: Interval, aim: Aim, seen: Array) -> int:
    """Prove that the body does not run through itself during an interval; undecided pairs are left for its halves.

    The gaps that `passed_over` bounds are not among them. Returns the verdict, and keeps in `seen` (6,) what was found,
    `WHICH` the other segment.
    """
    limits, n, pairs, level = motion.limits, motion.limits.shape[0], sweep.pairs, interval.level
    at_time(motion.q0, motion.q1, interval.begin, sweep.q[interval.a])
    at_time(motion.q0, motion.q1, interval.begin + interval.h, sweep.q[interval.b])
    knot(motion, interval.begin + 0.5 * interval.h, sweep, HALFWAY)
    shape = Shape(limits, sweep.q[HALFWAY], sweep.frames[HALFWAY], sweep.spans)
    survey(shape)
    count = 0
    for e in range(sweep.left[level]):
        i, j = pairs[e] // n, pairs[e] % n
        if i == j:
            alone = _alone(limits, sweep.q[interval.a], sweep.q[interval.b], i) - aim.rounding
            verdict = CLEAR if alone > 0.0 and alone >= wanted(aim, seen) else UNDECIDED
            if verdict == CLEAR:
                seen[LOW] = min(seen[LOW], alone)
        else:
            verdict = _clear_apart(shape, sweep, interval, i, j, aim, seen)
        if verdict == TOUCHING and not aim.prefix:
            return TOUCHING
        if verdict != CLEAR:
            pairs[e], pairs[count] = pairs[count], pairs[e]
            count += 1
    sweep.left[level + 1] = count
    return CLEAR if count == 0 else UNDECIDED
