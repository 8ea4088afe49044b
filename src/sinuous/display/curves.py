"""What changes along a motion, as curves over its time: for diagrams and for the plot of a page."""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.motion import Motion
from sinuous.motion.timing import largest
from sinuous.robot.rates import Rates


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
