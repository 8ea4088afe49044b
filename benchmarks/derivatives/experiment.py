"""`python -m benchmarks derivatives`: whether differences of answers agree with derivatives, and what these cost.

In every family it is counted how many answers are regular. Costs are those beyond the solve: by the target, and by
everything.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.derivatives.differences import (
    ALL,
    SHARES,
    Tangent,
    agreement,
    agreement_of_minima,
    least_gaps,
    question,
    random_tangent,
)
from benchmarks.derivatives.families import FAMILIES, SHAPES, draw, loaded, preferred, solver_for
from benchmarks.harness.experiment import Part
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.harness.plan import Plan
from sinuous.base.arguments import LoadParameter, Parameter
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle
from sinuous.statics.equilibrium import find_equilibrium
from sinuous.statics.response import GROUPS as LOADS

SECTION = "derivatives against central differences of answers that are solved again from them"
WRONG = 1e-6
"""Relative difference from which on a derivative that was called regular is wrong."""

MANY = 153_000
"""Answers that would be asked for if each draw made as many as it can; 100,000 are left."""

BESIDE = 16
"""Answers near each one that is drawn, whose targets are moved a little."""

DEAR = 6
"""The same where to compare one takes long."""

TOLD = 10
"""Most wrong ones that are named: the draw, and which of the answers beside it."""

AWAY = 0.01
"""How far their targets are moved: rad, and mean lengths of the robot."""


class Compared(NamedTuple):
    """What became of one derivative: whether it was called regular, and then its relative difference."""

    regular: bool
    error: float = np.nan


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Lines of a family: the share of regular answers, wrong ones among them, the worst of those that agree."""
    count, number = plan.count(MANY // (len(COMPARED) * (BESIDE + 1)), 12), list(COMPARED).index(family)
    total = regular = 0
    worst, wrong = 0.0, list[str]()
    for i in plan.track(range(count), family, count):
        for j, each in enumerate(COMPARED[family](plan.rng(83, number, i))):
            total += 1
            regular += each.regular
            if each.error <= WRONG:
                worst = max(worst, each.error)
            elif each.regular:
                wrong.append(f"{i}.{j}")
    yield Line(SECTION, f"{family}: regular", 100.0 * regular / max(total, 1), "%", note=f"of {total:,} answers")
    told = ", ".join(wrong[:TOLD])
    yield Line(SECTION, f"{family}: wrong among those", float(len(wrong)), "", Goal(0.0, correctness=True), note=told)
    yield Line(SECTION, f"{family}: largest difference of the others", worst, "", Goal(WRONG))


def _answers(family: str, rng: Generator) -> Iterator[Compared]:
    """Of answers, along a motion of all parameters at once the first, of the target those beside it."""
    for j, found in enumerate(_some(family, rng)):
        way = random_tangent(found, rng)
        if j:  # for the others targets alone, which needs no other robot
            way = {"target": way["target"]}
        derivative = found.derivative(ALL if j == 0 else "target")
        yield (
            Compared(True, agreement(found, derivative.jvp(way), way).error) if derivative.regular else Compared(False)
        )


def _clearances(rng: Generator) -> Iterator[Compared]:
    """Of clearances beside obstacles, along a motion of all parameters at once."""
    for found in islice(_some("beside obstacles", rng), DEAR):
        derivative, way = found.derivative(ALL), random_tangent(found, rng)
        assert derivative.clearance is not None
        change = float(np.sum([derivative.clearance[name] @ way[name] for name in ALL]))
        motion = derivative.jvp(way)
        if not derivative.regular or not np.isfinite(change):
            yield Compared(False)
            continue
        error, size = np.inf, found.problem.robot.mean_length
        for h in SHARES:
            ends = [_gap_at(found, way, sign * h, motion) for sign in (1.0, -1.0)]
            error = min(error, abs((ends[0] - ends[1]) / (2.0 * h) - change) / max(abs(change), size))
        yield Compared(True, error)


def _gap_at(found: sn.Solution, way: Tangent, h: float, motion: Floats) -> float:
    asked = question(found, way, h)
    return float(least_gaps(sn.Problem(asked.robot, asked.targets, asked.scene), (found.q + h * motion)[None])[0])


def _preferred(rng: Generator) -> Iterator[Compared]:
    """Of answers that preferences have chosen, along motions of all parameters at once."""
    for shape in SHAPES:
        found = preferred(shape, rng).found
        if not found.solved:
            continue
        derivative = found.derivative(ALL)
        for _ in range(DEAR // len(SHAPES)):
            way = random_tangent(found, rng)
            yield (
                Compared(True, agreement_of_minima(found, derivative.jvp(way), way).error)
                if derivative.regular
                else Compared(False)
            )


def _loaded(rng: Generator) -> Iterator[Compared]:
    """Of shapes under load: one parameter each, against shapes that are found anew, with two steps."""
    try:
        found = loaded(rng)
    except (sn.InputError, sn.NotSolvedError):
        return
    groups: tuple[LoadParameter, ...] = "loads", "payload", "gravity", "stiffness", "base", "q"
    derivative = found.derivative(groups)
    columns = [(name, i) for name in groups for i in range(len(derivative.labels(name)))]
    for at in rng.permutation(len(columns))[: BESIDE + 1]:
        if not derivative.regular:
            yield Compared(False)
            continue
        name, i = columns[at]
        column = list(LOADS[name](found.question))[i]
        ends = [find_equilibrium(column.changed(h * column.scale)).states for h in (1e-3, -1e-3, 5e-4, -5e-4)]
        change = (8.0 * (ends[2] - ends[3]) - (ends[0] - ends[1])) / 6e-3 / column.scale
        scale = np.abs(derivative.states[name]).max()
        yield Compared(True, float(np.abs(derivative.states[name][..., i] - change).max() / scale))


def _some(family: str, rng: Generator) -> Iterator[sn.Solution]:
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


def _at(found: sn.Solution, i: int, q: Floats) -> sn.Target:
    """What a target asks for, where a configuration has it."""
    target, robot = found.problem.targets[i], found.problem.robot
    last = target.segment is None or target.segment == len(robot)
    pose = robot.tip(q) if last else robot.forward(q)[(target.segment or 0) - 1]
    return sn.Target(
        None if target.position is None else pose[:3, 3],
        direction=None if target.direction is None else pose[:3, 2],
        rotation=None if target.rotation is None else pose[:3, :3],
        segment=target.segment,
    )


COMPARED: dict[str, Callable[[Generator], Iterator[Compared]]] = {
    **{family: partial(_answers, family) for family in FAMILIES},
    "clearances": _clearances,
    "preferred": _preferred,
    "under load": _loaded,
}
"""What is derived and compared with differences."""


COSTS = "time of a derivative beyond the solve (5 segments with tendons, thread time)"
SPHERES = 40
REPEATS = 20


def measure_costs(plan: Plan) -> Iterator[Line]:
    """A line for what is asked, in free space and among spheres."""
    robot = sn.Robot.uniform(
        5, (80.0, 120.0), max_bend=2.0, radius=4.0, tendons=sn.Tendons(3, 3.0, displacement=(-9.0, 9.0))
    )
    for scene, where, more in (([], "", 0.0), (_spheres(plan), f" among {SPHERES} spheres", 10e-6)):
        answers = list(_solved(sn.Solver(robot, scene), plan.count(500, 20), plan))
        for wrt, what, goal in ((("target",), "by the target", 5e-6), (ALL, "by everything", 20e-6)):
            times = Times.of(_times(answers, wrt))
            yield Line(COSTS, f"{what}{where}", times.median, "us", Goal(goal + more), times)


def _spheres(plan: Plan) -> list[Obstacle]:
    rng = plan.rng(81)
    ways = rng.normal(size=(SPHERES, 3))
    ways[:, 2] = np.abs(ways[:, 2])
    return [sn.Sphere(520.0 * way / np.linalg.norm(way) + (0.0, 0.0, 80.0), 60.0) for way in ways]


def _solved(solver: sn.Solver, count: int, plan: Plan) -> Iterator[sn.Solution]:
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


PARTS: dict[str, Part] = {
    "costs": measure_costs,
    **{f"agreement {family}": partial(measure, family=family) for family in COMPARED},
}
"""What is measured, in order: of agreement each family is one part, so that a run goes on after the last."""
