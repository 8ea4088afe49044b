"""A roll about the tangent."""

import math

from sinuous.kernels.maths.vectors import Mat


def about_z(angle: float) -> Mat:
    """The rotation about z by an angle, rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return (cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)
