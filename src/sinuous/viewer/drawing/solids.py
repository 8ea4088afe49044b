"""Triangles of simple solids, with the vertices shared where a surface is smooth and apart where it has an edge."""

import math
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.viewer.drawing.tube import Triangles, tube_faces

AROUND = 24


class Solid(NamedTuple):
    """Vertices (v, 3) and triangles (f, 3), counterclockwise as seen from outside."""

    vertices: Floats
    faces: Triangles


def sphere() -> Solid:
    """A ball of radius 1 about the origin."""
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, AROUND // 2 + 1)
    return _lathe(np.stack([np.cos(angles), np.sin(angles)], axis=-1))


def capsule(radius: float, half: float) -> Solid:
    """All points within `radius` of the z axis from -half to half."""
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, AROUND // 2)
    outline = radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    outline[:, 1] += np.where(angles > 0.0, half, -half)
    return _lathe(outline)


def cylinder() -> Solid:
    """A cylinder with flat ends about z, of radius 1 and length 2."""
    low, high = (-1.0, 1.0)
    return joined(
        _lathe(np.array([[1e-9, low], [1.0, low]])),
        _lathe(np.array([[1.0, low], [1.0, high]])),
        _lathe(np.array([[1.0, high], [1e-9, high]])),
    )


def cone() -> Solid:
    """A cone about z with its base of radius 1 in the plane z = 0 and its point at z = 1."""
    return joined(_lathe(np.array([[1e-9, 0.0], [1.0, 0.0]])), _lathe(np.array([[1.0, 0.0], [1e-9, 1.0]])))


def box() -> Solid:
    """A cube with edges of 2 about the origin."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            corners = np.array([[-1.0, -1.0, side], [1.0, -1.0, side], [1.0, 1.0, side], [-1.0, 1.0, side]])
            corners = corners if side > 0.0 else corners[::-1]
            faces.append(Solid(np.roll(corners, axis + 1, axis=-1), np.array([[0, 1, 2], [0, 2, 3]], np.uint32)))
    return joined(*faces)


def square() -> Solid:
    """A square with edges of 2 in the plane z = 0, that faces up."""
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    return Solid(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))


def joined(*solids: Solid) -> Solid:
    """Put several together."""
    starts = np.cumsum([0, *(len(solid.vertices) for solid in solids[:-1])])
    faces = [solid.faces + np.uint32(start) for solid, start in zip(solids, starts, strict=True)]
    return Solid(np.concatenate([solid.vertices for solid in solids]), np.concatenate(faces))


def _lathe(profile: Floats) -> Solid:
    """A surface about z; `profile` (p, 2): distance from the axis, and place along it, upwards."""
    turn = np.arange(AROUND) * (2.0 * math.pi / AROUND)
    radius, height = profile[:, :1], profile[:, 1:]
    rings = np.stack(np.broadcast_arrays(radius * np.cos(turn), radius * np.sin(turn), height), axis=-1)
    return Solid(rings.reshape(-1, 3), tube_faces(len(profile), AROUND))
