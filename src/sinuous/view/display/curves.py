"""Clearances along the body, and what changes along a motion: for diagrams, colours and plots."""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.timing import largest
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
    if robot.has_external_load:
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


class Curves(NamedTuple):
    """Values over time.

    Attributes
    ----------
    title : str
    times : ndarray (T,)
    values : ndarray (T, c)
    names : tuple of str
        Of the curves.
    unit : str
    """

    title: str
    times: Floats
    values: Floats
    names: tuple[str, ...]
    unit: str


def bends_of(motion: Motion) -> Curves:
    """How much each segment is bent."""
    values = np.hypot(motion.q[..., 0], motion.q[..., 1])
    return Curves("bends of the segments", motion.times, values, motion.robot.segment_names, "rad")


def lengths_of(motion: Motion) -> Curves:
    """How long each segment is."""
    return Curves("lengths of the segments", motion.times, motion.q[..., 2], motion.robot.segment_names, "length unit")


def actuators_of(motion: Motion) -> Curves:
    """Values of all actuators."""
    robot = motion.robot
    units = {actuator.unit or ("value" if robot.linear else "length unit") for actuator in robot.actuators}
    unit, names = units.pop() if len(units) == 1 else "value", tuple(actuator.name for actuator in robot.actuators)
    return Curves("actuators", motion.times, motion.actuators, names, unit)


def speeds_of(motion: Motion, rates: Rates) -> Curves:
    """What share of the rates each step takes, of what is nearest to its own: even within a step."""
    steps = np.diff(motion.q, axis=0) / np.diff(motion.times)[:, None, None]
    shares = 100.0 / largest(motion.robot, rates.spread(motion.robot), steps)
    return Curves(
        "speed", np.repeat(motion.times, 2)[1:-1], np.repeat(shares, 2)[:, None], ("speed",), "% of the rates"
    )
