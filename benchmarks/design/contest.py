"""A design against the best of many random robots of the same ranges, and against the template."""

import time
from collections.abc import Iterator

import numpy as np

from benchmarks.design.problems import DesignProblem, problem
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from sinuous.scene.scene import Scene
from sinuous.studies.design.fields import Space
from sinuous.studies.design.find import SOLVE_TIME, STARTS, design
from sinuous.studies.design.judge import Judge
from sinuous.studies.design.objectives import read_objectives
from sinuous.studies.tasks.assess import assess
from sinuous.studies.tasks.tasks import read_tasks

SECTION = "a robot for 20 tasks, 4 varied fields, 2 workers, against {count} random ones"
PROBLEMS = 10
ROBOTS = 600


def measure(plan: Plan) -> Iterator[Line]:
    """A line a problem, then how often it was better, and the longest time."""
    problems, count = plan.count(PROBLEMS, 1), plan.count(1000, 20)
    section = SECTION.format(count=f"{count:,}")
    seconds, better, beyond = [], 0, 0
    for number in plan.track(range(problems), "problems", problems):
        asked = problem(number, plan.rng(91, number))
        given = asked.template, asked.tasks, asked.scene
        began = time.perf_counter()
        robots = plan.count(ROBOTS, 64)
        found = design(*given, vary=asked.vary, minimise=asked.minimise, robots=robots, workers=2)
        seconds.append(time.perf_counter() - began)
        best = np.inf if found.best is None else _least(asked, found.best.objectives[asked.minimise])
        true = found.solved and assess(found.robot, asked.tasks, asked.scene).solved
        chance, template = _random(asked, count, plan)
        better += bool(true and best < chance)
        beyond += bool(true and best < template)
        told = f"template {abs(template):.4g}, best of {count:,} random {abs(chance):.4g}; {found.tried:,} tried"
        yield Line(section, asked.name, abs(float(best)), "", note=told)
        yield Line(section, f"{asked.name}: time", seconds[-1], "s")
    yield Line(section, "better than the best random robot", float(better), "", Goal(0.9 * problems, at_most=False))
    yield Line(section, "better than the template", float(beyond), "", Goal(float(problems), at_most=False))
    yield Line(section, "longest time", max(seconds), "s", Goal(60.0))


def _least(asked: DesignProblem, value: float) -> float:
    return -value if asked.minimise == "clearance" else value


def _random(asked: DesignProblem, count: int, plan: Plan) -> tuple[float, float]:
    """The least of random robots that do all tasks, and what the template has."""
    space = Space(asked.template, asked.vary)
    minimise = read_objectives(asked.minimise, asked.template)
    options = {"time": SOLVE_TIME, "max_starts": STARTS}
    judge = Judge(space, read_tasks(asked.tasks), Scene(asked.scene), minimise, options)
    rng, least = plan.rng(92), np.inf
    for _ in range(count):
        combination = space.combinations[int(rng.integers(len(space.combinations)))]
        robot = space.robot(combination, rng.random(len(space.ranges)))
        least = min(least, judge.judge(robot, np.array([least]), stops=True).objectives[0])
    return least, judge.judge(asked.template).objectives[0]
