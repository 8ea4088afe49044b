"""The proof that the body is clear of obstacles and of itself all the way from one configuration to another.

The motion is linear in q. All limits are convex in q: what holds at both ends holds all the way. Time is halved until
each interval is decided: for obstacles see `obstacles`, for those that move `drift`, for the body itself see
`self_proof`.

`seen` (2, 6) is what is known of clearances from obstacles and from the body itself, or one row of that (6,), see
`sweep`.
"""

import math

from sinuous.kernels.body.pieces import Scratch, following
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED, prove
from sinuous.kernels.body.self_pairs import Shape, survey
from sinuous.kernels.body.self_pieces import Swept
from sinuous.kernels.body.self_proof import prove_self
from sinuous.kernels.certificate import sweep as w
from sinuous.kernels.certificate.drift import measure_paces, place_obstacles
from sinuous.kernels.certificate.obstacles import Accuracy, Interval, clear_segment, narrow_segment
from sinuous.kernels.certificate.self_proof import cannot_meet, clear_of_itself, list_pairs, passed_over
from sinuous.kernels.certificate.sweep import Motion, Sweep, knot
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.chain.rates import measure_rates
from sinuous.kernels.clock import SEGMENT_WORK, late, spend
from sinuous.kernels.compile import shared
from sinuous.kernels.maths.vectors import Array, norm
from sinuous.kernels.tables import RADIUS, SELF_RADIUS, TAIL_LENGTH

MOTION_ROUNDING = 1e-12
"""What arithmetic may be wrong by, relative to how far the body is from the origin of the world."""

CONFIGURATION_SLACK = 0.1
"""Slack of the proof of a single configuration."""


def _note(seen: Array, verdict: int, gap: float, t: float, k: int, s: float, which: int) -> None:
    """Keep the clearance of a configuration, or the most that it can be where `gap` is a lower bound, if it is less."""
    most = gap / (1.0 - CONFIGURATION_SLACK) if verdict == CLEAR else gap
    w.note_least(seen, most, t, k, s, which)


def _prove_at(motion: Motion, t: float, sweep: Sweep, accuracy: Accuracy, seen: Array) -> int:
    """Verdict about the configuration at time t."""
    knot(motion, t, sweep, w.HALFWAY)
    place_obstacles(motion, t, sweep)
    q, frames = sweep.q[w.HALFWAY], sweep.frames[w.HALFWAY]
    verdict = CLEAR
    if motion.scene.table.shape[0] > 0:
        among = sweep.among
        scratch = Scratch(among, sweep.clock)
        verdict, gap, k, s, which = prove(
            motion.limits, q, frames, motion.scene, accuracy.mount, CONFIGURATION_SLACK, accuracy.finest, scratch
        )
        _note(seen[0], verdict, gap, t, k, s, which)
    if motion.avoids_itself and verdict == CLEAR:
        verdict, gap, place = prove_self(
            Shape(motion.limits, q, frames, sweep.spans[w.HALFWAY]), accuracy.finest, sweep.clock
        )
        _note(seen[1], verdict, gap, t, place[0], place[1], place[2])
    return verdict


def _touches_later(motion: Motion, begin: float, travel: float, sweep: Sweep, accuracy: Accuracy, seen: Array) -> bool:
    """Whether the body is seen to touch something some time after `begin`, up to which it comes ever closer to it."""
    ahead = accuracy.finest / travel
    while not late(sweep.clock):
        ahead = min(2.0 * ahead, 1.0 - begin)
        if _prove_at(motion, begin + ahead, sweep, accuracy, seen) == TOUCHING:
            return True
        if begin + ahead >= 1.0:
            return False
    return False


def list_obstacles(limits: Array, sweep: Sweep) -> None:
    """Let every segment examine all obstacles that it can reach; what has no body examines none."""
    for k in range(sweep.reached.shape[0]):
        sweep.counts[0, k] = sweep.reached[k] if limits[k, RADIUS] >= 0.0 else 0
        for e in range(sweep.counts[0, k]):
            sweep.near[k, e] = sweep.reach[k, e]


def forget(seen: Array) -> None:
    """Know nothing of clearances."""
    for row in range(2):
        seen[row, w.PROVED_BOUND] = seen[row, w.LEAST_SEEN] = math.inf
        seen[row, w.WHEN], seen[row, w.SEGMENT], seen[row, w.FRACTION], seen[row, w.WHICH] = 0.0, -1.0, 0.0, -1.0


def narrow_obstacles(motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array) -> None:
    """Leave to every segment only the obstacles that it may touch some time in the motion, none of which moves."""
    list_obstacles(motion.limits, sweep)
    measure_rates(motion.limits, motion.q0, motion.q1, sweep.rates)
    knot(motion, 0.0, sweep, 0)
    knot(motion, 1.0, sweep, 1)
    for k in range(motion.q0.shape[0]):
        narrow_segment(motion, sweep, Interval(0, 0.0, 1.0, 0, 1), k, accuracy, seen[0])


