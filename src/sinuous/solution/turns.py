"""What turns one orientation into another."""

import math

import numpy as np

from sinuous.checks import Floats

PARALLEL = 1e-9
"""Sine of the angle below which two directions have no common normal that could be computed."""


def turn_between(before: Floats, after: Floats) -> Floats:
    """The rotation vector (3,), rad, that turns a unit vector (3,) or a rotation (3, 3) into another one.

    Of two opposite unit vectors it is a turn by pi about some normal of them.
    """
    if before.ndim == 2:
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        return Rotation.from_matrix(after @ before.T).as_rotvec()
    axis, cosine = np.cross(before, after), float(before @ after)
    sine = float(np.linalg.norm(axis))
    if sine > PARALLEL:
        return axis * (math.atan2(sine, cosine) / sine)
    if cosine > 0.0:
        return axis
    across = np.cross(before, np.eye(3)[np.abs(before).argmin()])
    return math.pi * across / np.linalg.norm(across)
