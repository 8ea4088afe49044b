"""A route as a curve: points evenly spaced along it, and what lies between them."""

import math
from collections import namedtuple

from sinuous.kernels.freespace.band import line_length
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, get_vec, scale, sub

Curve = namedtuple("Curve", ["points", "spacing"])
"""Points (K, 3) of a route, and the distance between neighbours along it."""


def curve_through(points: Array) -> Curve:
    """Return the curve through points (K, 3) that are evenly spaced, or nearly so."""
    count = points.shape[0]
    return Curve(points, line_length(points, count) / (count - 1))


def length_of(curve: Curve) -> float:
    """Length of the curve."""
    return curve.spacing * (curve.points.shape[0] - 1)


def point_at(curve: Curve, along: float) -> Vec:
    """Point of the curve at the length `along`; beyond an end, that end."""
    count = curve.points.shape[0]
    x = min(max(along / curve.spacing, 0.0), count - 1.0)
    i = min(int(x), count - 2)
    a = get_vec(curve.points, i, 0)
    return add_scaled(a, x - i, sub(get_vec(curve.points, i + 1, 0), a))


def closest_on(curve: Curve, p: Vec, along: float, window: float) -> tuple[Vec, Vec]:
    """Place on the curve closest to `p`, no farther than `window` from the length `along`: point and unit tangent."""
    points, spacing = curve.points, curve.spacing
    count = points.shape[0]
    first = max(0, min(count - 2, int((along - window) / spacing)))
    last = max(first + 1, min(count - 1, math.ceil((along + window) / spacing)))
    least = math.inf
    point, tangent = get_vec(points, first, 0), (0.0, 0.0, 1.0)
    for i in range(first, last):
        a = get_vec(points, i, 0)
        line = sub(get_vec(points, i + 1, 0), a)
        square = dot(line, line)
        if square == 0.0:
            continue
        foot = add_scaled(a, min(1.0, max(0.0, dot(sub(p, a), line) / square)), line)
        off = sub(p, foot)
        if dot(off, off) < least:
            least, point, tangent = dot(off, off), foot, scale(1.0 / math.sqrt(square), line)
    return point, tangent
