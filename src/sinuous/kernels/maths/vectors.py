"""Vectors of three and matrices of three by three as tuples: they live in registers and compile to nothing.

A matrix is a tuple of its rows.

Tables are read and written by rows: `array` (r, c), `source` (r, c), `out` (r, c).
"""

import math

import numpy as np

Vec = tuple[float, float, float]
Mat = tuple[Vec, Vec, Vec]
Array = np.ndarray

ZERO: Vec = (0.0, 0.0, 0.0)
IDENTITY: Mat = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NOTHING: Mat = (ZERO, ZERO, ZERO)

TINY = 1e-300
"""What is added to a square that may be 0 before it divides."""


def add(a: Vec, b: Vec) -> Vec:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a: Vec, b: Vec) -> Vec:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(s: float, a: Vec) -> Vec:
    return (s * a[0], s * a[1], s * a[2])


def add_scaled(a: Vec, s: float, b: Vec) -> Vec:
    """a + s b."""
    return (a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2])


def dot(a: Vec, b: Vec) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a: Vec) -> float:
    return math.sqrt(dot(a, a))


def across(a: Vec) -> tuple[Vec, Vec]:
    """Two unit vectors that make a right-handed frame with the unit vector `a` as the third (Duff et al. 2017)."""
    sign = math.copysign(1.0, a[2])
    c = -1.0 / (sign + a[2])
    d = a[0] * a[1] * c
    return (1.0 + sign * a[0] * a[0] * c, sign * d, -sign * a[0]), (d, sign + a[1] * a[1] * c, -a[1])


def transpose(m: Mat) -> Mat:
    return (m[0][0], m[1][0], m[2][0]), (m[0][1], m[1][1], m[2][1]), (m[0][2], m[1][2], m[2][2])


def mat_vec(m: Mat, a: Vec) -> Vec:
    return (dot(m[0], a), dot(m[1], a), dot(m[2], a))


def vec_mat(a: Vec, m: Mat) -> Vec:
    """The product of the transpose of `m` with `a`."""
    return add_scaled(add_scaled(scale(a[0], m[0]), a[1], m[1]), a[2], m[2])


def mat_mat(m: Mat, n: Mat) -> Mat:
    return vec_mat(m[0], n), vec_mat(m[1], n), vec_mat(m[2], n)


def add_outer(m: Mat, a: Vec, b: Vec) -> Mat:
    """m + a b'."""
    return add_scaled(m[0], a[0], b), add_scaled(m[1], a[1], b), add_scaled(m[2], a[2], b)


def get_vec(array: Array, i: int, j: int) -> Vec:
    """Read three numbers of row `i` from column `j` on."""
    return (array[i, j], array[i, j + 1], array[i, j + 2])


def put_vec(array: Array, i: int, j: int, a: Vec) -> None:
    array[i, j] = a[0]
    array[i, j + 1] = a[1]
    array[i, j + 2] = a[2]


def get_mat(array: Array, i: int, j: int) -> Mat:
    """Read nine numbers of row `i` from column `j` on, row by row."""
    return get_vec(array, i, j), get_vec(array, i, j + 3), get_vec(array, i, j + 6)


def put_mat(array: Array, i: int, j: int, m: Mat) -> None:
    put_vec(array, i, j, m[0])
    put_vec(array, i, j + 3, m[1])
    put_vec(array, i, j + 6, m[2])


def copy(source: Array, out: Array) -> None:
    """Copy a table, row by row."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            out[i, j] = source[i, j]
