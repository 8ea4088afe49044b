"""The surface of a robot as facets: its segments, what it stands on, and its tool."""

import math
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.pictures.shapes.facets import lathe, of_grid, ring
from sinuous.robot.robot import Robot

AROUND = 20
"""Facets around the body."""

ALONG = 12
"""Facets along a segment; a robot of many segments has fewer each."""

MOST_ALONG = 240
"""Facets along the whole body, but for robots of so many segments that one each is more."""

FLANGE, PLATE = 1.6, 0.5
"""Radius and thickness of what the robot stands on, in radii of its body."""

SLEEVE = 1.25
"""Radius of the mount, in radii of the body."""

STEM = 0.3
"""Radius of the tool, which has no body, in radii of the last segment."""


class Surface(NamedTuple):
    """A robot in one configuration, as facets.

    Attributes
    ----------
    segments : list of ndarray (m, 4, 3)
        Base to tip.
    fittings : ndarray (m, 4, 3)
        What is no body: flange, mount, tool.
    """

    segments: list[Floats]
    fittings: Floats


def surface(robot: Robot, q: Floats, least_radius: float) -> Surface:
    """Facets of a robot in configuration `q` (n, 3); nothing is drawn thinner than `least_radius`."""
    radii = [max(radius, least_radius) for radius in robot.radii]
    return Surface(tube(robot, q, radii), _fittings(robot, q, radii))


def along(robot: Robot) -> int:
    """Facets along each segment."""
    return max(1, min(ALONG, MOST_ALONG // len(robot)))


def tube(robot: Robot, q: Floats, radii: list[float]) -> list[Floats]:
    """Facets of every segment: a tube of its radius, the last with half a ball at its end."""
    count = along(robot)
    points = robot.backbone(q, count)
    frames = _transported(points, robot.base[:3, :3])
    surfaces = []
    for k, radius in enumerate(radii):
        places = slice(k * count, (k + 1) * count + 1)
        rings = [ring(p, f, radius, AROUND) for p, f in zip(points[places], frames[places], strict=True)]
        if k == 0:
            rings = _cap(points[0], frames[0], radius, -1.0)[::-1] + rings
        if k == len(radii) - 1:
            rings += _cap(points[-1], frames[-1], radius, 1.0)
        surfaces.append(of_grid(np.stack(rings)))
    return surfaces


def _transported(points: Floats, base: Floats) -> Floats:
    """Frames (p, 2, 3) across a curve that turn about it as little as they can: two unit normals at every point."""
    tangents = np.gradient(points, axis=0)
    tangents /= np.maximum(np.linalg.norm(tangents, axis=-1, keepdims=True), 1e-300)
    frames = []
    normal, before = base[:, 0], base[:, 2]
    for tangent in tangents:
        if not tangent.any():  # a segment of no length
            tangent = before  # noqa: PLW2901
        across = normal - (normal @ tangent) * tangent
        size = float(np.linalg.norm(across))
        normal, before = across / size if size > 1e-9 else normal, tangent
        frames.append(np.stack([normal, np.cross(tangent, normal)]))
    return np.stack(frames)


def _cap(center: Floats, frame: Floats, radius: float, side: float) -> list[Floats]:
    """Rings of the half ball in which the body ends, ahead (`side` 1) or behind (-1), outwards."""
    forward = side * np.cross(frame[0], frame[1])
    angles = np.linspace(0.0, 0.5 * math.pi, ALONG // 2 + 1)[1:]
    return [ring(center + radius * math.sin(a) * forward, frame, radius * math.cos(a), AROUND) for a in angles]


def _fittings(robot: Robot, q: Floats, radii: list[float]) -> Floats:
    """Flange behind the base, a sleeve over the mount, and the tool."""
    first, last = radii[0], radii[-1]
    plate = np.array([[0.0, -PLATE], [FLANGE, -PLATE], [FLANGE, 0.0], [0.0, 0.0]]) * first
    plate[:, 1] -= first  # behind the ball in which the body ends
    parts = [lathe(plate, AROUND) @ robot.base[:3, :3].T + robot.base[:3, 3]]
    if robot.mount > 0.0:
        parts.append(_sleeve(robot, q, first * SLEEVE))
    tip, tool = robot.forward(q)[-1, :3, 3], robot.tip(q)
    if np.linalg.norm(tool[:3, 3] - tip) > 0.0:
        parts.append(_stem(tip, tool, last * STEM))
    return np.concatenate(parts)


def _sleeve(robot: Robot, q: Floats, radius: float) -> Floats:
    """A tube around the length of backbone that obstacles do not concern."""
    count = 8 * along(robot)
    lengths = np.repeat(q[:, 2] / count, count)
    inside = np.concatenate([[0.0], np.cumsum(lengths)]) <= robot.mount
    points = robot.backbone(q, count)[inside]
    if len(points) < 2:
        points = np.stack([robot.base[:3, 3], robot.base[:3, 3] + robot.mount * robot.base[:3, 2]])
    frames = _transported(points, robot.base[:3, :3])
    rings = [ring(p, f, radius, AROUND) for p, f in zip(points, frames, strict=True)]
    rings.append(ring(points[-1], frames[-1], 0.0, AROUND))
    return of_grid(np.stack(rings))


def _stem(tip: Floats, tool: Floats, radius: float) -> Floats:
    """A thin cone from the tip of the body to the point of the tool."""
    axis = tool[:3, 3] - tip
    forward = axis / np.linalg.norm(axis)
    side = np.cross(forward, np.eye(3)[np.abs(forward).argmin()])
    side /= np.linalg.norm(side)
    frame = np.stack([side, np.cross(forward, side)])
    outline = ((0.0, 1.0), (0.7, 0.8), (1.0, 0.0))
    rings = [ring(tip + share * axis, frame, radius * size, AROUND) for share, size in outline]
    return of_grid(np.stack(rings))
