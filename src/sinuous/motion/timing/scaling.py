"""Time scalings: how fast a robot may be on its way, and the fastest way to pass it.

A phase is a duration, the place s where it begins on its piece, the speed of s there, and its even acceleration.
"""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.motion.timing.way import Way
from sinuous.robot.rates import Spread
from sinuous.robot.robot import Robot


class Scaling(NamedTuple):
    """Phases on a way: the number of the piece (M,), and durations, places, speeds and accelerations (M, 4)."""

    piece: np.ndarray
    phases: Floats


def largest(robot: Robot, spread: Spread, slopes: Floats) -> Floats:
    """Return the largest multiple of each slope (m, n, 3) that rates allow (m,); infinite where nothing limits it."""
    sizes = np.concatenate(
        [
            np.hypot(slopes[..., 0], slopes[..., 1]) / spread.bend,
            np.abs(slopes[..., 2]) / spread.length,
            np.abs(robot.to_actuators(slopes)) / spread.actuator,
        ],
        axis=-1,
    ).max(axis=-1)
    most: Floats = np.divide(1.0, sizes, out=np.full(len(sizes), np.inf), where=sizes > 0.0)
    return most


def stopping(robot: Robot, way: Way, rates: Spread, accelerations: Spread | None) -> Scaling:
    """Scale a way of straight pieces: from rest to rest on each, or at an even speed where nothing accelerates."""
    slopes = way.pieces[:, 1]
    speed, gain = largest(robot, rates, slopes), np.full(len(slopes), np.inf)
    if accelerations is not None:
        gain = largest(robot, accelerations, slopes)
    refuse_unlimited(np.minimum(speed, gain))
    piece, phases = [], []
    for i, (length, fastest, most) in enumerate(zip(way.lengths, speed, gain, strict=True)):
        own = _phases(float(length), float(fastest), float(most))
        piece.extend([i] * len(own))
        phases.extend(own)
    return Scaling(np.array(piece, np.intp), np.array(phases))


def _phases(length: float, fastest: float, most: float) -> list[tuple[float, float, float, float]]:
    """Phases of one straight piece: speeding up, an even speed, and slowing down."""
    if np.isinf(most):
        return [(length / fastest, 0.0, fastest, 0.0)]
    top = min(fastest, float(np.sqrt(length * most)))
    ramp = 0.5 * top * top / most
    up = (top / most, 0.0, 0.0, most)
    down = (top / most, length - ramp, top, -most)
    if 2.0 * ramp >= length * (1.0 - 1e-12):
        return [up, down]
    return [up, ((length - 2.0 * ramp) / top, ramp, top, 0.0), down]


def refuse_unlimited(speeds: Floats) -> None:
    """Refuse rates that let a piece pass in no time."""
    if np.isinf(speeds).any():
        number = int(np.argmax(np.isinf(speeds))) + 1
        raise InputError("rates", f"nothing limits leg {number} of the way", None, "limits of all that moves")
