"""One problem as kernels see it: the groups of `tables`, taken apart."""

from collections import namedtuple

from sinuous.kernels import tables as t
from sinuous.kernels.fields.distances import read_scene
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array

Robot = namedtuple("Robot", ["limits", "actuation", "base", "tool", "avoids_itself"])
"""Rows of segments (n, 35) and of actuator limits (p, 7); poses of base and tool (1, 12); whether its body must not run
through itself."""

Problem = namedtuple(
    "Problem",
    "limits actuation base tool avoids_itself scene targets mount unit margin position_tolerance angle_tolerance "
    "coarse_depth step_depth",
)
"""What does not change during a solve: `Robot`, the scene or `None` (see `distances.Scene`), rows of targets (t, 15);
the settings by their names (lengths in the length unit, angles in rad)."""


def read_robot(robot: Array) -> Robot:
    """Take the group of a robot apart."""
    limits, rest = cut(robot[t.ROBOT_HEADER :], int(robot[0]), t.SEGMENT_WIDTH)
    actuation, rest = cut(rest, int(robot[1]), t.ACTUATOR_WIDTH)
    base, rest = cut(rest, 1, t.POSE_WIDTH)
    tool, rest = cut(rest, 1, t.POSE_WIDTH)
    return Robot(limits, actuation, base, tool, robot[2] != 0.0)


def read_problem(robot: Array, scene: Array | None, settings: Array, targets: Array) -> Problem:
    """Take the groups of one problem apart; layouts as `tables` says, `targets` (t, 15)."""
    own = read_robot(robot)
    return Problem(
        own.limits,
        own.actuation,
        own.base,
        own.tool,
        own.avoids_itself,
        read_scene(scene),
        targets,
        settings[t.MOUNT],
        settings[t.UNIT],
        settings[t.MARGIN],
        settings[t.POSITION_TOLERANCE],
        settings[t.ANGLE_TOLERANCE],
        int(settings[t.COARSE_DEPTH]),
        int(settings[t.STEP_DEPTH]),
    )


def answer_of(answers: Array, i: int, n: int) -> tuple[Array, Array]:
    """Configuration (n, 3) and record (11,) of answer `i` of `answers` (m, 11 + 3 n)."""
    record, rest = cut(answers[i], t.RECORD_WIDTH)
    best, _ = cut(rest, n, 3)
    return best, record
