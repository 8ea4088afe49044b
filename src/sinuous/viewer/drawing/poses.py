"""Rotations as pages take them."""

import numpy as np
from viser.transforms import SO3

from sinuous.checks import Floats

Quaternion = tuple[float, float, float, float]


def wxyz(rotation: Floats) -> Floats:
    """Quaternion (4,) of a rotation (3, 3)."""
    quaternion: Floats = np.asarray(SO3.from_matrix(rotation).wxyz, np.float64)
    return quaternion


def rotation_of(quaternion: Floats) -> Floats:
    """Rotation (3, 3) of a quaternion wxyz of any length but zero."""
    matrix: Floats = np.asarray(SO3(quaternion / np.linalg.norm(quaternion)).as_matrix(), np.float64)
    return matrix
