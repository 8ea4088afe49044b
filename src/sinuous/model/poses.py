"""Poses as 4x4 matrices, and the ways to state one."""

import math
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Orientation, Orientations, Rows, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError

ROTATION_SLACK = 1e-6
"""How far, in any entry, a matrix may be from a rotation (numbers in files are rounded); it is then made exact."""


POSE = "4 rows of 4 finite numbers, as sn.pose(position, direction=) gives them"

EXACT = 1e-14
"""A matrix as near to a rotation as this is one up to rounding, and is kept, so that it can be written and read."""


LARGE = 2.0
"""No entry of a rotation is nearly as large."""


def rotation_matrix(key: str, value: Any) -> Floats:
    """Read a rotation: 3x3, a quaternion wxyz of any length but zero, or a `Rotation` of SciPy; return exact 3x3."""
    if callable(getattr(value, "as_matrix", None)):  # without importing SciPy to ask
        value = value.as_matrix()
    try:
        shape = np.shape(value)
    except ValueError:
        shape = ()
    if shape not in ((4,), (3, 3)):
        raise InputError(key, "", value, "a 3x3 rotation matrix or a quaternion [w, x, y, z]")
    if shape == (4,):
        result = _from_quaternion(*checks.direction(key, value, 4).tolist())
    else:
        result = _nearest_rotation(key, checks.array(key, value, (3, 3)))
    return checks.closed(result)


def any_rotation(rotation: Orientation | None, xyzw: Vector | None) -> Floats | None:
    """Read a rotation from the arguments of these names, of which at most one is given; `None` without any."""
    if xyzw is None:
        return None if rotation is None else rotation_matrix("rotation", rotation)
    _refuse_both(rotation, xyzw)
    x, y, z, w = checks.direction("xyzw", xyzw, 4).tolist()
    return rotation_matrix("xyzw", (w, x, y, z))


def any_rotations(rotations: Orientations | None, xyzw: Rows | None, key: str = "rotations") -> Floats | None:
    """Read many rotations (m, 3, 3) as `any_rotation` reads one; `key` is what the first argument is called."""
    if xyzw is None:
        return None if rotations is None else rotation_matrices(key, rotations)
    _refuse_both(rotations, xyzw, key)
    return rotation_matrices("xyzw", np.roll(checks.directions("xyzw", xyzw, 4), 1, axis=1))


def _refuse_both(rotation: Any, xyzw: Any, key: str = "rotation") -> None:
    if rotation is not None:
        raise InputError("xyzw", f"cannot be combined with {key}", xyzw, f"one of {key}, xyzw")


def rotation_matrices(key: str, value: Any) -> Floats:
    """Read rotations (m, 3, 3), quaternions (m, 4) or a `Rotation` of SciPy as `rotation_matrix` reads one."""
    if callable(getattr(value, "as_matrix", None)):
        value = value.as_matrix()
    try:
        axes = np.ndim(value)
    except ValueError:
        axes = 0
    if axes == 2:
        result = np.moveaxis(_from_quaternion(*checks.directions(key, value, 4).T), -1, 0).copy()
    elif axes == 3:
        result = _nearest_rotations(key, checks.rows(key, value, 3, 3))
    else:
        raise InputError(key, "", value, "3x3 rotation matrices or quaternions [w, x, y, z]")
    return checks.closed(result)


