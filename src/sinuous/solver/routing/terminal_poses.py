"""Roots: poses in which a chain from the target to the base may begin.

What the target leaves open, its direction or how far it is turned about it, is seldom open in a narrow place: a tool
that points aside has few ways to lie in a tube. So poses are tried, and those from which a straight line goes back with
the most room come first.
"""

import math

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.fitting.lines import distances_along
from sinuous.kernels.fitting.query import ball_radius
from sinuous.model.poses import least_rotation
from sinuous.solver.routing.partial_problems import segments_in
from sinuous.solver.routing.reversed_problem import FLIP, Groups

MOST = 12
"""Roots at most."""

DIRECTIONS, ROLLS = 64, 16
"""Directions that are tried where the target leaves it open, and angles about one where a tool points aside. With both,
twice as many directions, each at one angle."""

STEPS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0)
"""Places behind a root where it is looked for room, and how much is enough. In radii of the body."""

ENOUGH = 1.25
"""Room that is enough there, in radii of the body."""

IN_WALL = 0.75
"""Room that a root lacks at most, in radii of the body: a pose that lacks more ends in a wall, however open what lies
behind it (a tool that leads through the wall of a tube: two tubes)."""

AGREEMENT = 1e-3
"""What a pose counts that is turned away from the route, beside the mean square of the room that it lacks: decides
between poses in the open."""

APART = 0.35
"""How far roots are apart, in rad; two radii of the body count as one."""

BEFORE = 3
"""Points of a route that its tangent is taken over."""

GOLDEN = 0.618034
"""Share of a turn between neighbours that have one angle each."""


def find_terminal_poses(groups: Groups, route: Floats) -> Floats:
    """Return poses (r, 12) in which chains from the target may begin, the best first.

    There is none where the tip is not asked to be somewhere, or where the route (K, 3) has no direction there.
    """
    robot, scene, _, targets = groups
    tips = targets[np.isin(targets[:, t.TARGET_SEGMENT], (-1.0, robot[0] - 1.0))]
    tool = robot[-t.POSE_WIDTH :]
    tangent = None if len(tips) != 1 or tips[0, t.HAS_POSITION] == 0.0 else _arrival(tips[0], tool, route)
    if tangent is None:
        return np.empty((0, t.POSE_WIDTH))
    ends = _ends(tips[0], tool, tangent)
    places = tips[0, t.TARGET_POSITION : t.TARGET_POSITION + 3] - ends @ tool[t.POSE_POSITION :]
    ahead, radius = ends[:, :, 2], ball_radius(segments_in(robot))
    order = [0]
    if len(ends) > 1:
        points = places[:, None] - radius * np.array(STEPS)[:, None] * ahead[:, None]
        distances = np.empty(points.size // 3)
        distances_along(scene, points.reshape(-1, 3).copy(), ENOUGH * radius, distances)
        lack = np.maximum(0.0, ENOUGH - distances.reshape(len(ends), -1) / radius)
        squares = lack * lack
        ranked = np.argsort(squares[:, 0] + squares.mean(axis=1) - AGREEMENT * ahead @ tangent, kind="stable")
        order = [i for i in ranked.tolist() if lack[i, 0] <= IN_WALL] or ranked[:1].tolist()
    chosen: list[int] = []
    for i in order:
        if len(chosen) == MOST:
            break
        turns = np.arccos(np.clip(ahead[chosen] @ ahead[i], -1.0, 1.0))
        off = turns + np.linalg.norm(places[chosen] - places[i], axis=1) / (2.0 * radius)
        if (off > APART).all():
            chosen.append(i)
    return np.stack([np.append((ends[i] @ FLIP).ravel(), places[i]) for i in chosen])


def _arrival(target: Floats, tool: Floats, route: Floats) -> Floats | None:
    """Tangent (3,) of a route (K, 3) where the backbone ends and the tool (12,) begins; `None` where it has none.

    Where all of the route is nearer to the target than the tool is long, that is where the route begins.
    """
    goal = target[t.TARGET_POSITION : t.TARGET_POSITION + 3]
    beyond = np.flatnonzero(np.linalg.norm(route - goal, axis=1) >= np.linalg.norm(tool[t.POSE_POSITION :]))
    before = min(BEFORE, len(route) - 1)
    at = max(before, int(beyond[-1]) if len(beyond) else 0)
    tangent: Floats = route[at] - route[at - before]
    length = float(np.linalg.norm(tangent))
    return None if length == 0.0 else tangent / length


def _ends(target: Floats, tool: Floats, tangent: Floats) -> Floats:
    """Rotations (m, 3, 3) of the end of the backbone at a target; what that leaves open is tried."""
    held, aside = tool[: t.POSE_POSITION].reshape(3, 3), bool(tool[t.POSE_POSITION : t.POSE_POSITION + 2].any())
    if target[t.ORIENTATION] == t.ROTATION:
        return (target[t.GOAL : t.GOAL + 9].reshape(3, 3) @ held.T)[None]
    if target[t.ORIENTATION] == t.DIRECTION:
        rolls = np.arange(ROLLS) / ROLLS if aside or held[2, 2] < 1.0 else np.zeros(1)
        ahead = least_rotation(target[t.GOAL : t.GOAL + 3])
        return np.stack([ahead @ _spin(roll) @ held.T for roll in rolls])
    count = 2 * DIRECTIONS if aside else DIRECTIONS
    number = np.arange(count - 1) + 0.5
    height, turn = 1.0 - 2.0 * number / (count - 1), math.pi * (1.0 + math.sqrt(5.0)) * number
    level = np.sqrt(1.0 - height * height)
    around = np.stack([level * np.cos(turn), level * np.sin(turn), height], axis=1)
    turned = [least_rotation(ahead) for ahead in np.vstack([tangent, around])]
    return np.stack([each @ _spin(GOLDEN * i) for i, each in enumerate(turned)] if aside else turned)


def _spin(turns: float) -> Floats:
    """Rotation (3, 3) about z."""
    cosine, sine = math.cos(2.0 * math.pi * turns), math.sin(2.0 * math.pi * turns)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
