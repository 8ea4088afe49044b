"""Signed distance, positive outside, to the exact obstacles of a scene.

A scene is a table with one row an obstacle: kind, sign (-1: the body must stay inside), center (3), rotation (9, its
columns are the obstacle's axes in the world), half extents (3), rounding. Spheres, capsules and boxes are all one
shape, a box of half extents `h`, possibly zero, rounded by `r`; the sphere has a kind of its own because it is so
common.
"""

import math

from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.vectors import Array, Mat, Vec, get_mat, get_vec, mat_vec, norm, scale, sub, vec_mat

SPHERE, BOX, CYLINDER, HALF_SPACE = 0, 1, 2, 3
WIDTH = 18


@kernel
def sphere(p: Vec) -> tuple[float, Vec]:
    """Distance to the origin and its gradient (up where it has none)."""
    d = norm(p)
    if d == 0.0:
        return 0.0, (0.0, 0.0, 1.0)
    return d, scale(1.0 / d, p)


@kernel
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


@kernel
def cylinder(p: Vec, radius: float, half: float) -> tuple[float, Vec]:
    """Distance to a flat-ended cylinder about the z axis and its gradient: a box in the plane of radius and height."""
    rho = math.hypot(p[0], p[1])
    d, g = box((rho, 0.0, p[2]), (radius, math.inf, half))
    if rho == 0.0:
        return d, (g[0], 0.0, g[2])
    return d, (g[0] * p[0] / rho, g[0] * p[1] / rho, g[2])


@kernel
def _shape(kind: int, rotation: Mat, half: Vec, p: Vec) -> tuple[float, Vec]:
    local = vec_mat(p, rotation)
    if kind == BOX:
        d, g = box(local, half)
    elif kind == CYLINDER:
        d, g = cylinder(local, half[0], half[2])
    else:
        d, g = local[2], (0.0, 0.0, 1.0)
    return d, mat_vec(rotation, g)


@kernel
def obstacle(scene: Array, i: int, p: Vec) -> tuple[float, Vec]:
    """Signed distance of the point `p` to obstacle `i`, and its gradient."""
    local = sub(p, get_vec(scene, i, 2))
    if scene[i, 0] == SPHERE:
        d, g = sphere(local)
    else:
        d, g = _shape(int(scene[i, 0]), get_mat(scene, i, 5), get_vec(scene, i, 14), local)
    sign = scene[i, 1]
    return sign * (d - scene[i, 17]), scale(sign, g)


@kernel
def distance(scene: Array, i: int, p: Vec) -> float:
    """Signed distance of the point `p` to obstacle `i`, without the gradient where that is cheaper."""
    if scene[i, 0] == SPHERE:
        local = sub(p, get_vec(scene, i, 2))
        return scene[i, 1] * (norm(local) - scene[i, 17])
    return obstacle(scene, i, p)[0]


@kernel
def nearest(scene: Array, p: Vec) -> tuple[float, int]:
    """Least signed distance of the point `p` to the scene, and the obstacle that it is to (-1: there is none)."""
    least, which = math.inf, -1
    for i in range(scene.shape[0]):
        d = distance(scene, i, p)
        if d < least:
            least, which = d, i
    return least, which


@entry
def many(scene: Array, points: Array, values: Array, gradients: Array, which: Array) -> None:
    """Fill signed distance, gradient and obstacle for every row of `points` (m, 3); inf, 0, -1 without obstacles."""
    for j in range(points.shape[0]):
        p = get_vec(points, j, 0)
        values[j], which[j] = nearest(scene, p)
        if which[j] >= 0:
            _, g = obstacle(scene, which[j], p)
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = g
        else:
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = 0.0, 0.0, 0.0
