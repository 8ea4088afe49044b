"""Surfaces where a function is 0, by marching cubes in the cells about a line alone."""

import math
from collections.abc import Callable

import igl
import numpy as np

from benchmarks.places.parts.surfaces import Faces, Surface
from sinuous.base.checks import Floats

CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
"""Corners of a cell, in the order that marching cubes takes them."""

SPAN = 1 << 20


def around(places: Floats, distance: float, cell: float, signed: Callable[[Floats], Floats]) -> Surface:
    """Return the surface between points where a function is negative and where it is not.

    Parameters
    ----------
    places : ndarray (m, 3)
        No part of the surface is farther from all of them than `distance`.
    distance, cell : float
        Edge of the cells; in the length unit.
    signed : callable
        From points (k, 3) to values (k,), negative in the solid.
    """
    reach = math.ceil(distance / cell) + 2
    block = np.stack(np.meshgrid(*[np.arange(-reach, reach)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    origin = places.min(axis=0) - (reach + 1) * cell
    coarse = np.unique(((places - origin) / (2.0 * cell)).astype(np.int64), axis=0) * np.int64(2)
    cells = _distinct((coarse[:, None] + block).reshape(-1, 3))
    corners = cells[:, None] + CUBE
    nodes, numbers = np.unique(_key(corners.reshape(-1, 3)), return_inverse=True)
    points = origin + cell * _from_key(nodes)
    values = signed(points)
    numbers = numbers.reshape(-1, 8)
    mixed = np.ptp(np.sign(values)[numbers], axis=1) > 0.0
    vertices, faces, _ = igl.marching_cubes(values, points, numbers[mixed])
    return Surface(vertices, faces)


def _key(cells: Faces) -> Faces:
    """One number for every triple of whole numbers."""
    key: Faces = (cells[:, 0] * SPAN + cells[:, 1]) * SPAN + cells[:, 2]
    return key


def _from_key(key: Faces) -> Faces:
    return np.stack([key // SPAN // SPAN, key // SPAN % SPAN, key % SPAN], axis=-1)


def _distinct(cells: Faces) -> Faces:
    return _from_key(np.unique(_key(cells)))
