"""Surfaces of robots and obstacles as facets, for pictures.

Facets are arrays (m, 4, 3) of corners in the world, counterclockwise as seen from outside.
"""

import math

import numpy as np

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere

AROUND = 20
"""Facets around a round body."""

ALONG = 12
"""Facets along a segment, an edge, or from pole to pole."""


def body(robot: Robot, q: Floats, least_radius: float) -> list[Floats]:
    """Facets of every segment of the robot in configuration `q` (n, 3), drawn no thinner than `least_radius`."""
    points = robot.backbone(q, ALONG)
    frames = _transported(points, robot.base[:3, 0])
    radii = [max(radius, least_radius) for radius in robot.radii]
    surfaces = []
    for k, radius in enumerate(radii):
        places = slice(k * ALONG, (k + 1) * ALONG + 1)
        rings = [_ring(p, f, radius) for p, f in zip(points[places], frames[places], strict=True)]
        if k == 0:
            rings = _cap(points[0], frames[0], radius, -1.0)[::-1] + rings
        if k == len(radii) - 1:
            rings += _cap(points[-1], frames[-1], radius, 1.0)
        surfaces.append(facets(np.stack(rings)))
    return surfaces


def _transported(points: Floats, first: Floats) -> Floats:
    """Frames (p, 2, 3) across a curve that turn about it as little as they can: two unit normals at every point."""
    tangents = np.gradient(points, axis=0)
    normals = []
    normal = first
    for tangent in tangents / np.maximum(np.linalg.norm(tangents, axis=-1, keepdims=True), 1e-300):
        across = normal - (normal @ tangent) * tangent
        size = float(np.linalg.norm(across))
        normal = across / size if size > 1e-9 else normal
        normals.append(np.stack([normal, np.cross(tangent, normal)]))
    return np.stack(normals)


def _ring(center: Floats, frame: Floats, radius: float) -> Floats:
    turn = np.linspace(0.0, 2.0 * math.pi, AROUND + 1)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    ring: Floats = center + radius * circle @ frame
    return ring


def _cap(center: Floats, frame: Floats, radius: float, side: float) -> list[Floats]:
    """Rings of the half ball in which the body ends, ahead (`side` 1) or behind (-1), outwards."""
    forward = side * np.cross(frame[0], frame[1])
    angles = np.linspace(0.0, 0.5 * math.pi, ALONG // 2 + 1)[1:]
    return [_ring(center + radius * math.sin(a) * forward, frame, radius * math.cos(a)) for a in angles]


def obstacle_surface(obstacle: Obstacle, middle: Floats, span: float) -> Floats:
    """Facets of an exact obstacle or a mesh; of a half-space a square of edge `span` near `middle`.

    Those of a mesh that the body must stay within face inwards.
    """
    if isinstance(obstacle, Mesh):
        return _of_mesh(obstacle)
    if isinstance(obstacle, HalfSpace):
        near = middle - (middle - obstacle.point) @ obstacle.normal * obstacle.normal
        local = _square(0.5 * span)
        return near + local @ obstacle.frame.rotation.T
    if not isinstance(obstacle, Primitive):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    center, rotation, half = obstacle.frame
    local = _box(half) if isinstance(obstacle, Box) else _revolved(_profile(obstacle, float(half[2])))
    surface: Floats = center + local @ rotation.T
    return surface


def _of_mesh(mesh: Mesh) -> Floats:
    """Triangles as facets whose last two corners are one; of a shell both sides."""
    corners = _cut(mesh.vertices[mesh.faces], 0.1 * float(np.ptp(mesh.vertices, axis=0).max()))
    outside, inside = corners[:, [0, 1, 2, 2]], corners[:, [2, 1, 0, 0]]
    if not mesh.watertight:
        return np.concatenate([outside, inside])
    return inside if mesh.inside else outside


def _cut(corners: Floats, longest: float) -> Floats:
    """Cut triangles (m, 3, 3) in four until no side is longer, because a picture sorts facets by their middles."""
    whole = []
    while len(corners):
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1).max(axis=1)
        whole.append(corners[sides <= longest])
        rest = corners[sides > longest]
        middles = 0.5 * (rest + np.roll(rest, -1, axis=1))
        at_corners = [np.stack([rest[:, i], middles[:, i], middles[:, i - 1]], axis=1) for i in range(3)]
        corners = np.concatenate([*at_corners, middles])
    return np.concatenate(whole)


def _profile(obstacle: Obstacle, half: float) -> Floats:
    """Outline (p, 2) of a body of revolution from pole to pole: distance from its axis, and place along it."""
    if isinstance(obstacle, Cylinder):
        wall = np.linspace(-half, half, ALONG + 1)
        corners = [[0.0, -half], *([obstacle.radius, z] for z in wall), [0.0, half]]
        return np.array(corners)
    if not isinstance(obstacle, Sphere | Capsule):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 2 * (ALONG // 2) + 2)
    outline = obstacle.radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    outline[:, 1] += np.where(angles > 0.0, half, -half)
    return outline


def _revolved(profile: Floats) -> Floats:
    turn = np.linspace(0.0, 2.0 * math.pi, AROUND + 1)
    radius, height = profile[:, :1], profile[:, 1:]
    grid = np.stack(np.broadcast_arrays(radius * np.cos(turn), radius * np.sin(turn), height), axis=-1)
    return facets(grid)


def _box(half: Floats) -> Floats:
    """Six faces; each is cut into squares, because a picture sorts facets by the distance of their middles."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            face = _square(1.0)
            face[..., 2] = side
            faces.append(np.roll(face[:, :: int(side)], axis + 1, axis=-1) * half)
    return np.concatenate(faces)


def _square(half: float) -> Floats:
    edge = np.linspace(-half, half, ALONG // 2 + 1)
    x, y = np.meshgrid(edge, edge)
    return facets(np.stack([x, y, np.zeros_like(x)], axis=-1))


def facets(grid: Floats) -> Floats:
    """Facets (m, 4, 3) of a grid of points (a, b, 3): rings, one after the other, that turn counterclockwise."""
    corners = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    return corners.reshape(-1, 4, 3)


def normals(surface: Floats) -> Floats:
    """Outward unit normals (m, 3) of facets; zero for a facet without area."""
    across = np.cross(surface[:, 2] - surface[:, 0], surface[:, 3] - surface[:, 1])
    result: Floats = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-300)
    return result


def edges(obstacle: Obstacle) -> Floats:
    """Lines (m, 2, 3) that outline an obstacle which the body must stay in: edges of a box, facets of a round one."""
    surface = obstacle_surface(obstacle, np.zeros(3), 0.0)
    if isinstance(obstacle, Box):
        corners = obstacle.center + _CORNERS * (0.5 * obstacle.size) @ obstacle.rotation.T
        return np.array([(corners[a], corners[b]) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1])
    return np.concatenate([surface[:, :2], surface[:, 1:3]])


_CORNERS = np.array([[2.0 * (i >> axis & 1) - 1.0 for axis in range(3)] for i in range(8)])
