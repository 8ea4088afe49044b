"""A robot on an insertion stage: the whole arm is pushed forward along its base's axis."""

import numpy as np

from sinuous import checks
from sinuous.arguments import Number
from sinuous.robot.actuators import Actuators
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment


def on_stage(robot: Robot, travel: Number, name: str = "stage") -> Robot:
    """Put a robot on a stage that pushes it forward along the axis of its base.

    Drawn back as far as it goes, the arm stands straight behind the base of before, at its greatest length, and its tip
    is there. So `robot.base` is where the tip enters, and how. The stage is a first segment that cannot bend.

    Parameters
    ----------
    robot : Robot
    travel : float
        How far the stage goes, in the length unit.
    name : str
        What the segment of the stage is called.

    Raises
    ------
    InputError
        When the travel is not greater than 0, or a segment has this name.
    """
    reach = checks.number("travel", travel, above=0.0)
    back = np.eye(4)
    back[2, 3] = -sum(segment.length[1] for segment in robot.segments)
    stage = Segment((0.0, reach), max_bend=0.0, radius=robot.radii[0], name=checks.text("name", name))
    linear = robot.linear
    if linear is not None:
        wider = np.hstack([np.zeros((len(linear.matrix), 3)), linear.matrix])
        linear = Actuators(wider, names=list(linear.names), limits=linear.limits)
    named = [s.changed(name=n) for s, n in zip(robot.segments, robot.segment_names, strict=True)]
    return robot.changed(segments=[stage, *named], base=robot.base @ back, actuators=linear)
