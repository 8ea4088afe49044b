"""A route as a curve: points evenly spaced along it, and what lies between them."""

import math
from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, closest
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, get_vec, norm, scale, sub

OPEN_FROM, OPEN_AT = 2.0, 4.0
"""Distances from the obstacles, in radii of the body, from which on there is room for more chain than the curve is
long, and at which there is most of it."""

Curve = namedtuple("Curve", ["points", "spacing", "chain"])
"""Points (K, 3) of a route, the distance between neighbours along it, and how much of the chain belongs before each
point (K,), of all that belongs to the curve."""


@kernel
def curve_through(points: Array, chain: Array) -> Curve:
    """Return the curve through points (K, 3) that are evenly spaced, or nearly so; `chain` (K,) is filled: evenly."""
    length, count = 0.0, points.shape[0]
    for i in range(1, count):
        length += norm(sub(get_vec(points, i, 0), get_vec(points, i - 1, 0)))
    for i in range(count):
        chain[i] = i / (count - 1.0)
    return Curve(points, length / (count - 1), chain)


@kernel
def make_room(curve: Curve, scene: Scene, radius: float, length: float) -> None:
    """Spread a chain of this length over a shorter curve: what is too much of it, where the obstacles leave room.

    In a narrow place a chain that is drawn together leaves the curve, and meets the walls.
    """
    chain, spacing = curve.chain, curve.spacing
    more = length - length_of(curve)
    if more <= 0.0 or scene.table.shape[0] == 0:
        return
    chain[0] = total = last = 0.0
    for i in range(chain.shape[0]):
        d, _ = closest(scene, get_vec(curve.points, i, 0), OPEN_AT * radius, STEP)
        share = min(1.0, max(0.0, (d / radius - OPEN_FROM) / (OPEN_AT - OPEN_FROM))) if radius > 0.0 else 1.0
        if i > 0:
            total += 0.5 * spacing * (last + share)
        chain[i], last = total, share
    for i in range(chain.shape[0]):
        even = i / (chain.shape[0] - 1.0)
        chain[i] = (i * spacing + more * chain[i] / total) / length if total > 0.0 else even


@kernel
def along_of(curve: Curve, share: float) -> float:
    """Length along the curve up to which so great a share of the chain belongs."""
    low, high = 0, curve.chain.shape[0] - 1
    while high - low > 1:
        between = (low + high) // 2
        if curve.chain[between] <= share:
            low = between
        else:
            high = between
    step = curve.chain[high] - curve.chain[low]
    return curve.spacing * (low + ((share - curve.chain[low]) / step if step > 0.0 else 0.0))


@kernel
def length_of(curve: Curve) -> float:
    """Length of the curve."""
    return curve.spacing * (curve.points.shape[0] - 1)


@kernel
def point_at(curve: Curve, along: float) -> Vec:
    """Point of the curve at the length `along`; beyond an end, that end."""
    count = curve.points.shape[0]
    x = min(max(along / curve.spacing, 0.0), count - 1.0)
    i = min(int(x), count - 2)
    a = get_vec(curve.points, i, 0)
    return add_scaled(a, x - i, sub(get_vec(curve.points, i + 1, 0), a))


@kernel
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
