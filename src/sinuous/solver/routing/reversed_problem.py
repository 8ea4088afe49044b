"""The same problem the other way round: from the target, through the route, to the base.

A chain that is grown out of a narrow place begins along it; one that is grown into it has to arrive along it.
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.growing.turning import turn_round

Groups = tuple[Floats, Floats, Floats, Floats]
"""What entries are given of a problem: robot, scene, settings, targets."""

FLIP = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""


def reverse_problem(groups: Groups, root: Floats) -> Groups:
    """Return the groups of the problem the other way round, of chains that begin with the pose `root` (12,).

    Where the target asks for a rotation, the base is a rotation to end with. Of an elbow whose rotation is asked for
    only the direction is kept. The mount is left out, and so are limits of actuators: only the whole robot has to keep
    them.
    """
    robot, scene, settings, targets = groups
    n = int(robot[0])
    at_tip = np.isin(targets[:, t.TARGET_SEGMENT], (-1.0, n - 1.0))
    tip, elbows = targets[at_tip][0], targets[~at_tip]
    rows = robot[t.ROBOT_HEADER : t.ROBOT_HEADER + t.SEGMENT_WIDTH * n].reshape(n, t.SEGMENT_WIDTH)
    base = robot[-2 * t.POSE_WIDTH : -t.POSE_WIDTH]
    against = base[: t.POSE_POSITION].reshape(3, 3) @ FLIP
    header = [robot[0], 0.0, robot[2]]
    other = np.concatenate([header, rows[::-1].ravel(), root, np.eye(3).ravel(), np.zeros(3)])
    row = np.zeros((1, t.TARGET_WIDTH))
    row[0, t.TARGET_SEGMENT], row[0, t.HAS_POSITION] = -1.0, 1.0
    row[0, t.TARGET_POSITION : t.TARGET_POSITION + 3] = base[t.POSE_POSITION :]
    if tip[t.ORIENTATION] == t.ROTATION:
        row[0, t.ORIENTATION], row[0, t.GOAL : t.GOAL + 9] = t.ROTATION, against.ravel()
    else:
        row[0, t.ORIENTATION], row[0, t.GOAL : t.GOAL + 3] = t.DIRECTION, against[:, 2]
    for elbow in elbows:
        elbow[t.TARGET_SEGMENT] = n - 2.0 - elbow[t.TARGET_SEGMENT]
        if elbow[t.ORIENTATION] != t.FREE:
            first, last, step = (0, 3, 1) if elbow[t.ORIENTATION] == t.DIRECTION else (2, 9, 3)
            ahead = slice(t.GOAL + first, t.GOAL + last, step)
            elbow[t.ORIENTATION], elbow[t.GOAL : t.GOAL + 3] = t.DIRECTION, -elbow[ahead]
    told = settings.copy()
    told[t.MOUNT] = 0.0
    return other, scene, told, np.vstack([elbows, row])


def problem_from_pose(groups: Groups, root: Floats) -> Groups:
    """Return the same problem for a robot that begins with the pose `root` (12,)."""
    robot = groups[0].copy()
    robot[-2 * t.POSE_WIDTH : -t.POSE_WIDTH] = root
    return (robot, *groups[1:])


def reverse_chain(groups: Groups, other: Groups, chain: Floats) -> Floats:
    """Return the configuration (n, 3) of a chain (n, 3) of the problem the other way round."""
    q = np.empty_like(chain)
    turn_round(groups[0], other[0], chain, q)
    return q


def join_chains(groups: Groups, head: Floats, other: Groups, tail: Floats) -> Floats:
    """Return the chain (n, 3) of one part (k, 3), and a part (n - k, 3) of the other problem, which it meets."""
    frames = np.empty((1, len(head) + 1, t.POSE_WIDTH))
    base = groups[0][-2 * t.POSE_WIDTH : -t.POSE_WIDTH]
    frames_of(head[None].copy(), base.reshape(1, t.POSE_WIDTH).copy(), frames)
    return np.concatenate([head, reverse_chain(problem_from_pose(groups, frames[0, -1]), other, tail)])
