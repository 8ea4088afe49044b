"""The smallest widening of each limit that binds, or of all of them together."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sinuous import words
from sinuous.problem.problem import Problem
from sinuous.robot.actuators import Chambers, Tendons
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from sinuous.solution.binding.binding import Binding
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.words import rounded

MOST = 4.0
"""Largest widening, as a share of the limit."""

Limits = float | tuple[float, float]


@dataclass(frozen=True)
class Widening:
    """A limit that several segments share, and which of its ends bind.

    Attributes
    ----------
    key : str
        What the problem file calls it.
    segments : tuple of int
        Numbers of the segments, 1 = first.
    limits : float or (float, float)
        As they are.
    ends : frozenset of int
        Of an interval: 0 its lower, 1 its upper end.
    """

    key: str
    segments: tuple[int, ...]
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
        if isinstance(self.limits, tuple) and self.key != "tendons.displacement" and self.ends == {0}:
            return min(most, self.limits[0])
        return most

    def name(self, count: int) -> str:
        """What is widened, of a robot with so many segments: `max_bend of all segments`."""
        return f"{self.key} of {words.segments(self.segments, count)}"

    def by(self, amount: float) -> Limits:
        """The limits, wider by this much."""
        if not isinstance(self.limits, tuple):
            return rounded(self.limits + amount)
        low, high = self.limits
        below, above = low - amount * (0 in self.ends), high + amount * (1 in self.ends)
        return rounded(below if self.key == "tendons.displacement" else max(0.0, below)), rounded(above)


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
            yield Remedy(widening.name(len(robot)), plain(widening.limits), plain(widening.by(found[0])))
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
        names = [widening.name(len(robot)) for widening in widenings]
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
            limits = limits_of(robot.segments[each.segment - 1], key)
            if limits is not None:
                ends.setdefault((key, limits), set()).add(int(end[0]) if end else 0)
    result = []
    for (key, limits), own in ends.items():
        symmetric = isinstance(limits, tuple) and limits[0] == -limits[1]
        same = tuple(k for k, s in enumerate(robot.segments, 1) if limits_of(s, key) == limits)
        result.append(Widening(key, same, limits, frozenset((0, 1) if symmetric else own)))
    return result


def limits_of(segment: Segment, key: str) -> Limits | None:
    """The limits of a segment that a problem file calls `key`; `None` where it has none."""
    if key == "tendons.displacement":
        return None if segment.tendons is None else segment.tendons.displacement
    if key == "chambers.length":
        return None if segment.chambers is None else segment.chambers.length
    if key in ("radius", "actuators.limits"):  # `make_thinner` is for the first; the other is none of a segment
        return None
    limits: Limits = getattr(segment, key)
    return limits


def widened(robot: Robot, widening: Widening, amount: float) -> Robot:
    """Return the robot with one limit wider by this much."""
    segments = [
        _with(segment, widening.key, widening.by(amount)) if k in widening.segments else segment
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
