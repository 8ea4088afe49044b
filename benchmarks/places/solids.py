"""What intricate places are made of: closed surfaces, and obstacles beside a place.

Surfaces are triangles: lofts over rings, watertight because every edge is made twice, and marching cubes.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import igl
import numpy as np
from numpy.typing import NDArray

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle

Faces = NDArray[np.int64]


class Surface(NamedTuple):
    """Triangles, counterclockwise as seen from outside of the solid.

    Attributes
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
    """

    vertices: Floats
    faces: Faces

    @property
    def turned(self) -> "Surface":
        """The same triangles, seen from the other side: the wall of a hollow."""
        return Surface(self.vertices, self.faces[:, ::-1].copy())

    def mesh(self, name: str) -> Mesh:
        """Return the obstacle that it bounds, where it is closed."""
        return Mesh(self.vertices, self.faces, name=name)


CORNERS = 0.5 * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)
"""Of the cube of edge 1 about the origin, faces counterclockwise as seen from outside."""


def box_between(frame: Floats, low: Floats, high: Floats, name: str) -> sn.Box:
    """Return the box from corner `low` (3,) to corner `high` (3,) of a frame (4, 4)."""
    middle = frame[:3, 3] + frame[:3, :3] @ (0.5 * (low + high))
    return sn.Box(middle, high - low, frame[:3, :3], name=name)


def cuboid(center: Floats, size: Floats, rotation: Floats) -> Surface:
    """Return the triangles of a box with edges of lengths (3,) along the columns of a rotation (3, 3)."""
    return Surface(size * CORNERS @ rotation.T + center, FACES)


LEVEL = 1e-9
"""Cosine up to which a face, or an edge, is across a direction."""


def beside(
    kind: str, at: Floats, away: Floats, off: float, size: Floats, turn: Floats, aside: Floats | float = 0.0
) -> Obstacle:
    """Return an obstacle whose place nearest to a point is `off` away from it.

    Parameters
    ----------
    kind : str
        A `box`, a `mesh` of its triangles, a `capsule` or `cylinder` along the first axis, a `sphere`, one to stay
        `inside` of, or a `half_space`.
    at, away : ndarray (3,)
        The point, and the unit vector from there to that place.
    off : float
    size : ndarray (3,)
        Edges of a box; else the length, and what it is thick.
    turn : ndarray (3, 3)
        Rotation whose columns are the axes.
    aside : ndarray (3,)
        Where along an edge or on a face that place is, from -1 to 1 on each axis.
    """
    radius, along = 0.5 * size[1], away @ turn
    shift = 0.5 * turn @ (size * np.where(np.abs(along) > LEVEL, np.sign(along), aside))
    if kind == "half_space":
        return sn.HalfSpace(at + off * away + shift - (shift @ away) * away, -away)
    if kind in ("sphere", "inside"):
        return sn.Sphere(at + (off + (radius if kind == "sphere" else -radius)) * away, radius, inside=kind == "inside")
    if kind in ("box", "mesh"):
        middle = at + off * away + shift
        return sn.Box(middle, size, turn) if kind == "box" else sn.Mesh(*cuboid(middle, size, turn))
    axis = turn[:, 0]
    across = away if kind == "capsule" else away - along[0] * axis
    thick = float(np.linalg.norm(across))
    middle = at + off * away + (shift @ axis) * axis + (radius / thick * across if thick > LEVEL else 0.0)
    half = 0.5 * size[0] * axis
    return (sn.Capsule if kind == "capsule" else sn.Cylinder)(middle - half, middle + half, radius)


def joined(surfaces: list[Surface]) -> Surface:
    """Return all triangles of several surfaces."""
    firsts = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    faces = [surface.faces + first for surface, first in zip(surfaces, firsts, strict=True)]
    return Surface(np.concatenate([s.vertices for s in surfaces]), np.concatenate(faces))


def loft(rings: Floats, poles: Floats) -> Surface:
    """Return the skin over rings (m, s, 3), closed by a fan to a pole at each end (2, 3).

    Rings run counterclockwise as seen from the end that they lead to.
    """
    m, s = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), poles])
    first, last = np.arange(s), (m - 1) * s + np.arange(s)
    start = np.stack([np.full(s, m * s), np.roll(first, -1), first], axis=-1)
    end = np.stack([np.full(s, m * s + 1), last, np.roll(last, -1)], axis=-1)
    return Surface(vertices, np.concatenate([_bands(m, s, m - 1), start, end]))


def ring_loft(rings: Floats) -> Surface:
    """Return the skin over rings (m, s, 3) of which the last is followed by the first."""
    m, s = rings.shape[:2]
    return Surface(rings.reshape(-1, 3), _bands(m, s, m))


def _bands(m: int, s: int, count: int) -> Faces:
    """Triangles between ring k and the next of m, for the first `count` rings of s vertices."""
    k, j = np.meshgrid(np.arange(count), np.arange(s), indexing="ij")
    a, b = k * s + j, k * s + (j + 1) % s
    c, d = (k + 1) % m * s + j, (k + 1) % m * s + (j + 1) % s
    return np.concatenate([np.stack([a, b, d], axis=-1).reshape(-1, 3), np.stack([a, d, c], axis=-1).reshape(-1, 3)])


def tube(poses: Floats, radius: float, sides: int = 16, caps: int = 4) -> Surface:
    """Return the surface at `radius` around a curve given by frames (m, 4, 4), with half a ball at each end.

    No face is nearer to the curve than `radius`, but for what the steps between frames cut off.
    """
    circle, outer = outlines_of(sides)[0], radius / math.cos(math.pi / sides)
    lean = np.linspace(0.0, 0.5 * math.pi, caps + 1)[1:-1]
    rings = [_ring(poses[0], outer * math.cos(a) * circle, -outer * math.sin(a)) for a in lean[::-1]]
    rings += [_ring(pose, outer * circle, 0.0) for pose in poses]
    rings += [_ring(poses[-1], outer * math.cos(a) * circle, outer * math.sin(a)) for a in lean]
    ends = [poses[0, :3, 3] - outer * poses[0, :3, 2], poses[-1, :3, 3] + outer * poses[-1, :3, 2]]
    return loft(np.array(rings), np.array(ends))


def ball(center: Floats, radius: float, sides: int) -> Surface:
    """Return a ball of `2 * sides * (sides - 1)` triangles."""
    lean = math.pi * np.arange(1, sides)[:, None] / sides
    turn = 2.0 * math.pi * np.arange(sides) / sides
    height = np.broadcast_to(-np.cos(lean), (sides - 1, sides))
    rings = np.stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), height], axis=-1)
    poles = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    return loft(center + radius * rings, center + radius * poles)


def hollow(poses: Floats, inside: float, outside: float) -> Surface:
    """Return the wall between two radii around a curve, closed by half a ball at each end."""
    return joined([tube(poses, outside), tube(poses, inside).turned])


def open_tube(
    poses: Floats, inside: float | Floats, outside: float | Floats, bottom: bool = False, sides: int = 16
) -> Surface:
    """Return the wall between two radii, or radii (m,), around a curve given by frames (m, 4, 4).

    It is open at both ends, or (`bottom`) only at the last one.
    """
    circle, widen = outlines_of(sides)[0], 1.0 / math.cos(math.pi / sides)
    radii = np.broadcast_to(outside, len(poses)), np.broadcast_to(inside, len(poses))
    outer, inner = ([_ring(pose, widen * r * circle, 0.0) for pose, r in zip(poses, own, strict=True)] for own in radii)
    if not bottom:
        return ring_loft(np.array([*outer, *inner[::-1]]))
    start, tangent, wall = poses[0, :3, 3], poses[0, :3, 2], float(radii[0][0] - radii[1][0])
    behind = _ring(poses[0], float(radii[0][0]) * widen * circle, -wall)
    return loft(np.array([behind, *outer, *inner[::-1]]), np.array([start - wall * tangent, start]))


def _ring(pose: Floats, outline: Floats, ahead: float) -> Floats:
    """Points (s, 3) of an outline (s, 2) across the z axis of a pose, so far ahead."""
    ring: Floats = np.column_stack([outline, np.full(len(outline), ahead)]) @ pose[:3, :3].T + pose[:3, 3]
    return ring


def layered(pose: Floats, outlines: Sequence[tuple[Floats, float]], poles: Sequence[Floats] = ()) -> Surface:
    """Return the skin over outlines (s, 2), each across the z axis of `pose` at a height of its own.

    The last is followed by the first, or both are closed by a fan to one of two poles (3,).
    """
    rings = np.stack([_ring(pose, outline, height) for outline, height in outlines])
    return loft(rings, np.array(poles) @ pose[:3, :3].T + pose[:3, 3]) if len(poles) else ring_loft(rings)


def blind_bore(pose: Floats, hole: float, depth: float, half: float, bottom: float, sides: int = 24) -> Surface:
    """Return a block with a bore of radius `hole` from the origin of `pose` along z, closed at `depth`.

    The block is square, with half the edge `half`, and goes on `bottom` beyond the bore. `sides` as for `plate`.
    """
    circle, square = outlines_of(sides)
    inner, outer = hole / math.cos(math.pi / sides) * circle, half * square
    outlines = [(outer, depth + bottom), (outer, 0.0), (inner, 0.0), (inner, depth)]
    return layered(pose, outlines, [np.array([0.0, 0.0, height]) for height in (depth + bottom, depth)]).turned


def plate(pose: Floats, half: float, hole: float | Floats, thickness: float, sides: int = 24) -> Surface:
    """Return a square plate across the z axis of `pose`, with a hole around it.

    `hole` is a radius, or that of its outline in each of the directions (sides,) of `outlines_of`. `sides`, a multiple
    of 8, is also how often the outline is cut, so that it has its corners.
    """
    circle, square = outlines_of(sides)
    inner = np.broadcast_to(hole, sides)[:, None] / math.cos(math.pi / sides) * circle
    low, high = -0.5 * thickness, 0.5 * thickness
    return layered(pose, [(inner, low), (half * square, low), (half * square, high), (inner, high)])


def outlines_of(sides: int) -> tuple[Floats, Floats]:
    """Points (sides, 2) of the circle of radius 1 and of the square around it, in the same directions."""
    turn = 2.0 * math.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return circle, circle / np.abs(circle).max(axis=1, keepdims=True)


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
