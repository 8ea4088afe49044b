"""The same problem the other way round: from the target, through the route, to the base.

A chain that is grown out of a narrow place begins along it; one that is grown into it has to arrive along it.
"""

import math

import numpy as np

from sinuous.checks import Floats
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
from sinuous.poses import pose

Groups = tuple[Floats, Floats, Floats, Floats]
"""What entries are given of a problem: robot, scene, settings, targets."""

FLIP = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""

ROLLS = 16
"""Angles about the tangent that are looked at."""

BEFORE = 3
"""Points of a route that its tangent is taken over."""


def turned(groups: Groups, route: Floats) -> Groups | None:
    """Return the groups of the problem the other way round; `None` where the tip is not asked to be somewhere.

    Where the target leaves the direction open, or how far it is turned about it, the route (K, 3) decides. Where it
    asks for a rotation, the base is a rotation to end with. Of an elbow whose rotation is asked for only the direction
    is kept. The mount is left out, and so are limits of actuators: only the whole robot has to keep them.
    """
    robot, scene, settings, targets = groups
    n = int(robot[0])
    at_tip = np.isin(targets[:, TARGET_SEGMENT], (-1.0, n - 1.0))
    tip, elbows = targets[at_tip], targets[~at_tip]
    if len(tip) != 1 or tip[0, HAS_POSITION] == 0.0:
        return None
    rows = robot[ROBOT_HEADER : ROBOT_HEADER + SEGMENT_WIDTH * n].reshape(n, SEGMENT_WIDTH)
    base, tool = robot[-2 * POSE_WIDTH : -POSE_WIDTH], robot[-POSE_WIDTH:]
    at = _arrival(tip[0], tool[POSE_POSITION:], route)
    if at is None:
        return None
    rotation, position = _end(tip[0], _rotation(tool), tool[POSE_POSITION:], *at)
    begin, nothing = (rotation @ FLIP).ravel(), np.eye(3).ravel()
    header = [robot[0], 0.0, robot[2]]
    other = np.concatenate([header, rows[::-1].ravel(), begin, position, nothing, np.zeros(3)])
    row = np.zeros((1, TARGET_WIDTH))
    row[0, TARGET_SEGMENT], row[0, HAS_POSITION], row[0, ORIENTATION] = -1.0, 1.0, DIRECTION
    row[0, TARGET_POSITION : TARGET_POSITION + 3] = base[POSE_POSITION:]
    row[0, GOAL : GOAL + 3] = -_rotation(base)[:, 2]
    if tip[0, ORIENTATION] == ROTATION:
        row[0, ORIENTATION], row[0, GOAL : GOAL + 9] = ROTATION, (_rotation(base) @ FLIP).ravel()
    for elbow in elbows:
        elbow[TARGET_SEGMENT] = n - 2.0 - elbow[TARGET_SEGMENT]
        if elbow[ORIENTATION] != FREE:
            ahead = slice(GOAL, GOAL + 3) if elbow[ORIENTATION] == DIRECTION else slice(GOAL + 2, GOAL + 9, 3)
            elbow[ORIENTATION], elbow[GOAL : GOAL + 3] = DIRECTION, -elbow[ahead]
    told = settings.copy()
    told[MOUNT] = 0.0
    return other, scene, told, np.vstack([elbows, row])


def turned_back(groups: Groups, other: Groups, chain: Floats) -> Floats:
    """Return the configuration (n, 3) of a chain (n, 3) of the problem the other way round."""
    q = np.empty_like(chain)
    turn_round(groups[0], other[0], chain, q)
    return q


def _rotation(flat: Floats) -> Floats:
    return flat[:POSE_POSITION].reshape(3, 3)


def _arrival(target: Floats, shift: Floats, route: Floats) -> tuple[Floats, Floats] | None:
    """Place (3,) on a route (K, 3) where the backbone ends and the tool begins, and the route's tangent (3,) there.

    Where all of the route is nearer to the target than the tool is long, it is where the route begins. `None` where the
    route has no direction there.
    """
    goal = target[TARGET_POSITION : TARGET_POSITION + 3]
    beyond = np.flatnonzero(np.linalg.norm(route - goal, axis=1) >= np.linalg.norm(shift))
    before = min(BEFORE, len(route) - 1)
    at = max(before, int(beyond[-1]) if len(beyond) else 0)
    tangent = route[at] - route[at - before]
    length = float(np.linalg.norm(tangent))
    return None if length == 0.0 else (route[at], tangent / length)


def _end(target: Floats, tool: Floats, shift: Floats, place: Floats, tangent: Floats) -> tuple[Floats, Floats]:
    """Rotation and position of the end of the backbone at a target; what that leaves open, the route decides.

    `place` and `tangent` (3,) are those of the route where the backbone ends.
    """
    goal = target[TARGET_POSITION : TARGET_POSITION + 3]
    if target[ORIENTATION] == ROTATION:
        rotation = target[GOAL : GOAL + 9].reshape(3, 3) @ tool.T
        return rotation, goal - rotation @ shift
    free = target[ORIENTATION] == FREE
    turn = pose(direction=tangent if free else target[GOAL : GOAL + 3])[:3, :3]
    best, found = -math.inf, turn
    for roll in 2.0 * math.pi * np.arange(ROLLS) / ROLLS:
        spin = np.array(
            [[math.cos(roll), -math.sin(roll), 0.0], [math.sin(roll), math.cos(roll), 0.0], [0.0, 0.0, 1.0]]
        )
        rotation = turn @ spin if free else turn @ spin @ tool.T
        off = np.linalg.norm(goal - rotation @ shift - place)
        fits = float(-off if free else rotation[:, 2] @ tangent)
        if fits > best:
            best, found = fits, rotation
    return found, goal - found @ shift
