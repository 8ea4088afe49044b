"""Whether differences of answers agree with derivatives, in every family; and how many answers are regular."""

from collections.abc import Iterator

from numpy.random import Generator

from benchmarks.derivatives.differences import ALL, agreement, random_tangent
from benchmarks.derivatives.families import FAMILIES, draw, solver_for
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from sinuous.checks import Floats
from sinuous.problem.target import Target
from sinuous.solution.solution import Solution

SECTION = "derivatives against central differences of answers that are solved again from them"
WRONG = 1e-6
"""Relative difference from which on a derivative that was called regular is wrong."""

BESIDE = 16
"""Answers near each one that is drawn, whose targets are moved a little."""

TOLD = 10
"""Most wrong ones that are named: the draw, and which of the answers beside it."""

AWAY = 0.01
"""How far their targets are moved: rad, and mean lengths of the robot."""


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Lines of a family: the share of regular answers, wrong ones among them, the worst of those that agree."""
    count, number = plan.count(100_000 // (len(FAMILIES) * (BESIDE + 1)), 12), list(FAMILIES).index(family)
    total = regular = 0
    worst, wrong = 0.0, list[str]()
    for i in plan.track(range(count), family, count):
        rng = plan.rng(83, number, i)
        for j, found in enumerate(_some(family, rng)):
            total += 1
            way = random_tangent(found, rng)
            if j:  # for the others targets alone, which needs no other robot
                way = {"target": way["target"]}
            derivative = found.derivative(ALL if j == 0 else "target")
            if derivative.regular:
                regular += 1
                error = agreement(found, derivative.jvp(way), way).error
                if error <= WRONG:
                    worst = max(worst, error)
                else:
                    wrong.append(f"{i}.{j}")
    yield Line(SECTION, f"{family}: regular", 100.0 * regular / max(total, 1), "%", note=f"of {total:,} answers")
    told = ", ".join(wrong[:TOLD])
    yield Line(SECTION, f"{family}: wrong among those", float(len(wrong)), "", Goal(0.0, correctness=True), note=told)
    yield Line(SECTION, f"{family}: largest difference of the others", worst, "", Goal(WRONG))


def _some(family: str, rng: Generator) -> Iterator[Solution]:
    """An answer of a family, and others beside it."""
    first = draw(family, rng)
    if first is None:
        return
    yield first
    solver = solver_for(first.problem.robot, list(first.problem.scene.obstacles))
    for _ in range(BESIDE):
        q = first.q + AWAY * rng.normal(size=first.q.shape) * first.problem.robot.limits[:, [5, 5, 6]]
        if first.problem.robot.excess(q) > 0.0:
            continue
        targets = [_at(first, i, q) for i in range(len(first.problem.targets))]
        found = solver.solve(targets, q)
        if found.solved:
            yield found


def _at(found: Solution, i: int, q: Floats) -> Target:
    """What a target asks for, where a configuration has it."""
    target, robot = found.problem.targets[i], found.problem.robot
    last = target.segment is None or target.segment == len(robot)
    pose = robot.tip(q) if last else robot.forward(q)[(target.segment or 0) - 1]
    return Target(
        None if target.position is None else pose[:3, 3],
        direction=None if target.direction is None else pose[:3, 2],
        rotation=None if target.rotation is None else pose[:3, :3],
        segment=target.segment,
    )
