"""How far the ends of segments are from their targets, and where targets put the backbone."""

import math

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot


def target_errors(robot: Robot, target: Target, ends: Floats) -> tuple[float, float]:
    """Distance to the target's position and angle (rad) to its orientation; 0 where nothing is asked."""
    at_tip = target.segment is None or target.segment == len(robot)
    pose = ends[-1] @ robot.tool if at_tip else ends[target.segment]
    off = turn = 0.0
    if target.position is not None:
        off = float(np.linalg.norm(pose[:3, 3] - target.position))
    if target.direction is not None:
        tangent = pose[:3, 2]
        turn = 2.0 * math.atan2(
            float(np.linalg.norm(tangent - target.direction)), float(np.linalg.norm(tangent + target.direction))
        )
    elif target.rotation is not None:
        # The chord between two rotations is 2 sqrt(2) sin(angle / 2); this keeps small angles exact.
        chord = float(np.linalg.norm(pose[:3, :3] - target.rotation)) / (2.0 * math.sqrt(2.0))
        turn = 2.0 * math.asin(min(1.0, chord))
    return off, turn


def backbone_end(robot: Robot, target: Target, last: int, angle_tolerance: float) -> tuple[Floats, float]:
    """Where a target puts the end of its segment, and how far from there it may be because the tool can turn."""
    place: Floats = np.asarray(target.position)
    shift = robot.tool[:3, 3]
    reach = float(np.linalg.norm(shift))
    if last < len(robot) or reach == 0.0:
        return place, 0.0
    if target.rotation is None:
        return place, reach
    return place - target.rotation @ robot.tool[:3, :3].T @ shift, min(2.0, angle_tolerance) * reach
