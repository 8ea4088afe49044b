"""The artificial potential of obstacles: zero from a distance on, then rising, with a continuous slope.

    c(d) = slope (reach / 2 - d)            where d < 0
           slope (d - reach)^2 / (2 reach)  where 0 <= d <= reach
           0                                farther away

as CHOMP has it (Ratliff et al. 2009); `d` is the distance of the body's surface. It is sampled on a grid beforehand and
interpolated linearly, or computed from the obstacles each time.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, nearest, obstacle, read_scene
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, get_vec, norm, scale, sub

BLOCK = 8
"""Nodes along the edge of a block that is looked at as a whole before its nodes are."""

Potential = namedtuple("Potential", ["scene", "values", "origin", "spacing", "slope", "reach", "radius"])
"""The obstacles; values (x, y, z) at the nodes of a grid, none: exact; where its first node is and how far nodes are
apart; the parameters of `c`; and the radius of the body."""


def hinge(d: float, slope: float, reach: float) -> tuple[float, float]:
    """c(d) and its derivative."""
    if d < 0.0:
        return slope * (0.5 * reach - d), -slope
    if d <= reach:
        return 0.5 * slope / reach * (d - reach) * (d - reach), slope / reach * (d - reach)
    return 0.0, 0.0


def read_potential(scene: Scene, sampled: Array, slope: float, reach: float) -> Potential:
    """Take the group `sampled` apart: shape (3), origin (3), spacing, radius of the body, then the values."""
    nx, ny, nz = int(sampled[0]), int(sampled[1]), int(sampled[2])
    origin = (sampled[3], sampled[4], sampled[5])
    return Potential(scene, sampled[8:].reshape((nx, ny, nz)), origin, sampled[6], slope, reach, sampled[7])


def exact(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential and its gradient at `p`, from the obstacles themselves."""
    d, which = nearest(potential.scene, p)
    c, slope = hinge(d - potential.radius, potential.slope, potential.reach)
    if c == 0.0:
        return 0.0, ZERO
    return c, scale(slope, obstacle(potential.scene, which, p, math.inf)[1])


def interpolated(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential at `p`, linear along each axis within a cell of the grid, and its gradient; zero outside the grid."""
    values, inverse = potential.values, 1.0 / potential.spacing
    x, y, z = scale(inverse, sub(p, potential.origin))
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    if i < 0 or j < 0 or k < 0:
        return 0.0, ZERO
    if i >= values.shape[0] - 1 or j >= values.shape[1] - 1 or k >= values.shape[2] - 1:
        return 0.0, ZERO
    x, y, z = x - i, y - j, z - k
    a, b = values[i, j, k], values[i, j, k + 1]
    c, d = values[i, j + 1, k], values[i, j + 1, k + 1]
    e, f = values[i + 1, j, k], values[i + 1, j, k + 1]
    g, h = values[i + 1, j + 1, k], values[i + 1, j + 1, k + 1]
    near, far = a + z * (b - a), c + z * (d - c)
    near_on, far_on = e + z * (f - e), g + z * (h - g)
    here, on = near + y * (far - near), near_on + y * (far_on - near_on)
    rise_y = (far - near) + x * ((far_on - near_on) - (far - near))
    rise, rise_on = (b - a) + y * ((d - c) - (b - a)), (f - e) + y * ((h - g) - (f - e))
    return here + x * (on - here), scale(inverse, (on - here, rise_y, rise + x * (rise_on - rise)))


def potential_at(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential and its gradient at `p`."""
    if potential.values.shape[0] > 0:
        return interpolated(potential, p)
    return exact(potential, p)


@entry
def sample(scene: Array, sampled: Array, shape: tuple[float, float], centre: Array, extent: float) -> None:
    """Fill the values of the group `sampled` with the potential at the nodes; zero where no body can be.

    `scene` is the group of the scene; `shape` holds slope and reach of the potential. A body can be within `extent` of
    `centre` (1, 3). Blocks of nodes that are farther from every obstacle than the potential reaches are filled at once.
    """
    slope, reach = shape
    obstacles = read_scene(scene)
    potential = read_potential(obstacles, sampled, slope, reach)
    values = potential.values
    middle = get_vec(centre, 0, 0)
    spacing = potential.spacing
    half = 0.5 * (BLOCK - 1) * spacing
    around = math.sqrt(3.0) * half
    for bi in range(0, values.shape[0], BLOCK):
        for bj in range(0, values.shape[1], BLOCK):
            for bk in range(0, values.shape[2], BLOCK):
                p = _node(potential, bi, bj, bk)
                p = (p[0] + half, p[1] + half, p[2] + half)
                d, _ = nearest(obstacles, p)
                clear = d > potential.radius + reach + around or norm(sub(p, middle)) > extent + around
                for i in range(bi, min(bi + BLOCK, values.shape[0])):
                    for j in range(bj, min(bj + BLOCK, values.shape[1])):
                        for k in range(bk, min(bk + BLOCK, values.shape[2])):
                            values[i, j, k] = 0.0
                            if not clear:
                                d, _ = nearest(obstacles, _node(potential, i, j, k))
                                values[i, j, k] = hinge(d - potential.radius, slope, reach)[0]


def _node(potential: Potential, i: int, j: int, k: int) -> Vec:
    origin, spacing = potential.origin, potential.spacing
    return (origin[0] + i * spacing, origin[1] + j * spacing, origin[2] + k * spacing)
