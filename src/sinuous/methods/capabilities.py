"""What methods can be asked for, and which limits they keep."""

from dataclasses import dataclass

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.tables import GOAL, HAS_POSITION, ORIENTATION, ROTATION, TARGET_SEGMENT
from sinuous.model.robot import Robot

LIMITS = ("length", "bend", "curvature", "actuators")
"""Limits that a robot may have."""


@dataclass(frozen=True)
class Capabilities:
    """What one method handles; by default that of a method which looks at the tip alone, and at no obstacles.

    Targets and tools that it does not handle are refused. Limits and obstacles that it does not handle are those that
    its answers may violate: such an answer is never solved, and `Solution.worst` says what it violates.

    Attributes
    ----------
    source : str
        Where the method is described.
    direction, rotation : bool
        Whether a target's position may come with a direction of the tangent, with a whole rotation.
    orientation_alone : bool
        Whether an orientation may be asked for without a position.
    elbows : bool
        Whether targets may concern other segments than the last, and several be met at once.
    tool : bool
        Whether the robot may have a tool.
    limits : tuple of str
        Which limits it takes account of (see `LIMITS`).
    obstacles : bool
        Whether it avoids obstacles.
    preferences : bool
        Whether it minimises what is preferred among solutions.
    initial : bool
        Whether it begins from an initial configuration.
    routes : bool
        Whether routes through free space may serve it as initial configurations when its own starts fail. Published
        methods are shown as they are.
    """

    source: str
    direction: bool = True
    rotation: bool = False
    orientation_alone: bool = False
    elbows: bool = False
    tool: bool = True
    limits: tuple[str, ...] = ("length", "bend", "curvature")
    obstacles: bool = False
    preferences: bool = False
    initial: bool = True
    routes: bool = False

    @property
    def any_target(self) -> bool:
        """Whether there is no target that is refused."""
        return self.direction and self.rotation and self.orientation_alone and self.elbows

    def refuse_robot(self, method: str, robot: Robot) -> None:
        """Refuse a robot that the method does not handle.

        Raises
        ------
        InputError
        """
        if not self.tool and not np.array_equal(robot.tool, np.eye(4)):
            raise InputError("robot.tool", f"not handled by the method {method}", robot.tool.tolist(), "no tool")

    def refuse_targets(self, method: str, rows: Floats, segments: int) -> None:
        """Refuse targets `rows` (t, 15) that the method does not handle, for a robot of so many segments.

        Raises
        ------
        InputError
        """
        if self.any_target:
            return
        problem = f"not handled by the method {method}"
        if len(rows) > 1 and not self.elbows:
            raise InputError("targets", problem, f"{len(rows)} targets at once", "one target")
        for row in rows:
            segment, placed, orientation = int(row[TARGET_SEGMENT]), row[HAS_POSITION], int(row[ORIENTATION])
            if not self.elbows and segment not in (-1, segments - 1):
                raise InputError("target.segment", problem, segment + 1, "a target of the last segment")
            if not self.orientation_alone and not placed:
                raise InputError("target.position", problem, None, "a target with a position")
            if orientation and not (self.rotation if orientation == ROTATION else self.direction):
                asked = "rotation" if orientation == ROTATION else "direction"
                raise InputError(f"target.{asked}", problem, row[GOAL:].tolist(), f"a target without {asked}")
