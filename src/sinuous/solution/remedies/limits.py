"""The smallest widening of each limit that binds, or of all of them together."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sinuous import words
from sinuous.problem.problem import Problem
from sinuous.robot.actuators import UNLIMITED, Actuators, Chambers, Tendons
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from sinuous.solution.binding.binding import Binding
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.words import rounded

MOST = 4.0
"""Largest widening, as a share of the limit."""

Limits = float | tuple[float, float]

COUPLED = "actuators.limits"
"""What the problem file calls limits of the robot's `Actuators`; all others are limits of segments."""

OF_ANY_SIGN = ("tendons.displacement", COUPLED)
"""Limits that may be negative."""


@dataclass(frozen=True)
class Widening:
    """A limit that several segments, or several of `Actuators`, share, and which of its ends bind.

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
    def size(self) -> float:
        """What widenings are relative to."""
        return max(map(abs, self.limits)) if isinstance(self.limits, tuple) else self.limits or 0.1

    @property
    def most(self) -> float:
        """The widest that can be meant: lengths not below 0, bends up to a full turn."""
        most = MOST * self.size
        if self.key == "max_bend":
            return min(most, 2.0 * math.pi - self.limits) if isinstance(self.limits, float) else most
        if isinstance(self.limits, tuple) and self.key not in OF_ANY_SIGN and self.ends == {0}:
            return min(most, self.limits[0])
        return most

    def name(self, robot: Robot) -> str:
        """What is widened: `max_bend of all segments`, `actuators.limits of pan and tilt`."""
        if self.key == COUPLED:
            return f"{self.key} of {words.listed(_linear(robot).names[i] for i in self.shared)}"
        return f"{self.key} of {words.segments(self.shared, len(robot))}"

    def by(self, amount: float) -> Limits:
        """The limits, wider by this much."""
        if not isinstance(self.limits, tuple):
            return rounded(self.limits + amount)
        low, high = self.limits
        below, above = low - amount * (0 in self.ends), high + amount * (1 in self.ends)
        return rounded(below if self.key in OF_ANY_SIGN else max(0.0, below)), rounded(above)


def widen(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the smallest widening of every limit that binds, each alone; where none is enough, of all together."""
    robot = case.problem.robot
    usable = [each for each in widenings(robot, case.binding) if each.most > 0.0]
    alone = False
    for widening in usable:

        def wider(amount: float, widening: Widening = widening) -> Problem:
            return case.problem.changed(robot=widened(robot, widening, amount))

        found = trials.smallest(wider, widening.most)
        if found is not None:
            alone = True
            yield Remedy(widening.name(robot), plain(widening.limits), plain(widening.by(found[0])))
    if not alone and len(usable) > 1:
        yield from _widen_together(trials, case, usable)


def _widen_together(trials: Trials, case: Case, widenings: list[Widening]) -> Iterator[Remedy]:
    """Yield the smallest widening of several limits, each by the same share of the most that can be meant."""
    robot = case.problem.robot

    def wider(share: float) -> Problem:
        changed = robot
        for widening in widenings:
            changed = widened(changed, widening, share * widening.most)
        return case.problem.changed(robot=changed)

    found = trials.smallest(wider, 1.0)
    if found is not None:
        names = [widening.name(robot) for widening in widenings]
        before = [plain(widening.limits) for widening in widenings]
        after = [plain(widening.by(found[0] * widening.most)) for widening in widenings]
        yield Remedy("limits", dict(zip(names, before, strict=True)), dict(zip(names, after, strict=True)))


def plain(limits: Limits) -> float | list[float] | None:
    """Limits as a problem file says them: an interval of no length is a number."""
    if not isinstance(limits, tuple):
        return limits
    return limits[0] if limits[0] == limits[1] else list(limits)


def widenings(robot: Robot, binding: tuple[Binding, ...]) -> list[Widening]:
    """The limits that bind; segments of which a limit is the same share it, and it is widened for all of them."""
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
        same = tuple(place for place in places if limits_of(robot, key, place) == limits)
        result.append(Widening(key, same, limits, frozenset((0, 1) if symmetric else own)))
    return result


def limits_of(robot: Robot, key: str, place: int) -> Limits | None:
    """The limits that a problem file calls `key`, of a segment (1 = first) or a row of `Actuators`; `None` if none."""
    if key == COUPLED:
        return _linear(robot).limits[place]
    segment = robot.segments[place - 1]
    if key == "tendons.displacement":
        return None if segment.tendons is None else segment.tendons.displacement
    if key == "chambers.length":
        return None if segment.chambers is None else segment.chambers.length
    if key == "radius":  # `make_thinner` is for that
        return None
    limits: Limits = getattr(segment, key)
    return limits


def _linear(robot: Robot) -> Actuators:
    assert robot.linear is not None
    return robot.linear


def widened(robot: Robot, widening: Widening, amount: float) -> Robot:
    """Return the robot with one limit wider by this much."""
    wider: Any = widening.by(amount)
    if widening.key == COUPLED:
        linear = _linear(robot)
        limits = [None if own == UNLIMITED else own for own in linear.limits]
        then = [wider if i in widening.shared else own for i, own in enumerate(limits)]
        return robot.changed(actuators=Actuators(linear.matrix, linear.names, then))
    segments = [
        _with(segment, widening.key, wider) if k in widening.shared else segment
        for k, segment in enumerate(robot.segments, 1)
    ]
    return robot.changed(segments=segments)


def _with(segment: Segment, key: str, limits: Limits) -> Segment:
    """Return the segment with other limits."""
    if key == "tendons.displacement" and segment.tendons is not None:
        lines = segment.tendons
        lines_then = Tendons(angles=lines.angles, radius=lines.radius, displacement=limits, names=lines.names)
        return segment.changed(tendons=lines_then)
    if key == "chambers.length" and segment.chambers is not None:
        own = segment.chambers
        own_then = Chambers(angles=own.angles, radius=own.radius, length=limits, names=own.names)
        return segment.changed(chambers=own_then)
    changes: dict[str, Any] = {key: limits}
    return segment.changed(**changes)
