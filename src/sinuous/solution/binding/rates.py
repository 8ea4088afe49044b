"""Changes that are allowed in one time, as limits: those that a configuration has used up."""

import math
from collections.abc import Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.robot.rates import Changes
from sinuous.robot.robot import Robot
from sinuous.solution.binding.limits import Limit, at

USED_UP = 3e-3
"""What may be left of a change that is used up, as a share of it: the solve stays within them by about a thousandth."""


def rates_of(robot: Robot, q: Floats, initial: Floats, within: Changes) -> Iterator[Limit]:
    """Yield the changes from `initial` (n, 3) to `q` (n, 3) that are used up, segment by segment, actuators last."""
    own, count = within.spread(robot), len(robot)
    for number, (ux, uy, length) in enumerate((q - initial).tolist(), 1):
        bend = math.hypot(ux, uy)
        most = float(own.bend[number - 1])
        if _used_up(bend, most):
            outward = at(count, number, (ux / bend, uy / bend, 0.0))
            yield Limit("bend_rate", number, None, "rates.bend", bend, most, 0.0, outward)
        most = float(own.length[number - 1])
        if _used_up(abs(length), most):
            outward = at(count, number, (0.0, 0.0, math.copysign(1.0, length)))
            yield Limit("length_rate", number, None, "rates.length", abs(length), most, 0.0, outward)
    drive = robot.drive
    changes = drive.values(q) - drive.values(initial)
    rows = zip(
        drive.actuators, changes.tolist(), own.actuator.tolist(), drive.gains.tolist(), drive.jacobian, strict=True
    )
    for actuator, change, most, gain, row in rows:
        if _used_up(abs(change), most):
            outward = (np.sign(change) / gain) * row.reshape(-1, 3)
            name = actuator.segment, actuator.name, "rates.actuator"
            yield Limit("actuator_rate", *name, abs(change), most, 0.0, outward)


def _used_up(change: float, most: float) -> bool:
    return change > 0.0 and change >= (1.0 - USED_UP) * most