def touches_at(motion: Motion, t: float, sweep: Sweep, accuracy: Accuracy, seen: Array) -> bool:
    """Whether the body is seen to touch something at time t, among the obstacles that `narrow_obstacles` left."""
    forget(seen)  # what overlaps less than something before would not be seen
    return bool(touches_too(motion, t, sweep, accuracy, seen))


def touches_too(motion: Motion, t: float, sweep: Sweep, accuracy: Accuracy, seen: Array) -> bool:
    """The same after times at which nothing touched: `seen` has the least of all of them."""
    knot(motion, t, sweep, 0)
    for k in range(motion.q0.shape[0] - 1, -1, -1):
        if clear_segment(motion, sweep, Interval(1, t, 0.0, 0, 0), k, accuracy, seen[0]) == TOUCHING:
            return True
    if not motion.avoids_itself:
        return False
    shape = Shape(motion.limits, sweep.q[0], sweep.frames[0], sweep.spans[0])
    verdict, gap, place = prove_self(shape, accuracy.finest, sweep.clock)
    _note(seen[1], verdict, gap, t, place[0], place[1], place[2])
    return bool(verdict == TOUCHING)


def _clear_of_obstacles(
    motion: Motion, travel: float, sweep: Sweep, accuracy: Accuracy, seen: Array
) -> tuple[int, float]:
    """Verdict about obstacles, and until when everything is clear; `travel`: how far anything comes nearer, at most."""
    n = motion.q0.shape[0]
    list_obstacles(motion.limits, sweep)
    a, b = 0, 1
    knot(motion, 0.0, sweep, a)
    level = piece = 0
    while piece < 1 << level:
        h = 1.0 / (1 << level)
        interval = Interval(level, piece * h, h, a, b)
        knot(motion, (piece + 1) * h, sweep, b)
        place_obstacles(motion, interval.begin + 0.5 * h, sweep)
        if spend(sweep.clock, SEGMENT_WORK * n + motion.drifts.shape[0]):
            return UNDECIDED, interval.begin
        undecided = False
        for k in range(n - 1, -1, -1):
            verdict = clear_segment(motion, sweep, interval, k, accuracy, seen)
            undecided = undecided or verdict != CLEAR
            if verdict == TOUCHING:
                if not accuracy.prefix:
                    return TOUCHING, interval.begin
                for j in range(k):  # these are examined when time is halved
                    sweep.counts[level + 1, j] = sweep.counts[level, j]
                break
        if not undecided:
            level, piece = following(level, piece)
            a, b = b, a
        elif h * travel < accuracy.finest or level == w.TIME_LEVELS:
            return UNDECIDED, interval.begin
        else:
            level, piece = level + 1, 2 * piece
    return CLEAR, 1.0


def _shape(motion: Motion, t: float, sweep: Sweep, at: int) -> Shape:
    """The shape at time t, in a place of the sweep."""
    knot(motion, t, sweep, at)
    shape = Shape(motion.limits, sweep.q[at], sweep.frames[at], sweep.spans[at])
    survey(shape)
    return shape


def _clear_of_itself(
    motion: Motion, travel: float, end: float, sweep: Sweep, accuracy: Accuracy, seen: Array
) -> tuple[int, float]:
    """Verdict about the body and itself until the time `end`, and until when everything is clear."""
    seen[w.PROVED_BOUND] = passed_over(motion.limits, motion.q0, motion.q1) - accuracy.rounding
    if not seen[w.PROVED_BOUND] > 0.0:
        return UNDECIDED, 0.0
    if cannot_meet(motion.limits, motion.q0, motion.q1):
        return CLEAR, 1.0
    list_pairs(motion.limits, sweep)
    a, b = 0, 1
    first = _shape(motion, 0.0, sweep, a)
    level = piece = 0
    while piece < 1 << level:
        h = 1.0 / (1 << level)
        begin = piece * h
        if begin >= end:
            return CLEAR, end
        last = _shape(motion, begin + h, sweep, b)
        verdict = clear_of_itself(Swept(first, last, sweep.rates, begin, h), sweep, level, accuracy, seen)
        if spend(sweep.clock, SEGMENT_WORK * motion.q0.shape[0]):
            return UNDECIDED, begin
        if verdict == CLEAR:
            level, piece = following(level, piece)
            first, a, b = last, b, a
        elif (verdict == TOUCHING and not accuracy.prefix) or h * travel < accuracy.finest or level == w.TIME_LEVELS:
            return verdict, begin
        else:
            level, piece = level + 1, 2 * piece
    return CLEAR, 1.0


