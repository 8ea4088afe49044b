"""Places of the body, by matrix exponentials."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.robot.robot import Robot

SAMPLES = 200
"""Places on every segment where the body is looked at."""


def arc_poses(q: Floats, pieces: int) -> Floats:
    """Poses (pieces + 1, 4, 4) along one segment `q` (3,), by powers of the exponential of its twist."""
    from scipy.linalg import expm  # noqa: PLC0415

    ux, uy, length = q
    twist = np.array([[0, 0, ux, 0], [0, 0, uy, 0], [-ux, -uy, 0, length], [0, 0, 0, 0]], np.float64)
    step = expm(twist / pieces)
    poses = [np.eye(4)]
    for _ in range(pieces):
        poses.append(poses[-1] @ step)
    return np.stack(poses)


def segment_ends(robot: Robot, q: Floats) -> Floats:
    """Poses (n + 1, 4, 4) of the base and of the ends of all segments."""
    poses = [robot.base]
    for segment in q:
        poses.append(poses[-1] @ arc_poses(segment, 1)[1])
    return np.stack(poses)


def body_places(robot: Robot, q: Floats, ends: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Sampled places (m, 3) of the backbone beyond the mount, and the segment (m,), 0 = first, that each is on."""
    places, segments = [], []
    before = 0.0
    for k, segment in enumerate(q):
        length = float(segment[2])
        free = before + np.linspace(0.0, length, SAMPLES + 1) >= robot.mount
        places.append((ends[k] @ arc_poses(segment, SAMPLES))[free, :3, 3])
        segments.append(np.full(len(places[-1]), k))
        before += length
    return np.concatenate(places), np.concatenate(segments)
