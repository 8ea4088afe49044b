"""The same problem the other way round: from the target, through the route, to the base.

A chain that is grown out of a narrow place begins along it; one that is grown into it has to arrive along it.
"""

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.growing.turning import turn_round
from sinuous.kernels.tables import (
    DIRECTION,
    FREE,
    GOAL,
    HAS_POSITION,
    MOUNT,
    ORIENTATION,
    POSE_POSITION,
    POSE_WIDTH,
    ROBOT_HEADER,
    ROTATION,
    SEGMENT_WIDTH,
    TARGET_POSITION,
    TARGET_SEGMENT,
    TARGET_WIDTH,
)

Groups = tuple[Floats, Floats, Floats, Floats]
"""What entries are given of a problem: robot, scene, settings, targets."""

FLIP = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""


def turned(groups: Groups, root: Floats) -> Groups:
    """Return the groups of the problem the other way round, of chains that begin with the pose `root` (12,).

    Where the target asks for a rotation, the base is a rotation to end with. Of an elbow whose rotation is asked for
    only the direction is kept. The mount is left out, and so are limits of actuators: only the whole robot has to keep
    them.
    """
    robot, scene, settings, targets = groups
    n = int(robot[0])
    at_tip = np.isin(targets[:, TARGET_SEGMENT], (-1.0, n - 1.0))
    tip, elbows = targets[at_tip][0], targets[~at_tip]
    rows = robot[ROBOT_HEADER : ROBOT_HEADER + SEGMENT_WIDTH * n].reshape(n, SEGMENT_WIDTH)
    base = robot[-2 * POSE_WIDTH : -POSE_WIDTH]
    against = base[:POSE_POSITION].reshape(3, 3) @ FLIP
    header = [robot[0], 0.0, robot[2]]
    other = np.concatenate([header, rows[::-1].ravel(), root, np.eye(3).ravel(), np.zeros(3)])
    row = np.zeros((1, TARGET_WIDTH))
    row[0, TARGET_SEGMENT], row[0, HAS_POSITION] = -1.0, 1.0
    row[0, TARGET_POSITION : TARGET_POSITION + 3] = base[POSE_POSITION:]
    if tip[ORIENTATION] == ROTATION:
        row[0, ORIENTATION], row[0, GOAL : GOAL + 9] = ROTATION, against.ravel()
    else:
        row[0, ORIENTATION], row[0, GOAL : GOAL + 3] = DIRECTION, against[:, 2]
    for elbow in elbows:
        elbow[TARGET_SEGMENT] = n - 2.0 - elbow[TARGET_SEGMENT]
        if elbow[ORIENTATION] != FREE:
            ahead = slice(GOAL, GOAL + 3) if elbow[ORIENTATION] == DIRECTION else slice(GOAL + 2, GOAL + 9, 3)
            elbow[ORIENTATION], elbow[GOAL : GOAL + 3] = DIRECTION, -elbow[ahead]
    told = settings.copy()
    told[MOUNT] = 0.0
    return other, scene, told, np.vstack([elbows, row])


def rooted(groups: Groups, root: Floats) -> Groups:
    """Return the same problem for a robot that begins with the pose `root` (12,)."""
    robot = groups[0].copy()
    robot[-2 * POSE_WIDTH : -POSE_WIDTH] = root
    return (robot, *groups[1:])


def turned_back(groups: Groups, other: Groups, chain: Floats) -> Floats:
    """Return the configuration (n, 3) of a chain (n, 3) of the problem the other way round."""
    q = np.empty_like(chain)
    turn_round(groups[0], other[0], chain, q)
    return q


def joined(groups: Groups, head: Floats, other: Groups, tail: Floats) -> Floats:
    """Return the chain (n, 3) of one part (k, 3), and a part (n - k, 3) of the other problem, which it meets."""
    frames = np.empty((1, len(head) + 1, POSE_WIDTH))
    base = groups[0][-2 * POSE_WIDTH : -POSE_WIDTH]
    frames_of(head[None].copy(), base.reshape(1, POSE_WIDTH).copy(), frames)
    return np.concatenate([head, turned_back(rooted(groups, frames[0, -1]), other, tail)])
