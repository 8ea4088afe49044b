"""Whose values a trajectory has: joints of the chain that stands for a robot, or its actuators."""

from typing import TYPE_CHECKING, Literal

import numpy as np

from sinuous import checks
from sinuous.arguments import Whole
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.export.chain import JointChain

if TYPE_CHECKING:
    from sinuous.robot.robot import Robot

Of = Literal["joints", "actuators"]
"""Joints are those of the URDF."""


def joint_map(robot: "Robot", of: Of, joints_per_segment: Whole) -> tuple[tuple[str, ...], Floats]:
    """Names (j,) of joints or actuators, and the matrix (j, 3 n) that makes their values of a flat configuration."""
    if checks.choice("of", of, ("joints", "actuators")) == "joints":
        chain = JointChain(robot, joints_per_segment)
        return chain.names, chain.matrix
    if not robot.actuators:
        raise InputError("of", "the robot has none", of, "joints")
    return tuple(actuator.name for actuator in robot.actuators), np.asarray(robot.drive.jacobian)
