"""Two places of one arc, its end and its center of gravity, with first and second derivatives.

Both are `length (f v, g)` with functions of `x = |v|^2`: `f_k(x) = sum (-x)^j / (2 j + k)!`, of which `chain.arc` knows
`S = f_1`, `G = f_2` and `H = f_3`. The end is `(f_2 v, f_1)`, the center of gravity `(f_3 v, f_2)`. With
`f_k = 1 / k! - x f_(k+2)` and the derivative `-(f_(k+1) - k f_(k+2)) / 2` nothing is singular.
"""

import math

from sinuous.kernels.chain.arc import SERIES_END
from sinuous.kernels.maths.vectors import Vec

PROFILE_TERMS = 13
SERIES_6 = tuple((-1) ** j / math.factorial(2 * j + 6) for j in range(PROFILE_TERMS))
SERIES_7 = tuple((-1) ** j / math.factorial(2 * j + 7) for j in range(PROFILE_TERMS))

Even = tuple[float, float, float, float, float, float, float]
Profile = tuple[float, float, float, float, float, float]
Square = tuple[float, float, float]


def even_functions(x: float) -> Even:
    """f_1 to f_7 at x: power series to a little beyond t = pi; above, closed forms."""
    if x < SERIES_END:
        f6, f7 = SERIES_6[PROFILE_TERMS - 1], SERIES_7[PROFILE_TERMS - 1]
        for j in range(PROFILE_TERMS - 2, -1, -1):
            f6, f7 = SERIES_6[j] + x * f6, SERIES_7[j] + x * f7
        f4, f5 = 1.0 / 24.0 - x * f6, 1.0 / 120.0 - x * f7
        f3 = 1.0 / 6.0 - x * f5
        return 1.0 - x * f3, 0.5 - x * f4, f3, f4, f5, f6, f7
    t = math.sqrt(x)
    f1, half = math.sin(t) / t, math.sin(0.5 * t) / t
    f2, f3 = 2.0 * half * half, (1.0 - f1) / x
    f4, f5 = (0.5 - f2) / x, (1.0 / 6.0 - f3) / x
    return f1, f2, f3, f4, f5, (1.0 / 24.0 - f4) / x, (1.0 / 120.0 - f5) / x


def _profile(k: float, f0: float, f1: float, f2: float, f3: float, f4: float, f5: float) -> Profile:
    """The functions f_(k+1) and f_k, their first and their second derivatives by x, from f_k to f_(k+5)."""
    d1, d2, d3 = f2 - (k + 1.0) * f3, f3 - (k + 2.0) * f4, f4 - (k + 3.0) * f5
    return f1, f0, -0.5 * d1, -0.5 * (f1 - k * f2), 0.25 * (d2 - (k + 1.0) * d3), 0.25 * (d1 - k * d2)


def end_profile(even: Even) -> Profile:
    return _profile(1.0, even[0], even[1], even[2], even[3], even[4], even[5])


def center_profile(even: Even) -> Profile:
    return _profile(2.0, even[1], even[2], even[3], even[4], even[5], even[6])


def place(vx: float, vy: float, length: float, own: Profile) -> Vec:
    """The place in the frame of the beginning of the arc."""
    return length * own[0] * vx, length * own[0] * vy, length * own[1]


def slopes(vx: float, vy: float, length: float, own: Profile) -> tuple[Vec, Vec, Vec]:
    """How the place moves with vx, vy and the length."""
    side, ahead, both = 2.0 * length * own[2], 2.0 * length * own[3], 2.0 * length * own[2] * vx * vy
    return (
        (length * own[0] + side * vx * vx, both, ahead * vx),
        (both, length * own[0] + side * vy * vy, ahead * vy),
        (own[0] * vx, own[0] * vy, own[1]),
    )


def by_bends(vx: float, vy: float, force: Vec, length: float, own: Profile) -> Square:
    """Second derivatives of `force . place` by vx vx, vx vy and vy vy."""
    along = force[0] * vx + force[1] * vy
    even = 2.0 * (own[2] * along + own[3] * force[2])
    curved = 4.0 * (own[4] * along + own[5] * force[2])
    side = 2.0 * own[2]
    return (
        length * (even + curved * vx * vx + 2.0 * side * force[0] * vx),
        length * (curved * vx * vy + side * (force[0] * vy + force[1] * vx)),
        length * (even + curved * vy * vy + 2.0 * side * force[1] * vy),
    )


def by_length(vx: float, vy: float, force: Vec, own: Profile) -> tuple[float, float]:
    """Second derivatives of `force . place` by length and vx, length and vy."""
    even = 2.0 * (own[2] * (force[0] * vx + force[1] * vy) + own[3] * force[2])
    return own[0] * force[0] + even * vx, own[0] * force[1] + even * vy
