"""How far the body is from obstacles, place by place: for diagrams and for the colours of a page."""

import numpy as np

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.statics.body import body_of
from sinuous.statics.rest import bodies_at


def lengths_along(q: Floats, samples: int) -> Floats:
    """Lengths of backbone (..., n * samples + 1) from the base to evenly spaced places of every segment."""
    steps = np.repeat(q[..., 2] / samples, samples, axis=-1)
    return np.concatenate([np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def radii_along(robot: Robot, samples: int) -> Floats:
    """Radii (n * samples + 1,) of the body there; where two segments meet, that of the second."""
    return np.append(np.repeat(robot.radii, samples), robot.radii[-1])


def clearances(robot: Robot, scene: Snapshot, q: Floats, samples: int, times: Floats | None = None) -> Floats:
    """Distances (..., n * samples + 1) of the surface of the body from obstacles in configurations (..., n, 3).

    Those within the mount are infinite. Where obstacles move, configurations (k, n, 3) are those at `times` (k,). Of a
    loaded body it is the least of as many places each as its segment has arcs.
    """
    if robot.hangs:
        loaded, arcs = bodies_at(robot, q.reshape(-1, len(robot), 3))
        own = clearances(loaded, scene, arcs, samples, times)
        ends = samples * np.cumsum(body_of(robot).counts)
        parts = [each.reshape(len(own), samples, -1).min(axis=-1) for each in np.split(own[:, :-1], ends[:-1], axis=1)]
        return np.concatenate([*parts, own[:, -1:]], axis=1).reshape(*q.shape[:-2], -1)
    body = robot.backbone(q, samples)
    if scene.moves and times is not None:
        distances = np.stack([scene.at(t).distance(own) for t, own in zip(times.tolist(), body, strict=True)])
    else:
        distances = scene.distance(body)
    return np.where(lengths_along(q, samples) < robot.mount, np.inf, distances - radii_along(robot, samples))
