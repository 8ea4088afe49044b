"""Limits that bind, as the problem file calls them, and robots of which one of them is wider."""

import math
from typing import Any, NamedTuple

from sinuous.answer.binding import OF_THICKNESS, Binding
from sinuous.base.words import listed, rounded, segments
from sinuous.model.actuators import Actuators
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment

MOST = 4.0
"""Largest widening, as a share of the limit."""

FROM_NOTHING = 0.1
"""What stands for a limit of 0 there: rad, or length unit."""

COUPLED = "actuators.limits"
"""What the problem file calls limits of the robot's `Actuators`; all others are limits of segments."""

OF_ANY_SIGN = ("tendons.displacement", "tendons.limits", "chambers.limits", COUPLED)
"""Limits that may be negative."""

Limits = float | tuple[float, float]


class Widening(NamedTuple):
    """A limit that several segments, or several rows of `Actuators`, share, and which of its ends bind.

    Attributes
    ----------
    key : str
        What the problem file calls it.
    shared : tuple of int
        Numbers of the segments, 1 = first; of `Actuators` of the rows, 0 = first.
    limits : float or (float, float)
        As they are.
    ends : frozenset of int
        Of an interval: 0 its lower, 1 its upper end.
    """

    key: str
    shared: tuple[int, ...]
    limits: Limits
    ends: frozenset[int]

    @property
    def most(self) -> float:
        """The largest amount that can be meant: lengths not below 0, bends up to a full turn."""
        if not isinstance(self.limits, tuple):
            most = MOST * (self.limits or FROM_NOTHING)
            return min(most, 2.0 * math.pi - self.limits) if self.key == "max_bend" else most
        most = MOST * max(map(abs, self.limits))
        return min(most, self.limits[0]) if self.key not in OF_ANY_SIGN and self.ends == {0} else most

    def name(self, robot: Robot) -> str:
        """What is widened: `max_bend of all segments`, `actuators.limits of pan and tilt`."""
        if self.key == COUPLED:
            return f"{self.key} of {listed(_linear(robot).names[i] for i in self.shared)}"
        return f"{self.key} of {segments(self.shared, len(robot))}"

    def by(self, amount: float) -> Limits:
        """The limits, wider by this much."""
        if not isinstance(self.limits, tuple):
            return rounded(self.limits + amount)
        low, high = self.limits[0] - amount * (0 in self.ends), self.limits[1] + amount * (1 in self.ends)
        return rounded(low if self.key in OF_ANY_SIGN else max(0.0, low)), rounded(high)

    def applied(self, robot: Robot, amount: float) -> Robot:
        """Return the robot with this limit wider by this much."""
        limits = self.by(amount)
        if self.key != COUPLED:
            numbered = enumerate(robot.segments, 1)
            return robot.changed(segments=[_with(s, self.key, limits) if k in self.shared else s for k, s in numbered])
        linear = _linear(robot)
        own = [limits if i in self.shared else each for i, each in enumerate(linear.limits)]
        return robot.changed(actuators=linear.changed(limits=own))


def widenings(robot: Robot, binding: tuple[Binding, ...]) -> list[Widening]:
    """Return the limits that bind. Segments with the same limit share it, and it is widened for all of them."""
    ends: dict[tuple[str, Limits], set[int]] = {}
    for each in binding:
        if each.key is not None and each.segment is not None:
            key, _, end = each.key.partition("[")
            place = _linear(robot).names.index(each.actuator) if key == COUPLED and each.actuator else each.segment
            limits = limits_of(robot, key, place)
            if limits is not None:
                ends.setdefault((key, limits), set()).add(int(end[0]) if end else 0)
    result = []
    for (key, limits), own in ends.items():
        symmetric = isinstance(limits, tuple) and limits[0] == -limits[1]
        places = range(len(_linear(robot).names)) if key == COUPLED else range(1, len(robot) + 1)
        shared = tuple(place for place in places if limits_of(robot, key, place) == limits)
        result.append(Widening(key, shared, limits, frozenset((0, 1) if symmetric else own)))
    return result


def limits_of(robot: Robot, key: str, place: int) -> Limits | None:
    """Return the limits that a problem file calls `key`, of a segment (1 = first) or a row of `Actuators` (0 = first).

    `None` where there are none; also of `radius`, which limits the curvature: it is no limit that could be wider.
    """
    if key == COUPLED:
        return _linear(robot).limits[place]
    group, _, name = key.rpartition(".")
    segment = robot.segments[place - 1]
    owner = getattr(segment, group) if group else segment
    return None if owner is None or key in OF_THICKNESS else getattr(owner, name)


def plain(limits: Limits) -> float | list[float]:
    """Limits as a problem file says them: an interval of no length is a number."""
    if not isinstance(limits, tuple):
        return limits
    return limits[0] if limits[0] == limits[1] else list(limits)


def _with(segment: Segment, key: str, limits: Limits) -> Segment:
    """Return a segment with other limits."""
    group, _, name = key.rpartition(".")
    changes: dict[str, Any] = {group: getattr(segment, group).changed(**{name: limits})} if group else {key: limits}
    return segment.changed(**changes)


def _linear(robot: Robot) -> Actuators:
    assert robot.linear is not None
    return robot.linear
