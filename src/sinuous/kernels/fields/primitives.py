"""Distances to obstacles that a few numbers say exactly; all of these are convex, see `bound_patch`.

Spheres, capsules and boxes are all one shape, a box of half extents `h`, possibly zero, rounded by `r`; the sphere has
a kind of its own because it is so common.
"""

import math
from collections import namedtuple

from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Mat,
    Vec,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    norm,
    scale,
    sub,
    vec_mat,
)
from sinuous.kernels.tables import (
    AXES,
    BOX,
    CENTER,
    CYLINDER,
    HALF_EXTENTS,
    HALF_SPACE,
    KIND,
    ROUNDING_RADIUS,
    SIGN,
    SPHERE,
)

FLAT = 100.0
"""Largest size of a patch, in distances, for which a tangent is used: a gradient is as exact as a distance is large."""

Patch = namedtuple("Patch", ["center", "along", "onward", "twist"])
"""What a straight chord sweeps while both its ends move straight on: `center + a along + b onward + a b twist` for all
a and b of -1 to 1. All of it lies between its four corners. A chord at rest has no `onward` and no `twist`."""


def sphere(p: Vec) -> tuple[float, Vec]:
    """Distance to the origin and its gradient (up where it has none)."""
    d = norm(p)
    if d == 0.0:
        return 0.0, (0.0, 0.0, 1.0)
    return d, scale(1.0 / d, p)


def box(p: Vec, half: Vec) -> tuple[float, Vec]:
    """Distance to an axis-aligned box about the origin and its gradient (Quilez)."""
    x, y, z = abs(p[0]) - half[0], abs(p[1]) - half[1], abs(p[2]) - half[2]
    sx, sy, sz = math.copysign(1.0, p[0]), math.copysign(1.0, p[1]), math.copysign(1.0, p[2])
    outside = (max(x, 0.0), max(y, 0.0), max(z, 0.0))
    d = norm(outside)
    if d > 0.0:
        return d, (sx * outside[0] / d, sy * outside[1] / d, sz * outside[2] / d)
    if x >= y and x >= z:
        return x, (sx, 0.0, 0.0)
    if y >= z:
        return y, (0.0, sy, 0.0)
    return z, (0.0, 0.0, sz)


def cylinder(p: Vec, radius: float, half: float) -> tuple[float, Vec]:
    """Distance to a flat-ended cylinder about the z axis and its gradient: a box in the plane of radius and height."""
    rho = math.hypot(p[0], p[1])
    d, g = box((rho, 0.0, p[2]), (radius, math.inf, half))
    if rho == 0.0:
        return d, (g[0], 0.0, g[2])
    return d, (g[0] * p[0] / rho, g[0] * p[1] / rho, g[2])


def _shape(kind: int, rotation: Mat, half: Vec, p: Vec, sign: float) -> tuple[float, Vec]:
    """Distance to what is no sphere; of an unknown kind -infinite after the sign: nothing is clear of it."""
    local = vec_mat(p, rotation)
    if kind == BOX:
        d, g = box(local, half)
    elif kind == CYLINDER:
        d, g = cylinder(local, half[0], half[2])
    elif kind == HALF_SPACE:
        d, g = local[2], (0.0, 0.0, 1.0)
    else:
        d, g = -sign * math.inf, ZERO
    return d, mat_vec(rotation, g)


def axis_of(table: Array, i: int, axis: int) -> Vec:
    """Unit vector along an axis of the primitive in row `i` of a scene (m, 33)."""
    at = AXES + axis
    return table[i, at], table[i, at + 3], table[i, at + 6]


def primitive(table: Array, i: int, p: Vec) -> tuple[float, Vec]:
    """Signed distance of the point `p` to the primitive in row `i` of a scene (m, 33), and its gradient.

    It is -inf where the kind of the primitive has no distance here: everything is infinitely deep in that. NaN would
    be passed over by comparisons, and so all would be clear.
    """
    local = sub(p, get_vec(table, i, CENTER))
    sign = table[i, SIGN]
    if table[i, KIND] == SPHERE:
        d, g = sphere(local)
    else:
        d, g = _shape(int(table[i, KIND]), get_mat(table, i, AXES), get_vec(table, i, HALF_EXTENTS), local, sign)
    return sign * (d - table[i, ROUNDING_RADIUS]), scale(sign, g)


def patch_size(patch: Patch) -> float:
    """No point of a patch is farther from its center than that."""
    return norm(patch.along) + norm(patch.onward) + norm(patch.twist)


def lean(g: Vec, patch: Patch) -> float:
    """Least of a linear function with the gradient `g` on a patch, of which it is 0 at the center: at a corner."""
    a, b, c = dot(g, patch.along), dot(g, patch.onward), dot(g, patch.twist)
    return min(c - a - b, a - b - c, b - a - c, a + b + c)


def bound_patch(table: Array, i: int, patch: Patch, deviation: float) -> tuple[float, Vec]:
    """Lower bound of the distance to primitive `i` of all that is within `deviation` of a patch; -inf: none known.

    The distance to a convex primitive is a convex function: on the patch it is no less than its tangent at the center
    says at the worst corner. Also its gradient there.
    """
    d, g = primitive(table, i, patch.center)
    known = table[i, SIGN] > 0.0 and patch_size(patch) < FLAT * d
    return (d + lean(g, patch) - deviation if known else -math.inf), g
