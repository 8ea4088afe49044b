"""A calibration of 41 parameters by Gauss-Newton, with derivatives of answers and with differences of them.

Where the ends of all segments were is measured, and what the actuators were set to is known. Base, tool and the circles
of tendons and chambers are fitted so that solving for these places gives these values.
"""

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from benchmarks.derivatives.differences import Tangent, question
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from sinuous.answer.solution import Solution
from sinuous.base.arguments import Parameter
from sinuous.base.checks import Floats
from sinuous.model.actuators import Chambers, Tendons
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.target import Target, Tolerance
from sinuous.solver.solver import Solver

SECTION = "a calibration of 41 parameters of 15 segments from the values of actuators in {count} shapes"
WIDTHS: dict[Parameter, int] = {"base": 6, "tool": 6, "tendons": 29}
SCALE = np.repeat([0.02, 0.02, 3e-3], list(WIDTHS.values()))
"""By how much parameters are wrong: rad and mean lengths of a segment."""

STEPS = 3
DIFFERENCE = 1e-6
DETERMINED = 1e-6
"""Singular value, relative to the largest, below which a combination of parameters stays as it is."""

Shapes = Sequence[tuple[Sequence[Target], Floats]]
"""What was measured in each shape, and a configuration near it."""


def changed(robot: Robot, change: Floats) -> Robot:
    """Return the robot with other parameters (41,)."""
    way: Tangent = dict(zip(WIDTHS, np.split(change, np.cumsum(list(WIDTHS.values()))[:-1]), strict=True))
    straight = np.tile([0.0, 0.0, 1.0], (len(robot), 1))
    return question(Solver(robot).solve(Target(robot.tip(straight)[:3, 3]), straight), way, 1.0).robot


def answers(robot: Robot, shapes: Shapes) -> list[Solution]:
    """Solve for what was measured."""
    solver = Solver(robot, tolerance=Tolerance(1e-10 * robot.mean_length, 1e-10))
    return [solver.solve(targets, near).raise_for_status() for targets, near in shapes]


def values(robot: Robot, shapes: Shapes) -> Floats:
    """Values of all actuators in all shapes, one after the other."""
    return np.ravel([robot.to_actuators(each.q) for each in answers(robot, shapes)])


def by_derivatives(robot: Robot, shapes: Shapes) -> Floats:
    """Derivatives of all values by all parameters."""
    rows = []
    for each in answers(robot, shapes):
        change = each.derivative(tuple(WIDTHS)).actuators
        rows.append(np.concatenate([change[name] for name in WIDTHS], axis=1))
    return np.concatenate(rows)


def by_differences(robot: Robot, shapes: Shapes) -> Floats:
    """The same by central differences."""
    columns = []
    for unit in DIFFERENCE * np.eye(len(SCALE)):
        ends = values(changed(robot, unit), shapes), values(changed(robot, -unit), shapes)
        columns.append((ends[0] - ends[1]) / (2.0 * DIFFERENCE))
    return np.column_stack(columns)


def measure(plan: Plan) -> Iterator[Line]:
    """Time both, and say how far off the values are in the end."""
    count = plan.count(20, 3)
    section = SECTION.format(count=count)
    rng = plan.rng(84)
    parts = [(Tendons(3, 0.1, 0.3 * k), Chambers(3, 0.08) if k < 14 else None) for k in range(15)]
    robot = Robot([Segment((0.5, 1.5), 2.5, tendons=tendons, chambers=chambers) for tendons, chambers in parts])
    hidden = changed(robot, SCALE * rng.normal(size=len(SCALE)))
    shapes: list[tuple[Sequence[Target], Floats]] = []
    for _ in range(count):
        q = np.column_stack([rng.uniform(-0.5, 0.5, size=(15, 2)), rng.uniform(0.8, 1.2, size=15)])
        ends = [*hidden.forward(q)[:-1, :3, 3], hidden.tip(q)[:3, 3]]
        shapes.append(([Target(end, segment=k + 1) for k, end in enumerate(ends)], q))
    wanted = values(hidden, shapes)
    ways: dict[str, Callable[[Robot, Shapes], Floats]] = {"derivatives": by_derivatives, "differences": by_differences}
    seconds = {}
    for name, derive in ways.items():
        fitted, began = robot, time.thread_time()
        for _ in range(STEPS):
            system, missing = derive(fitted, shapes), wanted - values(fitted, shapes)
            step = np.linalg.lstsq(system * SCALE, missing, rcond=DETERMINED)[0]
            fitted = changed(fitted, np.asarray(SCALE * step, np.float64))
        seconds[name] = time.thread_time() - began
        left = float(np.abs(wanted - values(fitted, shapes)).max())
        yield Line(section, f"with {name}", seconds[name], "s")
        yield Line(section, f"with {name}: largest error in the end, in mean lengths of a segment", left, "")
    yield Line(section, "times faster", seconds["differences"] / seconds["derivatives"], "", Goal(10.0, at_most=False))
