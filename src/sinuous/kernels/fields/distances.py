"""Signed distance, positive outside, to the obstacles of a scene.

A scene is a table with one row an obstacle, and one array of numbers, the store. The row of a primitive says all: kind,
sign (-1: the body must stay inside), center (3), rotation (9, its columns are the obstacle's axes in the world), half
extents (3), rounding. Spheres, capsules and boxes are all one shape, a box of half extents `h`, possibly zero, rounded
by `r`; the sphere has a kind of its own because it is so common. Meshes, clouds and grids keep their numbers in the
store; see `solids`.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields import solids
from sinuous.kernels.fields.solids import ABOVE, EXACT, STEP
from sinuous.kernels.maths.vectors import Array, Mat, Vec, get_mat, get_vec, mat_vec, norm, scale, sub, vec_mat
from sinuous.kernels.tables import (
    BOX,
    CYLINDER,
    FIRST_SAMPLE,
    OBSTACLE_WIDTH,
    SAMPLES,
    SCENE_HEADER,
    SPACING,
    SPHERE,
    TREE,
)

Scene = namedtuple("Scene", ["table", "store"])
"""Rows (m, 18), and the numbers (s,) that they point to; layout: see `sinuous.kernels.tables`."""


@kernel
def read_scene(scene: Array) -> Scene:
    """Take the group of a scene apart."""
    end = SCENE_HEADER + OBSTACLE_WIDTH * int(scene[0])
    return Scene(scene[SCENE_HEADER:end].reshape((int(scene[0]), OBSTACLE_WIDTH)), scene[end:])


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
def _primitive(table: Array, i: int, p: Vec) -> tuple[float, Vec]:
    local = sub(p, get_vec(table, i, 2))
    if table[i, 0] == SPHERE:
        d, g = sphere(local)
    else:
        d, g = _shape(int(table[i, 0]), get_mat(table, i, 5), get_vec(table, i, 14), local)
    sign = table[i, 1]
    return sign * (d - table[i, 17]), scale(sign, g)


@kernel
def _look_at_other(scene: Scene, i: int, p: Vec, reach: float, how: int) -> tuple[float, float]:
    if scene.table[i, 0] >= TREE:
        return solids.look(scene.table, scene.store, i, p, reach, how)
    d, _ = _primitive(scene.table, i, p)
    return d, d


@kernel
def look(scene: Scene, i: int, p: Vec, reach: float, how: int) -> tuple[float, float]:
    """Signed distance of the point `p` to obstacle `i`, and an upper bound of it: the same where it is exact.

    `how` is one of STEP, BOUND, EXACT and ABOVE of `solids`; primitives are always exact. What is not less than
    `reach` need not be exact: any lower bound that is not less than `reach` either will do.
    """
    if scene.table[i, 0] != SPHERE:
        return _look_at_other(scene, i, p, reach, how)
    d = scene.table[i, 1] * (norm(sub(p, get_vec(scene.table, i, 2))) - scene.table[i, 17])
    return d, d


@kernel
def slope(scene: Scene, i: int, p: Vec, reach: float, how: int) -> tuple[float, Vec]:
    """Signed distance of the point `p` to obstacle `i`, STEP or EXACT, and its gradient; `reach` as for `look`."""
    if scene.table[i, 0] >= TREE:
        return solids.slope(scene.table, scene.store, i, p, reach, how)
    return _primitive(scene.table, i, p)


@kernel
def obstacle(scene: Scene, i: int, p: Vec) -> tuple[float, Vec]:
    """Signed distance of the point `p` to obstacle `i` and its gradient: interpolated where there are samples."""
    return slope(scene, i, p, math.inf, STEP)


@kernel
def distance(scene: Scene, i: int, p: Vec) -> float:
    """Signed distance of the point `p` to obstacle `i`; a lower bound where only samples of it are known."""
    return look(scene, i, p, math.inf, EXACT)[0]


@kernel
def bounded(scene: Scene, i: int, p: Vec, reach: float) -> float:
    """Distance where it is less than `reach`; otherwise some lower bound that is not less than `reach`."""
    return look(scene, i, p, reach, EXACT)[0]


@kernel
def coarseness(scene: Scene) -> float:
    """Largest spacing of samples that stand in for something exact; 0 without any."""
    spacing = 0.0
    for i in range(scene.table.shape[0]):
        if scene.table[i, 0] >= TREE and scene.table[i, FIRST_SAMPLE] >= 0.0:
            spacing = max(spacing, scene.table[i, SPACING])
    return spacing


@kernel
def closest(scene: Scene, p: Vec, reach: float, how: int) -> tuple[float, int]:
    """Least signed distance of the point `p` to the scene, and the obstacle that it is to (-1: there is none).

    `how` to ask, and `reach`, from which on it may be anything that is not less: see `look`.
    """
    least, which = math.inf, -1
    for i in range(scene.table.shape[0]):
        d, _ = look(scene, i, p, min(least, reach), how)
        if d < least:
            least, which = d, i
    return least, which


@kernel
def nearest(scene: Scene, p: Vec) -> tuple[float, int]:
    """Least signed distance of the point `p` to the scene, and the obstacle that it is to (-1: there is none)."""
    return closest(scene, p, math.inf, EXACT)


@kernel
def at_most(scene: Scene, p: Vec, reach: float) -> float:
    """Upper bound of the distance of the point `p` to the scene, exact unless only samples are known."""
    return closest(scene, p, reach, ABOVE)[0]


@entry
def many(
    table: Array, store: Array, points: Array, values: Array, above: Array, gradients: Array, which: Array
) -> None:
    """Fill signed distance, an upper bound of it, gradient and obstacle for every row of `points` (m, 3).

    Without obstacles inf, inf, 0 and -1.
    """
    scene = Scene(table, store)
    uncertain = False
    for i in range(table.shape[0]):
        uncertain = uncertain or table[i, 0] == SAMPLES
    for j in range(points.shape[0]):
        p = get_vec(points, j, 0)
        values[j], which[j] = nearest(scene, p)
        above[j] = at_most(scene, p, math.inf) if uncertain else values[j]
        if which[j] >= 0:
            _, g = slope(scene, which[j], p, math.inf, EXACT)
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = g
        else:
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = 0.0, 0.0, 0.0
