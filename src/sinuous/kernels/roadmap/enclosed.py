"""Whether a place is enclosed: obstacles all around, seen along a few rays."""

import math

from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, read_scene
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, get_mat, get_vec, mat_vec

RAYS = 14
"""Along the axes of a frame and between three of them, both ways."""

RAY_EVALUATIONS = 16
"""Most evaluations along a ray: one that goes along a wall as far as this meets it."""

MET = 0.02
"""Distance from the obstacles at which a ray ends, as a share of its length."""


def _direction(i: int) -> Vec:
    """Unit vector of a ray in the frame."""
    if i < 6:
        sign = 1.0 if i < 3 else -1.0
        return (sign if i % 3 == 0 else 0.0, sign if i % 3 == 1 else 0.0, sign if i % 3 == 2 else 0.0)
    corner, size = i - 6, 1.0 / math.sqrt(3.0)  # each of three bits of its number is a side
    return (size if corner & 1 else -size, size if corner & 2 else -size, size if corner & 4 else -size)


def _meets(scene: Scene, p: Vec, direction: Vec, length: float) -> bool:
    """Whether a ray meets an obstacle."""
    gone = 0.0
    for _ in range(RAY_EVALUATIONS):
        d, _ = closest(scene, add_scaled(p, gone, direction), length, INTERPOLATED)
        gone += d
        if d < MET * length:
            return True
        if gone > length:
            return False
    return True


@entry
def rays_met(scene: Array, frame: Array, place: Array, length: float) -> int:
    """Return how many of `RAYS` rays from a place meet an obstacle.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    frame : ndarray (1, 9)
        Rotation, row by row, by whose axes the rays go.
    place : ndarray (1, 3)
        In the length unit.
    length : float
        How far they lead, in the length unit.
    """
    obstacles, rotation, p = read_scene(scene), get_mat(frame, 0, 0), get_vec(place, 0, 0)
    count = 0
    for i in range(RAYS):
        count += int(_meets(obstacles, p, mat_vec(rotation, _direction(i)), length))
    return count
