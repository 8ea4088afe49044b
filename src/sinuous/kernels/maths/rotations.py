"""Rotations as matrices of three."""

import math

from sinuous.kernels.maths.vectors import Mat, Vec, norm


def exponential(w: Vec) -> Mat:
    """The rotation about `w` by its norm, rad (Rodrigues)."""
    angle = norm(w)
    square = angle * angle
    a = math.sin(angle) / angle if angle > 1e-4 else 1.0 - square / 6.0
    b = (1.0 - math.cos(angle)) / square if angle > 1e-4 else 0.5 - square / 24.0
    x, y, z = w
    return (
        (1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y),
        (b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x),
        (b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)),
    )
