"""The motion linear in q from one configuration to another, and what a proof of it works on."""

import math
from collections import namedtuple

from sinuous.kernels.body.pieces import MANY
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.kinematics import forward, interpolate, put_base
from sinuous.kernels.chain.rates import MOTION_RATES_WIDTH
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.tables import MANY_OBSTACLES

TIME_LEVELS = 44
"""How often time may be halved."""

PROVED_BOUND, LEAST_SEEN, WHEN, SEGMENT, FRACTION, WHICH = range(6)
"""What is known of clearances, `seen`: the lower bound of what is proved so far; the least that was seen, and where: at
which time, on which segment, at which fraction of it, and to which obstacle or other segment."""

CLEARANCES_WIDTH = 6

PACE_WIDTH, DRIFT_WIDTH, BALL_WIDTH = 5, 31, 4
"""Numbers of the pace of an obstacle, and of its drift: see `drift`; and of a ball, see `obstacles.measure_balls`."""

KNOTS, HALFWAY = 3, 2
"""Configurations at hand: where an interval begins, where it ends, and the one half-way."""

Motion = namedtuple("Motion", ["limits", "q0", "q1", "scene", "avoids_itself", "drifts"])
"""Rows of the segments (n, 35), the first and the last configuration (n, 3; rad and length unit), the scene, whether
the body must not run through itself, and how obstacles move meanwhile (c, 31), see `drift`: the rows of these in the
scene are written as time goes on. `Sweep.still` (0, 31) says that none does."""

Sweep = namedtuple("Sweep", "q frames reach reached near counts rates spans among pairs left paces balls still clock")
"""Scratch of a proof of n segments among m obstacles: configurations (3, n, 3) and their frames (3, n + 1, 12), whose
first rows are the base; of every segment the obstacles that it can reach at all (n, m) int64, and how many they are
(n,) int64; those that may still matter first (n, m) int64, and how many of them that are after so many halvings of time
(46, n) int64; `rates` (n, 5); `spans` (3, n + 1, 5) of `self_pairs`; numbers of obstacles (m,) int64; the pairs of
segments i <= j as i n + j (n (n + 1) / 2,) int64, those that may still touch first, and how many of them that are after
so many halvings (46,) int64; how fast every obstacle moves, `paces` (m, 5) of `drift`; a ball that holds each, `balls`
(m, 4), see `measure_balls`; no drifts (0, 31); and the clock, see `kernels.clock`."""


def sweep_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that `carve_sweep` takes from a buffer."""
    own = KNOTS * (15 * segments + 12 + SPAN_WIDTH * (segments + 1))
    pairs = segments * (segments + 1) // 2
    each = 2 * obstacles + 1 + TIME_LEVELS + 2 + MOTION_RATES_WIDTH
    return own + segments * each + (1 + PACE_WIDTH + BALL_WIDTH) * obstacles + pairs + TIME_LEVELS + 2 + CLOCK_SIZE


def carve_sweep(buffer: Array, base: Array, n: int, m: int) -> Sweep:
    """Lay out the scratch of n segments among m obstacles in `buffer` (at least `sweep_size`); `base` (1, 12).

    Every segment may reach every obstacle, at first, and none of these moves or is known to lie in a ball. Where there
    are many (`MANY_OBSTACLES`) nothing is listed, and no ball is kept.
    """
    large = m >= MANY_OBSTACLES
    q, rest = cut(buffer, KNOTS, n, 3)
    frames, rest = cut(rest, KNOTS, n + 1, 12)
    for at in range(KNOTS):
        put_base(frames[at], base)
    spans, rest = cut(rest, KNOTS, n + 1, SPAN_WIDTH)
    rates, rest = cut(rest, n, MOTION_RATES_WIDTH)
    paces, rest = cut(rest, m, PACE_WIDTH)
    paces[:] = 0.0
    balls, rest = cut(rest, 0 if large else m, BALL_WIDTH)
    balls[:] = math.inf
    reach, rest = cut_whole(rest, n, m)
    reached, rest = cut_whole(rest, n)
    for at in range(n):
        reached[at] = MANY if large else m
        for which in range(0 if large else m):
            reach[at, which] = which
    near, rest = cut_whole(rest, n, m)
    counts, rest = cut_whole(rest, TIME_LEVELS + 2, n)
    among, rest = cut_whole(rest, m)
    pairs, rest = cut_whole(rest, n * (n + 1) // 2)
    left, rest = cut_whole(rest, TIME_LEVELS + 2)
    still, rest = cut(rest, 0, DRIFT_WIDTH)
    clock, rest = cut_whole(rest, CLOCK_SIZE)
    return Sweep(q, frames, reach, reached, near, counts, rates, spans, among, pairs, left, paces, balls, still, clock)


def note_least(seen: Array, gap: float, t: float, k: int, s: float, which: int) -> None:
    """Keep a gap in `seen` (6,), and where and when it is, if it is the least so far."""
    if gap < seen[LEAST_SEEN]:
        seen[LEAST_SEEN], seen[WHEN], seen[SEGMENT], seen[FRACTION], seen[WHICH] = gap, t, k, s, which


def knot(motion: Motion, t: float, sweep: Sweep, at: int) -> None:
    """Put the configuration at time t into a place of the sweep, with its frames."""
    interpolate(motion.q0, motion.q1, t, sweep.q[at])
    forward(motion.limits, sweep.q[at], sweep.frames[at])
