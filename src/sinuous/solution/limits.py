"""Every limit of a robot, one by one: what a configuration has of it, how much is left, and which motion it forbids."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.robot import actuation
from sinuous.robot.names import chamber_name, tendon_name
from sinuous.robot.robot import Robot

Weights = tuple[float, float, float]


class Limit(NamedTuple):
    """One side of one limit.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature` or `actuator`.
    segment : int
        1 = first.
    actuator : str or None
        Name of the tendon or chamber.
    key : str
        What the problem file calls it; `length[0]` is the lower end of `length`, and `radius` a curvature that the
        thickness of the body limits.
    value, limit : float
        What the configuration has, and what it may have: lengths, rad for `bend`, 1 / length for `curvature`.
    slack : float
        What is left until the limit stops a motion; length, rad for `bend` and `curvature`.
    first : int
        First segment that it concerns, 1 = first; `segment` is the last.
    weights : tuple of float
        By how much the slack shrinks with `bend_x`, `bend_y`, `length` of each of these segments.
    """

    constraint: str
    segment: int
    actuator: str | None
    key: str
    value: float
    limit: float
    slack: float
    first: int
    weights: Weights


def limits_of(robot: Robot, q: Floats) -> Iterator[Limit]:
    """Yield all limits of a robot at the configuration `q` (n, 3), segment by segment, actuators last."""
    parts = zip(robot.segments, robot.curvatures, q.tolist(), strict=True)
    for number, (segment, tightest, (ux, uy, length)) in enumerate(parts, 1):
        for i, sign in enumerate((-1.0, 1.0)):
            slack = sign * (segment.length[i] - length)
            own = "length", number, None, f"length[{i}]", length, segment.length[i]
            yield Limit(*own, slack, number, (0.0, 0.0, sign))
        bend = math.hypot(ux, uy)
        most = segment.max_bend if segment.length[1] > 0.0 else 0.0
        outward = [(ux / bend, uy / bend)] if bend > 0.0 else [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        for x, y in outward:
            yield Limit("bend", number, None, "max_bend", bend, most, most - bend, number, (x, y, 0.0))
            if math.isfinite(tightest):
                curvature = bend / length if length > 0.0 else 0.0
                key = "max_curvature" if tightest == segment.max_curvature else "radius"
                own = "curvature", number, None, key, curvature, tightest
                yield Limit(*own, tightest * length - bend, number, (x, y, -tightest))
    yield from _tendons(robot, q)
    yield from _chambers(robot, q)


def _tendons(robot: Robot, q: Floats) -> Iterator[Limit]:
    pulled = actuation.tendon_displacements(robot.segments, q)
    for number, (segment, values) in enumerate(zip(robot.segments, pulled, strict=True), 1):
        if segment.tendons is not None:
            names = [tendon_name(number, line) for line in range(1, len(values) + 1)]
            weights = [(x, y, 0.0) for x, y in segment.tendons.arms.tolist()]
            key = "tendons.displacement"
            yield from _lines(key, (1, number), names, values, weights, segment.tendons.displacement)


def _chambers(robot: Robot, q: Floats) -> Iterator[Limit]:
    lengths = actuation.chamber_lengths(robot.segments, q)
    for number, (segment, values) in enumerate(zip(robot.segments, lengths, strict=True), 1):
        if segment.chambers is not None:
            names = [chamber_name(number, line) for line in range(1, len(values) + 1)]
            weights = [(-x, -y, 1.0) for x, y in segment.chambers.arms.tolist()]
            yield from _lines("chambers.length", (number, number), names, values, weights, segment.chambers.length)


def _lines(
    key: str,
    span: tuple[int, int],
    names: Sequence[str],
    values: Floats,
    weights: Sequence[Weights],
    limits: tuple[float, float],
) -> Iterator[Limit]:
    for name, value, (x, y, z) in zip(names, values.tolist(), weights, strict=True):
        for i, sign in enumerate((-1.0, 1.0)):
            if math.isfinite(limits[i]):
                slack = sign * (limits[i] - value)
                own = "actuator", span[1], name, f"{key}[{i}]", value, limits[i]
                yield Limit(*own, slack, span[0], (sign * x, sign * y, sign * z))


def normal(limit: Limit, segments: int, unit: float) -> Floats:
    """Gradient (3 n,) of what a limit bounds, in coordinates where a length counts in `unit` and a bend in rad."""
    result = np.zeros((segments, 3))
    result[limit.first - 1 : limit.segment] = np.array(limit.weights) * [1.0, 1.0, unit]
    return result.ravel()