def _thickest(limits: Array) -> float:
    """Largest radius of a body, whatever it has to be free of."""
    radius = 0.0
    for k in range(limits.shape[0]):
        radius = max(radius, limits[k, RADIUS], limits[k, SELF_RADIUS])
    return radius


def _measure(motion: Motion, sweep: Sweep, accuracy: Accuracy) -> tuple[Accuracy, float]:
    """The aim with what arithmetic may be wrong by, and how far anything comes nearer in the motion, at most."""
    travel = measure_rates(motion.limits, motion.q0, motion.q1, sweep.rates)
    base, reach = frame(sweep.frames[0], 0)[1], 0.0
    for k in range(motion.q0.shape[0]):
        reach += max(motion.q0[k, 2], motion.q1[k, 2]) + motion.limits[k, TAIL_LENGTH]
    nearing, far = measure_paces(motion, base, reach + _thickest(motion.limits), sweep)
    rounding = MOTION_ROUNDING * (norm(base) + reach + far)
    return Accuracy(accuracy.slack, accuracy.finest, rounding, accuracy.mount, accuracy.prefix), travel + nearing


def bound_again(motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array, row: int) -> bool:
    """Bound again, by what `seen` (2, 6) has, how clear a motion is of obstacles (row 0) or of the body itself (row 1).

    The other row is left as it is. The motion is proved clear; returns whether that could be bounded again in time.
    """
    own, travel = _measure(motion, sweep, accuracy)
    seen[row, w.PROVED_BOUND] = math.inf
    if row == 0:
        return bool(_clear_of_obstacles(motion, travel, sweep, own, seen[0])[0] == CLEAR)
    return bool(_clear_of_itself(motion, travel, 1.0, sweep, own, seen[1])[0] == CLEAR)


def certify(motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array) -> tuple[int, float]:
    """Prove a motion clear, or find where it is not.

    Returns the verdict (CLEAR, TOUCHING, UNDECIDED), and until when, of 0 to 1, everything is proved clear. Fills
    `seen` (2, 6), a row about obstacles and one about the body itself: with CLEAR their lower bounds hold for all times
    (infinite: there is nothing to be clear of); also the least that was seen, and where. When the time of the clock is
    over, the verdict is UNDECIDED. The `rounding` of `accuracy` is found here.
    """
    forget(seen)
    return certify_again(motion, sweep, accuracy, seen)


def certify_from(
    motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array, clear: float, apart: float
) -> tuple[int, float]:
    """The same where both ends are proved to be so far from obstacles and from the body itself.

    Then no configuration has to be examined to know what bounds are worth having: that is most of a short motion.
    """
    forget(seen)
    seen[0, w.LEAST_SEEN], seen[1, w.LEAST_SEEN] = clear, apart
    return _prove_all(motion, sweep, accuracy, seen, False)


def certify_again(motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array) -> tuple[int, float]:
    """The same where `seen` has the least that was seen of this motion before: bounds are as tight as that wants it.

    Whoever finds the least on the way proves everything before it more tightly than is worth while.
    """
    return _prove_all(motion, sweep, accuracy, seen, True)


@shared
def _prove_all(motion: Motion, sweep: Sweep, accuracy: Accuracy, seen: Array, first_too: bool) -> tuple[int, float]:
    """The same; `first_too`: whether the first configuration is examined, where tight bounds are wanted."""
    seen[0, w.PROVED_BOUND] = seen[1, w.PROVED_BOUND] = math.inf
    own, travel = _measure(motion, sweep, accuracy)
    solid = motion.avoids_itself and _thickest(motion.limits) > 0.0
    unknown = (motion.scene.table.shape[0] > 0 and seen[0, w.LEAST_SEEN] == math.inf) or (
        solid and seen[1, w.LEAST_SEEN] == math.inf
    )
    if (
        first_too and own.slack < 1.0 and unknown
    ):  # then a bound has to be known from the beginning that is worth having
        verdict = _prove_at(motion, 0.0, sweep, own, seen)
        if verdict != CLEAR:
            return verdict, 0.0
    verdict, until = CLEAR, 1.0
    if motion.scene.table.shape[0] > 0:
        verdict, until = _clear_of_obstacles(motion, travel, sweep, own, seen[0])
    if solid and (verdict == CLEAR or (own.prefix and until > 0.0)):
        other, proved = _clear_of_itself(motion, travel, until, sweep, own, seen[1])
        if verdict == CLEAR or (other != CLEAR and proved < until):
            verdict, until = other, proved
    if (
        verdict == UNDECIDED
        and not own.prefix
        and travel > 0.0
        and _touches_later(motion, until, travel, sweep, own, seen)
    ):
        verdict = TOUCHING
    return verdict, until
