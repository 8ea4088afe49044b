"""How fast the places of a body move while its configuration changes linearly.

Time t runs from 0 to 1, and `q(t) = (1 - t) q0 + t q1`. The rotation at a place of the body is a product of
exponentials of vectors that are linear in t. So its first derivative is at most `W`, the sum of the rates at which the
segments bend up to that place, and its second derivative at most `W^2`. Hence the acceleration of a place is at most
`A`, the integral of `l W^2 + 2 |l'| W` along the body up to there, with l the length of a segment: within an interval
of duration h a place stays within `h^2 A / 8` of the chord of its path.

Between joints counts the straight way from one to the next, to a place of a link that from the last joint before it:
links are rigid, so no detour through their other capsules moves anything.

`q0` (n, 3) and `q1` (n, 3) are the first and the last configuration, `rates` (n, 5) has the columns below.
"""

import math

from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.tables import LINK, ONWARD, RIGID, TAIL_LENGTH

TURNING, ACCELERATION_BOUND, BEND_RATE, LENGTH_RATE, TAIL = range(5)
"""Columns of `rates`: W (rad) and A (length unit) where a segment begins; how much it bends (rad) and changes its
length in the whole motion; and how far its end is from where the next row begins."""

MOTION_RATES_WIDTH = 5


def measure_rates(limits: Array, q0: Array, q1: Array, rates: Array) -> float:
    """Fill `rates` (n, 5); return a bound of how far any place of the body travels."""
    turning = acceleration = travel = farthest = 0.0
    for k in range(q0.shape[0]):
        onward, rates[k, TAIL] = limits[k, ONWARD], limits[k, TAIL_LENGTH]
        if limits[k, RIGID] == LINK:
            rates[k, TURNING], rates[k, BEND_RATE], rates[k, LENGTH_RATE] = turning, 0.0, 0.0
            rates[k, ACCELERATION_BOUND] = acceleration + onward * turning * turning
            farthest = max(farthest, travel + onward * turning)
            continue
        bend = math.hypot(q1[k, 0] - q0[k, 0], q1[k, 1] - q0[k, 1])
        stretch = abs(q1[k, 2] - q0[k, 2])
        if onward > 0.0:
            acceleration += onward * turning * turning
            travel += onward * turning
        rates[k, TURNING], rates[k, ACCELERATION_BOUND] = turning, acceleration
        rates[k, BEND_RATE], rates[k, LENGTH_RATE] = bend, stretch
        acceleration = acceleration_bound(rates, k, max(q0[k, 2], q1[k, 2]), 1.0)
        travel += stretch + max(q0[k, 2], q1[k, 2]) * (turning + 0.5 * bend)
        turning += bend
    return max(farthest, travel)


def acceleration_bound(rates: Array, k: int, length: float, s: float) -> float:
    """The acceleration A of places up to the fraction `s` of segment `k`, of no more than this length."""
    own = added_acceleration(rates[k, TURNING], rates[k, BEND_RATE], rates[k, LENGTH_RATE], length, s)
    return float(rates[k, ACCELERATION_BOUND] + own)


def added_acceleration(turning: float, bend: float, stretch: float, length: float, s: float) -> float:
    """What a segment adds to A up to its fraction `s`: W where it begins, its rates, and its largest length."""
    squares = turning * turning + s * turning * bend + s * s * bend * bend / 3.0
    return s * (length * squares + 2.0 * stretch * (turning + 0.5 * s * bend))
