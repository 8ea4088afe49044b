"""How far the body is from obstacles, place by place: for diagrams and for the colours of a page."""

import numpy as np

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot


def lengths_along(q: Floats, samples: int) -> Floats:
    """Lengths of backbone (..., n * samples + 1) from the base to evenly spaced places of every segment."""
    steps = np.repeat(q[..., 2] / samples, samples, axis=-1)
    return np.concatenate([np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def radii_along(robot: Robot, samples: int) -> Floats:
    """Radii (n * samples + 1,) of the body there; where two segments meet, that of the second."""
    return np.append(np.repeat(robot.radii, samples), robot.radii[-1])


def clearances(robot: Robot, scene: Snapshot, q: Floats, samples: int, times: Floats | None = None) -> Floats:
    """Distances (..., n * samples + 1) of the surface of the body from obstacles in configurations (..., n, 3).

    Those within the mount are infinite. Where obstacles move, configurations (k, n, 3) are those at `times` (k,).
    """
    body = robot.backbone(q, samples)
    if scene.moves and times is not None:
        distances = np.stack([scene.at(t).distance(own) for t, own in zip(times.tolist(), body, strict=True)])
    else:
        distances = scene.distance(body)
    return np.where(lengths_along(q, samples) < robot.mount, np.inf, distances - radii_along(robot, samples))
