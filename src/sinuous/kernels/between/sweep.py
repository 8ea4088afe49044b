"""The motion linear in q from one configuration to another: how fast its parts move, and what a proof of it works on.

Time t runs from 0 to 1, and `q(t) = (1 - t) q0 + t q1`. The rotation at a place of the body is a product of
exponentials of vectors that are linear in t. So its first derivative is at most `W`, the sum of the rates at which the
segments bend up to that place, and its second derivative at most `W^2`. Hence the acceleration of a place is at most
`A`, the integral of `l W^2 + 2 |l'| W` along the body up to there, with l the length of a segment: within an interval
of duration h a place stays within `h^2 A / 8` of the chord of its path.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.kinematics import forward, frame, put_frame
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array

LEVELS = 44
"""How often time may be halved."""

TURNING, STRETCHING, BOWING, BEND_RATE, LENGTH_RATE = range(5)
"""Columns of `rates`: W (rad), the sum of the rates of lengths, and A (length unit) where a segment begins; how much
it bends (rad) and changes its length in the whole motion."""

RATES_WIDTH = 5

LOW, LEAST, WHEN, SEGMENT, FRACTION, WHICH = range(6)
"""What is known of clearances, `seen`: the lower bound of what is proved so far; the least that was seen, and where: at
which time, on which segment, at which fraction of it, and to which obstacle or other segment."""

SEEN_WIDTH = 6

KNOTS, HALFWAY = 3, 2
"""Configurations at hand: where an interval begins, where it ends, and the one half-way."""

Motion = namedtuple("Motion", ["limits", "q0", "q1", "scene", "avoids_itself"])
"""Rows of the segments (n, 7), the first and the last configuration (n, 3; rad and length unit), the scene, and whether
the body must not run through itself."""

Sweep = namedtuple("Sweep", ["q", "frames", "near", "counts", "rates", "spans", "looked", "pairs", "left", "clock"])
"""Scratch of a proof of n segments among m obstacles: configurations (3, n, 3) and their frames (3, n + 1, 12), whose
first rows are the base; of every segment the obstacles (n, m) int64, those that may still matter first, and how many of
them that are after so many halvings of time (46, n) int64; `rates` (n, 5); `spans` (n + 1, 5) of `self_pairs`; numbers
of obstacles (m,) int64; the pairs of segments i <= j as i n + j (n (n + 1) / 2,) int64, those that may still touch
first, and how many of them that are after so many halvings (46,) int64; and the clock, see `kernels.clock`."""


def sweep_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that `carve_sweep` takes from a buffer."""
    own = KNOTS * (15 * segments + 12) + SPAN_WIDTH * (segments + 1)
    pairs = segments * (segments + 1) // 2
    return own + segments * (obstacles + LEVELS + 2 + RATES_WIDTH) + obstacles + pairs + LEVELS + 2 + CLOCK_SIZE


@kernel
def carve_sweep(buffer: Array, base: Array, n: int, m: int) -> Sweep:
    """Lay out the scratch of n segments among m obstacles in `buffer` (at least `sweep_size`); `base` (1, 12)."""
    a = 3 * KNOTS * n
    b = a + 12 * KNOTS * (n + 1)
    c = b + n * m
    d = c + (LEVELS + 2) * n
    e = d + RATES_WIDTH * n
    f = e + SPAN_WIDTH * (n + 1)
    g = f + m
    h = g + n * (n + 1) // 2
    frames = shaped(buffer[a:b], (KNOTS, n + 1, 12))
    rotation, position = frame(base, 0)
    for i in range(KNOTS):
        put_frame(frames[i], 0, rotation, position)
    return Sweep(
        shaped(buffer[:a], (KNOTS, n, 3)),
        frames,
        shaped(buffer[b:c].view(np.int64), (n, m)),
        shaped(buffer[c:d].view(np.int64), (LEVELS + 2, n)),
        shaped(buffer[d:e], (n, RATES_WIDTH)),
        shaped(buffer[e:f], (n + 1, SPAN_WIDTH)),
        buffer[f:g].view(np.int64),
        buffer[g:h].view(np.int64),
        buffer[h : h + LEVELS + 2].view(np.int64),
        buffer[h + LEVELS + 2 : h + LEVELS + 2 + CLOCK_SIZE].view(np.int64),
    )


@kernel
def at_time(q0: Array, q1: Array, t: float, out: Array) -> None:
    """Fill `out` (n, 3) with the configuration at time t."""
    for k in range(q0.shape[0]):
        for j in range(3):
            out[k, j] = (1.0 - t) * q0[k, j] + t * q1[k, j]


@kernel
def knot(motion: Motion, t: float, sweep: Sweep, at: int) -> None:
    """Put the configuration at time t into a place of the sweep, with its frames."""
    at_time(motion.q0, motion.q1, t, sweep.q[at])
    forward(sweep.q[at], sweep.frames[at])


@kernel
def measure_rates(q0: Array, q1: Array, rates: Array) -> float:
    """Fill `rates` (n, 5); return a bound of how far any place of the body travels."""
    turning = stretching = bowing = travel = 0.0
    for k in range(q0.shape[0]):
        bend = math.hypot(q1[k, 0] - q0[k, 0], q1[k, 1] - q0[k, 1])
        stretch = abs(q1[k, 2] - q0[k, 2])
        rates[k, TURNING], rates[k, STRETCHING], rates[k, BOWING] = turning, stretching, bowing
        rates[k, BEND_RATE], rates[k, LENGTH_RATE] = bend, stretch
        bowing = bow(rates, k, max(q0[k, 2], q1[k, 2]), 1.0)
        travel += stretch + max(q0[k, 2], q1[k, 2]) * (turning + 0.5 * bend)
        turning, stretching = turning + bend, stretching + stretch
    return travel


@kernel
def bow(rates: Array, k: int, length: float, s: float) -> float:
    """The acceleration A of places up to the fraction `s` of segment `k`, of no more than this length."""
    w, bend, stretch = rates[k, TURNING], rates[k, BEND_RATE], rates[k, LENGTH_RATE]
    squares = w * w + s * w * bend + s * s * bend * bend / 3.0
    return float(rates[k, BOWING] + s * (length * squares + 2.0 * stretch * (w + 0.5 * s * bend)))
