"""Moves as tasks: from a start to a goal, planned."""

import warnings
from typing import Any

from sinuous import checks
from sinuous.arguments import Rows
from sinuous.assessing.tasks import Done, binds_of
from sinuous.errors import SuspiciousInput
from sinuous.frozen import Frozen
from sinuous.motion.plan import plan
from sinuous.problem.target import Target, Targets, target_list, target_table
from sinuous.robot.robot import Robot
from sinuous.robot.segment import straight
from sinuous.solving.solver import Solver


class Move(Frozen):
    """A motion to targets that is to be planned, all of it proved clear.

    Parameters
    ----------
    goal : Target or list of Target
        Where the robot must be in the end; the targets of a list are met at once.
    start : array_like (n, 3), optional
        The configuration that the robot is in; then it has to have n segments. By default it is straight, with segments
        of mean length.
    """

    kind = "plan"
    goal: tuple[Target, ...]
    start: Any

    def __init__(self, goal: Targets, start: Rows | None = None) -> None:
        self._set(
            goal=target_list("goal", goal), start=None if start is None else checks.array("start", start, (None, 3))
        )

    def check(self, robot: Robot) -> None:
        """Refuse a segment that the robot does not have, and a start of another number of them."""
        with checks.inside("goal"):
            target_table(robot, self.goal)
        if self.start is not None:
            checks.array("start", self.start, (len(robot), 3))

    def do(self, solver: Solver) -> Done:
        """Plan it."""
        start = straight(solver.robot.segments) if self.start is None else self.start
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # the solver has said it
            motion = plan(solver.robot, start, list(self.goal), solver.scene, **vars(solver.options))
        proved = motion.clearance, motion.self_clearance
        duration = float(motion.times[-1] - motion.times[0]) if motion.solved else None
        worst = None if motion.worst is None else motion.worst.obstacle or motion.worst.constraint
        binds = binds_of(motion.solutions) or worst
        shapes = motion.q if motion.solved else None
        return Done(str(motion.status), float(motion.solved), *proved, motion.seconds, duration, binds, shapes)
