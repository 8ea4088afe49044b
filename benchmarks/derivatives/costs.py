"""What the derivative of an answer costs beyond the solve: by the target, and by everything."""

import time
from collections.abc import Iterator, Sequence

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from sinuous.answer.derivatives.parameters import GROUPS
from sinuous.base.arguments import Parameter
from sinuous.scene.obstacles import Obstacle

SECTION = "time of a derivative beyond the solve (5 segments with tendons, thread time)"
ALL: tuple[Parameter, ...] = tuple(GROUPS)
SPHERES = 40
REPEATS = 20


def measure(plan: Plan) -> Iterator[Line]:
    """A line for what is asked, in free space and among spheres."""
    robot = sn.Robot.uniform(
        5, (80.0, 120.0), max_bend=2.0, radius=4.0, tendons=sn.Tendons(3, 3.0, displacement=(-9.0, 9.0))
    )
    for scene, where, more in (([], "", 0.0), (_spheres(plan), f" among {SPHERES} spheres", 10e-6)):
        answers = list(_answers(sn.Solver(robot, scene), plan.count(500, 20), plan))
        for wrt, what, goal in ((("target",), "by the target", 5e-6), (ALL, "by everything", 20e-6)):
            times = Times.of(_times(answers, wrt))
            yield Line(SECTION, f"{what}{where}", times.median, "us", Goal(goal + more), times)


def _spheres(plan: Plan) -> list[Obstacle]:
    rng = plan.rng(81)
    ways = rng.normal(size=(SPHERES, 3))
    ways[:, 2] = np.abs(ways[:, 2])
    return [sn.Sphere(520.0 * way / np.linalg.norm(way) + (0.0, 0.0, 80.0), 60.0) for way in ways]


def _answers(solver: sn.Solver, count: int, plan: Plan) -> Iterator[sn.Solution]:
    rng = plan.rng(82)
    made = 0
    while made < count:
        found = solver.solve(sn.Target((200.0 * rng.normal(), 200.0 * rng.normal(), 350.0 + 30.0 * rng.normal())))
        if found.solved:
            made += 1
            yield found


def _times(answers: Sequence[sn.Solution], wrt: Sequence[Parameter]) -> list[float]:
    for each in answers[:3]:
        each.derivative(wrt)
    chosen, times = tuple(wrt), []
    for each in answers:
        began = time.thread_time()
        for _ in range(REPEATS):
            each.derivative(chosen)
        times.append((time.thread_time() - began) / REPEATS)
    return times
