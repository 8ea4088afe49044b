"""Two pieces of a curve: bounds of how near they are to each other.

An arc of length l that bends by u <= pi lies within `l u / 8` of its chord, so two pieces are no nearer than their
chords less both. And two places of a curve with no more curvature than k between them are no nearer than two places of
a circle of curvature k that are as far apart along it, up to once around (Schur; Chern 1967).
"""

import math

from sinuous.kernels.maths.vectors import TINY, Vec, dot, sub

PARALLEL = 1e-14
"""Square of the sine of an angle below which two chords count as parallel."""


def find_closest(a: Vec, b: Vec, c: Vec, d: Vec) -> tuple[float, float]:
    """The fractions of the straight lines `ab` and `cd` where these are closest to each other.

    Ericson, Real-Time Collision Detection, 5.1.9.
    """
    u, v, w = sub(b, a), sub(d, c), sub(a, c)
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    s = 0.5
    squared_sine = uu * vv - uv * uv
    if squared_sine > PARALLEL * uu * vv:
        s = min(max((uv * vw - uw * vv) / squared_sine, 0.0), 1.0)
    t = (uv * s + vw) / (vv + TINY)
    if t <= 0.0:  # also where `cd` is a point
        t = 0.0
        s = min(max(-uw / (uu + TINY), 0.0), 1.0)
    elif t > 1.0:
        t = 1.0
        s = min(max((uv - uw) / (uu + TINY), 0.0), 1.0)
    return s, t


def nearest_share(p: Vec, a: Vec, line: Vec) -> float:
    """Share of a straight `line` from `a` on at which it is nearest to the point `p`; 0 of one without length."""
    square = dot(line, line)
    return min(1.0, max(0.0, dot(sub(p, a), line) / square)) if square > 0.0 else 0.0


def sagitta_bound(length: float, bend: float) -> float:
    """Upper bound of how far an arc that bends by at most half a turn is from its chord (its sagitta)."""
    return 0.125 * length * bend


def arc_chord(curvature: float, length: float) -> float:
    """Distance between the ends of an arc; 0 when that is a whole circle or more."""
    half = 0.5 * curvature * length
    if half >= math.pi:
        return 0.0
    return length * math.sin(half) / half if half > 1e-9 else length
