"""Patches that chords sweep, and points of them."""

import numpy as np

from sinuous.kernels.fields.primitives import Patch
from tests.helpers import Floats, vec


def patch_of(center: Floats, along: Floats, onward: Floats, twist: Floats) -> Patch:
    """As kernels take it."""
    return Patch(vec(center), vec(along), vec(onward), vec(twist))


def points_of(center: Floats, along: Floats, onward: Floats, twist: Floats, each: int = 9) -> Floats:
    """Points (each * each, 3) all over it."""
    a, b = np.meshgrid(*2 * [np.linspace(-1.0, 1.0, each)])
    shares = np.stack([a, b, a * b], axis=-1).reshape(-1, 3)
    points: Floats = center + shares @ np.stack([along, onward, twist])
    return points