def _from_quaternion(w: Any, x: Any, y: Any, z: Any) -> Floats:
    """Rotation (3, 3) of a unit quaternion; of arrays (m,) of their parts, rotations (3, 3, m)."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _nearest_rotation(key: str, matrix: Floats) -> Floats:
    rows = matrix.tolist()
    small = max(max(map(abs, row)) for row in rows) < LARGE
    off = max(_gaps(*rows)) if small and _determinant(*rows) >= 0.0 else math.inf
    if off > ROTATION_SLACK:
        raise InputError(key, "", rows, "a rotation: orthonormal rows and determinant 1")
    return _exact(matrix[None], np.array([off]))[0]


def _nearest_rotations(key: str, matrices: Floats) -> Floats:
    """Rotations (m, 3, 3), each to the last bit as `_nearest_rotation` makes it."""
    small = np.abs(matrices).max(axis=(1, 2), initial=0.0) < LARGE
    rows = np.moveaxis(np.where(small[:, None, None], matrices, 0.0), 0, -1)
    off = np.where(small & (_determinant(*rows) >= 0.0), np.max(_gaps(*rows), axis=0), np.inf)
    if (off > ROTATION_SLACK).any():
        first = int(np.argmax(off > ROTATION_SLACK))
        _nearest_rotation(f"{key}[{first}]", matrices[first])
    return _exact(matrices, off)


def _gaps(x: Any, y: Any, z: Any) -> list[Any]:
    """How far the products of rows are from those of a rotation; of numbers, or of arrays (m,) of them."""
    wanted = ((x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0))
    return [abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - value) for a, b, value in wanted]


def _determinant(x: Any, y: Any, z: Any) -> Any:
    """Determinant of rows of numbers, or of arrays (m,) of them."""
    return z[0] * (x[1] * y[2] - x[2] * y[1]) + z[1] * (x[2] * y[0] - x[0] * y[2]) + z[2] * (x[0] * y[1] - x[1] * y[0])


def _exact(matrices: Floats, off: Floats) -> Floats:
    """Make matrices (m, 3, 3) exact rotations; those that are, up to rounding, are kept."""
    result = matrices.copy()
    loose = off > EXACT
    if loose.any():
        u, _, vt = np.linalg.svd(matrices[loose])
        result[loose] = u @ vt
    return result


def least_rotation(direction: Floats) -> Floats:
    """Return the rotation that takes +z to a unit vector the shortest way; for -z, half a turn about x."""
    x, y, z = direction.tolist()
    if math.hypot(x, y) < 1e-100:
        return np.diag([1.0, 1.0, 1.0]) if z > 0.0 else np.diag([1.0, -1.0, -1.0])
    # Rodrigues with axis (-y, x, 0); (1 - z) / (x^2 + y^2) without cancellation on either side.
    side = x * x + y * y
    c = 1.0 / (1.0 + z) if z > -0.5 else (1.0 - z) / side
    return np.array([[1.0 - c * x * x, -c * x * y, x], [-c * x * y, 1.0 - c * y * y, y], [-x, -y, z]])


def least_rotations(directions: Floats) -> Floats:
    """Return what `least_rotation` does (m, 3, 3), of many unit vectors (m, 3)."""
    x, y, z = directions.T
    side = x * x + y * y
    upright = np.hypot(x, y) < 1e-100
    c = np.where(z > -0.5, 1.0 / np.where(z > -0.5, 1.0 + z, 1.0), (1.0 - z) / np.where(upright, 1.0, side))
    turns = np.array([[1.0 - c * x * x, -c * x * y, x], [-c * x * y, 1.0 - c * y * y, y], [-x, -y, z]])
    turns[:, :, upright] = np.eye(3)[:, :, None]
    turns[1, 1, upright] = turns[2, 2, upright] = np.where(z[upright] > 0.0, 1.0, -1.0)
    return np.moveaxis(turns, -1, 0)


def pose(
    position: Vector | None = None,
    *,
    direction: Vector | None = None,
    rotation: Orientation | None = None,
    xyzw: Vector | None = None,
    matrix: Rows | None = None,
) -> Floats:
    """Make a pose, a 4x4 matrix.

    Parameters
    ----------
    position : array_like (3,), optional
        Where, in the world; default the origin.
    direction : array_like (3,), optional
        Where its z axis points; x and y follow by the least rotation from +z (for -z: half a turn about x).
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        Rotation matrix, or quaternion wxyz.
    xyzw : array_like (4,), optional
        Quaternion in the order of SciPy and ROS, instead of `rotation`.
    matrix : array_like (4, 4), optional
        The whole pose; nothing else may be given then.

    Raises
    ------
    InputError
        When something is not finite, has the wrong shape, is no rotation, or says the same thing twice.
    """
    given = [
        name
        for name, value in (("direction", direction), ("rotation", rotation), ("xyzw", xyzw), ("matrix", matrix))
        if value is not None
    ]
    if len(given) > 1:
        raise InputError(
            given[1], "cannot be combined with another orientation", given, "one of direction, rotation, xyzw, matrix"
        )
    result = np.eye(4)
    if matrix is not None:
        if position is not None:
            raise InputError("position", "cannot be combined with matrix", position, "one of position, matrix")
        whole = checks.array("matrix", matrix, (4, 4), POSE)
        if not np.array_equal(whole[3], [0.0, 0.0, 0.0, 1.0]):
            raise InputError("matrix", "last row is wrong", whole[3].tolist(), "[0, 0, 0, 1]")
        result[:3, :3] = _nearest_rotation("matrix", whole[:3, :3])
        position = whole[:3, 3]
    elif direction is not None:
        result[:3, :3] = least_rotation(checks.direction("direction", direction))
    else:
        turned = any_rotation(rotation, xyzw)
        result[:3, :3] = np.eye(3) if turned is None else turned
    if position is not None:
        result[:3, 3] = checks.vector("position", position)
    return checks.closed(result)


def is_pose(value: Any) -> bool:
    """Whether a value has the shape of a pose (4, 4), whatever is in it."""
    if isinstance(value, (list, tuple)):
        return len(value) == 4 and all(isinstance(row, (list, tuple, np.ndarray)) and len(row) == 4 for row in value)
    return getattr(value, "shape", None) == (4, 4)


def as_pose(key: str, value: Any) -> Floats:
    """Check a 4x4 matrix that stands for a pose; `None` is the identity."""
    with checks.inside(key):
        return pose() if value is None else pose(matrix=value)


def rotation_of(turn: Floats) -> Floats:
    """Rotation matrix of a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn.tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    half: float = float(np.sinc(0.5 * angle / math.pi))
    return np.eye(3) + float(np.sinc(angle / math.pi)) * cross + 0.5 * half * half * cross @ cross
