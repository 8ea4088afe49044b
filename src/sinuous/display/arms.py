"""Robots as they are drawn: where the body is, and as ghosts where it is not, or may be."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.display.style import tones
from sinuous.robot.robot import Robot
from sinuous.statics.body import body_of
from sinuous.statics.equilibrium import Equilibrium, under_load
from sinuous.statics.rest import bodies_at

KEPT = 16
"""Robots whose thicker bodies are kept."""

FORCE_LENGTH = 0.25
"""Length of the line of the largest force, in lengths of the robot."""


class Arm(NamedTuple):
    """A body in one configuration.

    Attributes
    ----------
    robot : Robot
        The body: the robot, or under load one of arcs.
    q : ndarray (m, 3)
    solved : bool
        Whether it meets what was asked.
    ghost : bool
        Whether it is drawn see-through.
    number : int
        Of its robot in the picture, 0 = first: bodies of one robot have the same colours.
    owner : Robot or None
        Its robot, where the body is another one.
    """

    robot: Robot
    q: Floats
    solved: bool = True
    ghost: bool = False
    number: int = 0
    owner: Robot | None = None

    @property
    def segments(self) -> Sequence[int]:
        """Which segment of its robot each segment of the body belongs to, 0 = first."""
        return segments_of(self.robot, self.owner)

    @property
    def colours(self) -> list[str]:
        """Colours of the segments of the body."""
        pair = tones(self.solved, self.number)
        return [pair[k % 2] for k in self.segments]

    def end(self, segment: int | None) -> Floats:
        """Where a segment of its robot ends (3,), 1 = first; the point of the tool for the last one, and for None."""
        own = self.segments
        if segment is None or segment > own[-1]:
            return np.asarray(self.robot.tip(self.q)[:3, 3])
        return np.asarray(self.robot.forward(self.q)[np.searchsorted(own, segment) - 1, :3, 3])


class MovingArm(NamedTuple):
    """A body that moves.

    Attributes
    ----------
    begin : Arm
        Where it begins.
    q : ndarray (T, m, 3)
        Configurations of the body, linear between neighbouring ones.
    times : ndarray (T,)
        Increasing.
    drives : ndarray (T, n, 3) or None
        Those of its robot that loads bend into these; of a body that shows the loads.
    """

    begin: Arm
    q: Floats
    times: Floats
    drives: Floats | None = None

    @property
    def ghost(self) -> bool:
        """Whether it is drawn see-through."""
        return self.begin.ghost

    def at(self, share: float) -> Arm:
        """Where it is after this share of its time."""
        return self.begin._replace(q=self._between(self.q, share))

    def forces_at(self, share: float) -> list[Floats]:
        """Lines of what pulls it after this share of its time; see `forces_of`."""
        if self.drives is None or self.begin.owner is None:
            return []
        return forces_of(self.begin.owner, self._between(self.drives, share))

    def _between(self, values: Floats, share: float) -> Floats:
        """Values (T, ...) after this share of the time."""
        begin, end = self.times[0], self.times[-1]
        now = begin + share * (end - begin)
        i = int(np.clip(np.searchsorted(self.times, now, side="right") - 1, 0, len(self.times) - 2))
        part = (now - self.times[i]) / (self.times[i + 1] - self.times[i])
        return (1.0 - part) * values[i] + part * values[i + 1]


class Body(NamedTuple):
    """A body in configurations (T, m, 3), and whether it is a ghost."""

    robot: Robot
    q: Floats
    ghost: bool = False


def bodies_of(robot: Robot, q: Floats, loaded: Body | None = None) -> Iterator[Body]:
    """Yield what is drawn of a robot in configurations (T, n, 3): first where its body is.

    Ghosts are the body without its load, and around one that may be elsewhere the room in which it is. `loaded` is the
    body under other loads than gravity and payload. Tools are drawn as if no arc were twisted.
    """
    body = loaded or Body(*bodies_at(robot, q))
    yield body
    if body.robot is not robot:
        yield Body(robot, q, ghost=True)
    if robot.uncertainty is not None:
        yield Body(_thicker(body.robot), body.q, ghost=True)


def arms_of(robot: Robot, q: Floats, solved: bool = True, number: int = 0, loaded: Body | None = None) -> Iterator[Arm]:
    """Yield the bodies of a robot in a single configuration (n, 3)."""
    for body in bodies_of(robot, q[None], loaded):
        yield Arm(body.robot, body.q[0], solved, body.ghost, number, robot)


def forces_of(robot: Robot, q: Floats, shape: Equilibrium | None = None) -> list[Floats]:
    """Lines (2, 3) of forces and payloads on a robot in a configuration (n, 3), as long as they are strong."""
    own = under_load(robot, q) if shape is None else shape
    forces = [] if own is None else list(own.forces())
    largest = max((float(np.linalg.norm(force)) for _, force in forces), default=0.0)
    if largest == 0.0:
        return []
    return [np.stack([place - force * (FORCE_LENGTH * robot.mean_length / largest), place]) for place, force in forces]


@lru_cache(maxsize=KEPT)
def _thicker(robot: Robot) -> Robot:
    """The robot with a body that has the room in which it may be."""
    assert robot.uncertainty is not None
    bounds = np.broadcast_to(robot.uncertainty.bound, len(robot))
    pairs = zip(robot.segments, bounds.tolist(), strict=True)
    return robot.changed(segments=[each.changed(radius=each.radius + bound) for each, bound in pairs], uncertainty=None)


def segments_of(body: Robot, robot: Robot | None) -> Sequence[int]:
    """Which segment of a robot each segment of its body belongs to, 0 = first."""
    if robot is None or len(body) == len(robot):
        return range(len(body))
    return body_of(robot).owners.tolist()
