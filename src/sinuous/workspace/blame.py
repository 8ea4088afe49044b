"""Which obstacle is in the way."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot

SAMPLES = 6
"""Places of a segment that are looked at."""

TOGETHER = 20_000


def nearest(scene: Snapshot, points: Floats) -> NDArray[np.int16]:
    """Numbers (m,) of the obstacles nearest to points (m, 3)."""
    return np.asarray(scene.nearest(points), np.int16)


def deepest(robot: Robot, scene: Snapshot, q: NDArray[np.float32]) -> NDArray[np.int16]:
    """Numbers (m,) of the obstacles that bodies (m, n, 3) run into deepest, by some places of each segment."""
    found = np.empty(len(q), np.int16)
    radii = np.repeat(np.array(robot.radii), SAMPLES)
    for first in range(0, len(q), TOGETHER):
        some = q[first : first + TOGETHER].astype(np.float64)
        points = robot.backbone(some, SAMPLES)[:, 1:]
        along = np.cumsum(np.repeat(some[..., 2] / SAMPLES, SAMPLES, axis=1), axis=1)
        gaps = np.where(along >= robot.mount, scene.distance(points) - radii, np.inf)
        worst = gaps.argmin(axis=1)
        found[first : first + TOGETHER] = scene.nearest(points[np.arange(len(some)), worst])
    return found
