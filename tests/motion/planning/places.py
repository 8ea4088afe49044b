"""Places of plans: a blind square bore of boxes with an arm whose last segment is in it, and an arm among spheres."""

import numpy as np

import sinuous as sn
from benchmarks.places.cells import channel
from benchmarks.places.solids import box_between
from sinuous.motion.planning.query import Deadline, FixedGoal, Query
from sinuous.solver.certificates.steps import prove_steps
from tests.helpers import Floats
from tests.kernels.certificate.motions import shape

ROBOT = sn.Robot.uniform(5, 1.0, 2.4, radius=0.1)

INSIDE: Floats = np.array([[0.5, 0.2, 1.0], [-0.7, 0.3, 1.0], [0.4, -0.6, 1.0], [0.3, 0.5, 1.0], [0.0, 0.0, 1.0]])
OUTSIDE: Floats = np.array([[0.4, 0.0, 1.0], [0.4, 0.0, 1.0], [0.3, 0.1, 1.0], [0.2, 0.0, 1.0], [0.2, 0.0, 1.0]])

STRETCHING = sn.Robot([sn.Segment((0.8, 1.2), 2.8, radius=0.05)] * 4)

HALF, AHEAD = 0.14, 0.2
"""Half of the width of the bore, and how far its bottom is beyond the tip."""


def bore(q: Floats = INSIDE) -> list[sn.Box]:
    """Walls around the last segment of a configuration, from 0.05 before its middle on, and a bottom."""
    mouth = ROBOT.forward(q)[-2].copy()
    mouth[:3, 3] += 0.45 * mouth[:3, 2]
    depth = 0.55 + AHEAD
    low, high = np.array([-0.6, -0.6, depth]), np.array([0.6, 0.6, depth + 0.1])
    return [*channel(mouth, HALF, depth, 0.46), box_between(mouth, low, high, "bottom")]


def pair(seed: int, robot: sn.Robot = STRETCHING) -> tuple[sn.Scene, Floats]:
    """Spheres, and two configurations (2, n, 3) that are clear of them and of themselves."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-4.0, 4.0, (60, 3))
    scene = sn.Scene([sn.Sphere(c, 0.3) for c in centers if np.linalg.norm(c[:2]) > 0.4 or not -0.4 < c[2] < 4.4])
    ends: list[Floats] = []
    while len(ends) < 2:
        q = shape(robot, rng)
        if prove_steps(robot, scene.snapshot(), np.stack([q, q])).proved.all():
            ends.append(q)
    return scene, np.stack(ends)


def query(
    scene: sn.Scene, start: Floats = OUTSIDE, goal: Floats = INSIDE, seconds: float = 60.0, robot: sn.Robot = ROBOT
) -> Query:
    """Ask for a path from one configuration to another."""
    return Query(robot, scene.snapshot(), start, FixedGoal(goal), 0, Deadline(seconds))
