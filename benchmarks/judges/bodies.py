"""Bodies as thick as a robot demands: what has to be free of obstacles, and what of the body itself."""

import numpy as np

from sinuous.base.arguments import OneEach
from sinuous.model.robot import Robot


def measured_body(robot: Robot) -> Robot:
    """Return the body that reported clearances are measured from: thicker by the uncertainty."""
    return robot if robot.uncertainty is None else thicker(robot, robot.uncertainty.bound)


def needed_body(robot: Robot) -> Robot:
    """Return the body that has to be free of obstacles: thicker by the uncertainty and the demanded clearance."""
    return thicker(measured_body(robot), robot.clearance) if np.any(robot.clearance) else measured_body(robot)


def self_body(robot: Robot) -> Robot:
    """Return the body that has to be free of itself: thicker by half of the demanded clearance from itself."""
    return thicker(robot, 0.5 * np.array(robot.self_clearance)) if np.any(robot.self_clearance) else robot


def thicker(robot: Robot, by: OneEach) -> Robot:
    """Return the robot with other radii, and without any demand."""
    own = np.broadcast_to(np.asarray(by, np.float64), len(robot)).tolist()
    segments = [each.changed(radius=each.radius + more) for each, more in zip(robot.segments, own, strict=True)]
    return robot.changed(segments=segments, clearance=0.0, self_clearance=0.0, uncertainty=None)
