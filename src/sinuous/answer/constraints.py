"""Every limit of a robot, one by one: what a configuration has of it, how much is left, and which motion it forbids.

Changes that are allowed in one time (`within`) are limits, too, where a configuration has used them up.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.arguments import LimitKind, RateKind
from sinuous.base.checks import Floats
from sinuous.kernels.packing import BendLine
from sinuous.model.actuation import Actuator
from sinuous.model.rates import Changes
from sinuous.model.robot import Robot


class Limit(NamedTuple):
    """One side of one limit.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature` or `actuator`; or `length_rate`, `bend_rate`, `actuator_rate`.
    segment : int
        1 = first.
    actuator : str or None
        Name of the actuator.
    key : str
        What the problem file calls it; `length[0]` is the lower end of `length`, and `radius` a curvature that the
        thickness of the body limits, `self_clearance` one that this and the clearance limit that is demanded.
    value, limit : float
        What the configuration has, and what it may have: lengths, rad for `bend`, 1 / length for `curvature`; for an
        actuator in its own unit.
    slack : float
        What is left until the limit stops a motion; length, rad for `bend` and `curvature`. Displacements of
        `Actuators` are divided by their scale, see `Actuation.scales`.
    gradient : ndarray (n, 3)
        By how much the slack shrinks with `bend_x`, `bend_y`, `length` of each segment.
    fixed : bool
        Whether the limit leaves no choice: a length that cannot change, a segment that cannot bend.
    motor : Actuator or None
        The actuator, where value and limit are those of its motor and not displacements.
    """

    constraint: LimitKind | RateKind
    segment: int
    actuator: str | None
    key: str
    value: float
    limit: float
    slack: float
    gradient: Floats
    fixed: bool = False
    motor: Actuator | None = None


def limits_of(robot: Robot, q: Floats) -> Iterator[Limit]:
    """Yield all limits of a robot at the configuration `q` (n, 3), segment by segment, actuators last."""
    count = len(robot)
    parts = zip(robot.rows, robot.curvatures, robot.self_radii, q.tolist(), strict=True)
    for number, (segment, tightest, radius, (ux, uy, length)) in enumerate(parts, 1):
        for i, sign in enumerate((-1.0, 1.0)):
            slack = sign * (segment.length[i] - length)
            end = number, None, f"length[{i}]", length, segment.length[i]
            fixed = segment.length[0] == segment.length[1]
            yield Limit("length", *end, slack, gradient_at(count, number, (0.0, 0.0, sign)), fixed)
        line = robot.drive.coordinates.bends[number - 1]
        if isinstance(line, BendLine):
            yield from _in_plane(robot, number, line, q[number - 1])
            continue
        bend = math.hypot(ux, uy)
        most = segment.max_bend if segment.length[1] > 0.0 else 0.0
        outward = [(ux / bend, uy / bend)] if bend > 0.0 else [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        for x, y in outward:
            end = number, None, "max_bend", bend, most
            yield Limit("bend", *end, most - bend, gradient_at(count, number, (x, y, 0.0)), most == 0.0)
            if math.isfinite(tightest):
                curvature = bend / length if length > 0.0 else 0.0
                thick = "radius" if radius == segment.radius else "self_clearance"
                key = "max_curvature" if tightest == segment.max_curvature else thick
                own = number, None, key, curvature, tightest
                yield Limit("curvature", *own, tightest * length - bend, gradient_at(count, number, (x, y, -tightest)))
    yield from _actuators(robot, q)


def _in_plane(robot: Robot, number: int, line: BendLine, own: Floats) -> Iterator[Limit]:
    """Yield the limits of a bend in one plane, of segment `number`; none of them gives across it."""
    count, (px, py), tightest = len(robot), line.plane, robot.curvatures[number - 1]
    z, locked = float(own[:2] @ np.array(line.plane)), line.low == line.high
    key = "locked" if locked else "plane"
    apart = own[:2] - line.rest - (line.low if locked else z) * np.array(line.plane)
    for x, y in ((-py, px), (py, -px), *(((px, py), (-px, -py)) if locked else ())):
        slack = -float(apart @ (x, y))
        yield Limit("bend", number, None, key, 0.0, 0.0, slack, gradient_at(count, number, (x, y, 0.0)), True)
    pair = isinstance(robot.rows[number - 1].own_max_bend, tuple)
    for i, (side, cap) in enumerate(() if locked else ((-1.0, line.low), (1.0, line.high))):
        end = number, None, f"max_bend[{i}]" if pair else "max_bend", z, cap
        along = side * px, side * py
        yield Limit("bend", *end, side * (cap - z), gradient_at(count, number, (*along, 0.0)))
        if math.isfinite(tightest):
            curved, off = tightest * float(own[2]), math.hypot(*line.rest)
            most = math.sqrt(max(0.0, curved**2 - off**2))
            growth = tightest * curved / most if most > 0.0 else 0.0
            bent = math.hypot(z, off) / float(own[2]) if own[2] > 0.0 else 0.0
            held = number, None, "max_curvature", bent, tightest
            yield Limit("curvature", *held, most - side * z, gradient_at(count, number, (*along, -growth)))


def _actuators(robot: Robot, q: Floats) -> Iterator[Limit]:
    drive = robot.drive
    there = zip(drive.displacements(q).tolist(), drive.values(q).tolist(), strict=True)
    rows = zip(drive.actuators, there, drive.limits.tolist(), drive.scales.tolist(), drive.jacobian, strict=True)
    for actuator, (displacement, value), own, scale, row in rows:
        key = _key(robot, actuator)
        order = (0, 1) if actuator.gain > 0.0 else (1, 0)
        for i, sign in enumerate((-1.0, 1.0)):
            if math.isfinite(own[i]):
                limit = actuator.limits[order[i]]
                end = i if key.endswith(".displacement") or key.endswith(".length") else order[i]
                slack, gradient = sign * (own[i] - displacement) / scale, (sign / scale) * row.reshape(-1, 3)
                name = actuator.segment, actuator.name, f"{key}[{end}]"
                yield Limit("actuator", *name, value, limit, slack, gradient, motor=_motor(actuator))


def _key(robot: Robot, actuator: Actuator) -> str:
    """What the problem file calls the limits of an actuator."""
    segment = robot.rows[actuator.segment - 1]
    if actuator.kind == "tendon" and segment.tendons is not None:
        return f"tendons.{segment.tendons.limited_by}"
    if actuator.kind == "chamber" and segment.chambers is not None:
        return f"chambers.{segment.chambers.limited_by}"
    return "actuators.limits"


def _motor(actuator: Actuator) -> Actuator | None:
    plain = actuator.unit is None and (actuator.gain, actuator.offset) == (1.0, 0.0)
    return None if plain else actuator


def gradient_at(segments: int, number: int, weights: tuple[float, float, float]) -> Floats:
    """A gradient (n, 3) that has these weights at one segment, 1 = first, and zeros elsewhere."""
    gradient = np.zeros((segments, 3))
    gradient[number - 1] = weights
    return gradient


def normal(limit: Limit, unit: float) -> Floats:
    """Gradient (3 n,) of what a limit bounds, in coordinates where a length counts in `unit` and a bend in rad."""
    return (limit.gradient * [1.0, 1.0, unit]).ravel()


USED_UP = 3e-3
"""Share of a change that may be left when it counts as used up: a solve stays within it by about a thousandth."""


def rates_of(robot: Robot, q: Floats, initial: Floats, within: Changes) -> Iterator[Limit]:
    """Yield the changes from `initial` (n, 3) to `q` (n, 3) that are used up, segment by segment, actuators last."""
    own, count = within.spread(robot), len(robot)
    for number, (ux, uy, length) in enumerate((q - initial).tolist(), 1):
        bend = math.hypot(ux, uy)
        most = float(own.bend[number - 1])
        if _used_up(bend, most):
            outward = gradient_at(count, number, (ux / bend, uy / bend, 0.0))
            yield Limit("bend_rate", number, None, "rates.bend", bend, most, 0.0, outward)
        most = float(own.length[number - 1])
        if _used_up(abs(length), most):
            outward = gradient_at(count, number, (0.0, 0.0, math.copysign(1.0, length)))
            yield Limit("length_rate", number, None, "rates.length", abs(length), most, 0.0, outward)
    drive = robot.drive
    changes = drive.values(q) - drive.values(initial)
    rows = zip(
        drive.actuators, changes.tolist(), own.actuator.tolist(), drive.scales.tolist(), drive.jacobian, strict=True
    )
    for actuator, change, most, scale, row in rows:
        if _used_up(abs(change), most):
            outward = (np.sign(change * actuator.gain) / scale) * row.reshape(-1, 3)
            name = actuator.segment, actuator.name, "rates.actuator"
            yield Limit("actuator_rate", *name, abs(change), most, 0.0, outward, motor=_motor(actuator))


def _used_up(change: float, most: float) -> bool:
    return change > 0.0 and change >= (1.0 - USED_UP) * most
