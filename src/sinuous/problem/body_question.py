"""The question that targets of a robot under load ask of its body, which is a robot of arcs."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.statics import layout as t
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.statics.body import body_of, rolled
from sinuous.statics.equilibrium import Equilibrium


class BodyQuestion(NamedTuple):
    """A body of arcs at rest, and what is asked of it.

    Attributes
    ----------
    body : Robot
        One segment an arc; where nothing pulls, the robot itself.
    arcs : ndarray (N, 3)
        Its configuration.
    targets : tuple of Target
    owners : list of int (N)
        Which segment of the robot each arc belongs to, 1 = first.
    shape : Equilibrium or None
        Under load.
    """

    body: Robot
    arcs: Floats
    targets: tuple[Target, ...]
    owners: list[int]
    shape: Equilibrium | None = None

    def segment(self, arc: int | None) -> int | None:
        """Segment of the robot that an arc (1 = first) belongs to."""
        return None if arc is None else self.owners[arc - 1]


def ask_body(robot: Robot, q: Floats, targets: Sequence[Target]) -> BodyQuestion:
    """Return the question of targets in a configuration (n, 3) of the drive."""
    if not robot.has_external_load:
        return BodyQuestion(robot, q, tuple(targets), list(range(1, len(robot) + 1)))
    own, found = body_of(robot), robot.shape(q)
    rolls = np.cumsum(found.states[:, t.TWIST])
    asked = [_turned(target, robot, int(own.ends[(target.segment or 1) - 1]), rolls) for target in targets]
    return BodyQuestion(found.body, found.arcs, tuple(asked), (own.owners + 1).tolist(), found)


def _turned(target: Target, robot: Robot, end: int, rolls: Floats) -> Target:
    """The same target for the arc `end`, whose frame has not rolled; that of the tip is in the tool."""
    if target.segment is None or target.segment == len(robot):
        return target.changed(segment=None)
    if target.rotation is None:
        return target.changed(segment=end + 1)
    return target.changed(segment=end + 1, rotation=target.rotation @ rolled(-float(rolls[end]))[:3, :3])
