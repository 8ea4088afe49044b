"""Obstacles of every kind about given bodies: some just beside them, some anywhere, now and then a room around all."""

import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges.kinematics import body_places, body_points
from benchmarks.places.parts.surfaces import CORNERS, FACES, Surface
from benchmarks.problems import in_ball
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.model.poses import least_rotation
from sinuous.scene.obstacles import Obstacle

COUNTS = ((0, 1), (1, 8), (8, 61))
"""Ranges of the number of obstacles, each without its end."""

COUNT_SHARES = (0.15, 0.4, 0.45)

KINDS = {"sphere": 0.34, "box": 0.25, "capsule": 0.17, "cylinder": 0.18, "half_space": 0.06}

RICH = 0.02
"""Share of scenes with a mesh, and of those with a cloud: preparing them takes longer than all the rest."""

SAMPLES = 12
"""Intervals of a segment at whose ends obstacles are kept off the bodies while a scene is drawn."""


def scene_about(robot: sn.Robot, q: Floats, rng: Generator) -> sn.Scene:
    """Draw a scene in which the bodies of configurations (m, n, 3) are clear, as far as samples of them say."""
    (points, radii), unit = _bodies(robot, q), robot.mean_length
    low, high = COUNTS[rng.choice(len(COUNTS), p=COUNT_SHARES)]
    count = int(rng.integers(low, high))
    drawn: list[Obstacle] = []
    if count and rng.random() < 0.2:
        drawn.append(_room(points, radii, unit, rng))
    kinds = rng.choice(list(KINDS), p=list(KINDS.values()), size=max(0, count - len(drawn)))
    drawn += [_solid(str(kind), *_place(points, radii, unit, rng), unit, rng) for kind in kinds]
    if count and rng.random() < RICH:
        drawn.append(_mesh(_place(points, radii, unit, rng), unit, rng))
    if count and rng.random() < RICH:
        cloud = points.mean(axis=0) + unit * np.array([in_ball(rng) for _ in range(100)])
        drawn.append(sn.PointCloud(_clear_of(points, radii, cloud, 0.02 * unit), 0.01 * unit))
    return sn.Scene([obstacle for obstacle in drawn if (measure(obstacle, points) > radii).all()])


def _bodies(robot: sn.Robot, q: Floats) -> tuple[Floats, Floats]:
    """Points (k, 3) of all backbones beyond the mount, and of links, and the radius (k,) of the body at each."""
    if robot.joints:
        bodies = body_places(robot, q, SAMPLES) or [(0, robot.base[None, None, :3, 3], 0.0)]
        radii = [np.full(points[..., 0].size, radius) for _, points, radius in bodies]
        return np.concatenate([points.reshape(-1, 3) for _, points, _ in bodies]), np.concatenate(radii)
    points, along = body_points(robot, q, SAMPLES)
    exposed = along >= robot.mount
    if not exposed.any():
        exposed[..., -1, -1] = True
    return points[exposed], np.broadcast_to(np.array(robot.radii)[:, None], along.shape)[exposed]


def _clear_of(points: Floats, radii: Floats, centers: Floats, room: float) -> Floats:
    """Those of the centers, or a far one, that leave the bodies some room."""
    gaps = np.linalg.norm(centers[:, None] - points, axis=-1) - radii
    kept = centers[gaps.min(axis=1) > room]
    return np.asarray(kept if len(kept) else points[:1] + 1e3 * (room + np.abs(points - points[0]).max()))


def _place(points: Floats, radii: Floats, unit: float, rng: Generator) -> tuple[Floats, Floats, float]:
    """Draw a place, the direction away from the body, and how far off the backbone an obstacle there has to begin."""
    i = rng.integers(len(points))
    away = in_ball(rng)
    away /= np.linalg.norm(away)
    gap = unit * (10.0 ** rng.uniform(-4.0, -1.0) if rng.random() < 0.5 else rng.uniform(0.0, 0.8))
    return points[i], away, float(radii[i]) + gap


def _solid(kind: str, at: Floats, away: Floats, off: float, unit: float, rng: Generator) -> Obstacle:
    """Draw an obstacle that begins `off` from a place: its extent towards it is that of its support."""
    radius = unit * rng.uniform(0.01, 0.15)
    if kind == "sphere":
        return sn.Sphere(at + (off + radius) * away, radius)
    if kind == "half_space":
        return sn.HalfSpace(at + off * away, -away)
    rotation = least_rotation(away) @ _turn(rng)
    if kind == "box":
        size = unit * rng.uniform(0.02, 0.5, 3)
        return sn.Box(at + (off + 0.5 * float(np.abs(away @ rotation) @ size)) * away, size, rotation)
    half = 0.5 * unit * rng.uniform(0.05, 1.0) * rotation[:, 0]
    radius *= 0.5
    middle = at + (off + abs(float(half @ away)) + radius) * away
    return (sn.Capsule if kind == "capsule" else sn.Cylinder)(middle - half, middle + half, radius)


def _turn(rng: Generator) -> Floats:
    """Draw a rotation; every other one about z alone, which leaves long obstacles across."""
    return pose_rotation(rng.normal(size=4) * ([1.0, 0.0, 0.0, 1.0] if rng.random() < 0.5 else 1.0))


def pose_rotation(quaternion: Floats) -> Floats:
    """Rotation (3, 3) of a quaternion of any norm."""
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


def _room(points: Floats, radii: Floats, unit: float, rng: Generator) -> Obstacle:
    """Draw a room that holds all bodies: a box, a ball, a cylinder, or a box of triangles."""
    rotation = pose_rotation(rng.normal(size=4))
    local = points @ rotation
    low, high = (local - radii[:, None]).min(axis=0), (local + radii[:, None]).max(axis=0)
    room = unit * 10.0 ** rng.uniform(-3.0, 0.0, 3)
    middle, half = rotation @ (0.5 * (low + high)), 0.5 * (high - low) + room
    kind = rng.choice(["box", "ball", "cylinder", "mesh"], p=[0.5, 0.23, 0.23, 0.04])
    if kind == "box":
        return sn.Box(middle, 2.0 * half, rotation, inside=True)
    if kind == "ball":
        return sn.Sphere(middle, float((np.linalg.norm(points - middle, axis=1) + radii).max() + room[0]), inside=True)
    if kind == "cylinder":
        across = local[:, :2] - (rotation.T @ middle)[:2]
        radius = float((np.linalg.norm(across, axis=1) + radii).max() + room[0])
        return sn.Cylinder(middle - half[2] * rotation[:, 2], middle + half[2] * rotation[:, 2], radius, inside=True)
    return _block(middle, half, rotation, inside=True)


def _mesh(place: tuple[Floats, Floats, float], unit: float, rng: Generator) -> sn.Mesh:
    at, away, off = place
    half = unit * rng.uniform(0.02, 0.2, 3)
    rotation = pose_rotation(rng.normal(size=4))
    return _block(at + (off + float(np.abs(away @ rotation) @ half)) * away, half, rotation)


def _block(middle: Floats, half: Floats, rotation: Floats, inside: bool = False) -> sn.Mesh:
    """Return a box of triangles."""
    return sn.Mesh(*block_surface(middle, half, rotation), inside=inside)


def block_surface(middle: Floats, half: Floats, rotation: Floats) -> Surface:
    """Return the triangles of a box with these halves of edges (3,) along the columns of a rotation (3, 3)."""
    return Surface(2.0 * half * CORNERS @ rotation.T + middle, FACES)
