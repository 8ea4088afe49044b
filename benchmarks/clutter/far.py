"""What a large mesh costs a solve that does not meet it."""

import math
from collections.abc import Iterator
from time import perf_counter

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.places.parts.surfaces import Surface, loft, solid
from benchmarks.problems import ProblemSet, arm, reachable
from sinuous.base.checks import Floats
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver

SECTION = "added to a solve in free space by a mesh of 100,000 triangles (5 segments, position and direction; median)"
SLACK = 2e-6
"""Noise of the difference, seconds."""

SIDES = 224
"""Of a ball, around and from pole to pole: 99,904 triangles."""

REPEATS = 3
"""Solves of each target, of which the quickest counts: what is measured is less than the noise of a single one."""


def measure(plan: Plan) -> Iterator[Line]:
    """A ball beside the robot, out of its reach, and a hollow ball around it."""
    robot = arm(5, 2.4, radius=4.0)
    problems = reachable(robot, plan.count(300, 10), plan.rng(8))
    unit = robot.mean_length
    beside = solid(ball(np.array([3.0 * unit, 0.0, 0.0]), unit), "ball")
    around = Mesh(*ball(np.zeros(3), 2.0 * unit), inside=True, name="hollow")
    free = _seconds(problems, Scene())
    for what, mesh in (("beside the robot", beside), ("around the robot", around)):
        added = _seconds(problems, Scene([mesh])) - free
        yield Line(SECTION, what, float(np.median(added)), "us", Goal(20e-6), Times.of(added), slack=SLACK)


def ball(center: Floats, radius: float) -> Surface:
    """Return a ball of `2 * SIDES * (SIDES - 1)` triangles."""
    lean = math.pi * np.arange(1, SIDES)[:, None] / SIDES
    turn = 2.0 * math.pi * np.arange(SIDES) / SIDES
    height = np.broadcast_to(-np.cos(lean), (SIDES - 1, SIDES))
    rings = np.stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), height], axis=-1)
    poles = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    return loft(center + radius * rings, center + radius * poles)


def _seconds(problems: ProblemSet, scene: Scene) -> Floats:
    """Seconds (m,) of each target."""
    solver = Solver(problems.robot, scene, tolerance=problems.tolerance)
    solver.solve(problems.targets[0])
    found = []
    for target in problems.targets:
        spent = []
        for _ in range(REPEATS):
            began = perf_counter()
            solver.solve(target)
            spent.append(perf_counter() - began)
        found.append(min(spent))
    return np.array(found)
