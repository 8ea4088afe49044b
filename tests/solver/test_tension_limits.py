"""Control steps and solutions keep limits of tension, as a linear program and energies say that share no code."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.statics import lacking_stretch
from sinuous.model.rates import Changes

DT = 0.5


def arm(length: Any = 60.0, count: int = 3, **tendons: Any) -> sn.Robot:
    lines = sn.Tendons(count, 4.0, stiffness=50.0, **{"tension": (0.0, 10.0), **tendons})
    return sn.Robot([sn.Segment(length, max_bend=2.5, radius=3.0, tendons=lines, stiffness=2000.0) for _ in range(2)])


def within(robot: sn.Robot, q: Any) -> bool:
    return robot.violations(q) == [] and lacking_stretch(robot, q) <= 1e-9 * robot.mean_length


@pytest.mark.parametrize(
    "robot", [arm(), arm(count=4), arm(count=2), arm((40.0, 80.0)), arm(displacement=(-3.0, 4.0))], ids=repr
)
def test_steps_keep_limits_of_tension_and_go_on_along_them(robot: sn.Robot) -> None:
    solver, random, held = sn.Solver(robot), np.random.default_rng(2), 0
    for _ in range(6):
        q = np.array([[0.05, 0.0, 60.0], [-0.02, 0.0, 60.0]])
        velocity = random.normal(0.0, 1.0, 3) * [40.0, 40.0, 10.0]
        for _ in range(8):
            step = solver.step(q, velocity, DT)
            assert robot.excess(np.stack([step.q, 0.5 * (step.q + q)])) <= 1e-9, step
            held += any(each.constraint == "actuator" and each.actuator for each in step.active)
            q = step.q
        assert within(robot, q)
    assert held > 0, "nothing was held back"


def test_a_step_uses_all_of_the_tension_that_is_allowed() -> None:
    robot, q = arm(), np.array([[0.1, 0.0, 60.0], [0.0, 0.1, 60.0]])
    loose = arm(tension=(0.0, 1e6))
    solver = sn.Solver(robot)
    for _ in range(30):
        q = solver.step(q, [30.0, 0.0, 0.0], DT).q
    assert robot.tensions(robot.to_actuators(q)).max() == pytest.approx(10.0, rel=1e-6)
    free = sn.Solver(loose).step(q, [30.0, 0.0, 0.0], DT).q
    assert loose.tensions(loose.to_actuators(free)).max() > 11.0


def test_a_step_from_beyond_goes_no_farther_beyond() -> None:
    robot, q = arm(), np.array([[1.5, 0.0, 60.0], [1.5, 0.0, 60.0]])
    before = max(amount for _, _, amount in robot.violations(q))
    step = sn.Solver(robot).step(q, [40.0, 0.0, 0.0], DT)
    assert max((amount for _, _, amount in robot.violations(step.q)), default=0.0) <= before * (1.0 + 1e-12)


def test_a_solve_within_changes_keeps_limits_of_tension() -> None:
    for robot in (arm(), arm((40.0, 80.0))):
        q = np.array([[0.1, 0.0, 60.0], [0.0, 0.1, 60.0]])
        target = sn.Target(robot.tip(q + np.array([1.2, 0.0, 0.0]))[:3, 3])
        found = sn.Solver(robot).solve(target, q, within=Changes(bend=2.0, length=30.0))
        assert within(robot, found.q)


@pytest.mark.parametrize("length", [60.0, (40.0, 80.0)], ids=["lengths stay", "lengths vary"])
def test_steps_and_solves_within_changes_keep_rates_of_motors_with_their_stretch_all_the_way(length: Any) -> None:
    robot, random, used, looks = arm(length), np.random.default_rng(3), 0, np.linspace(0.0, 1.0, 201)[:, None, None]
    solver, rates, went_slack = sn.Solver(robot), sn.Rates(bend=1.0, length=9.0, actuator=[1.0, 2.0, 3.0] * 2), 0
    assert isinstance(rates.actuator, np.ndarray)
    for i in range(16):
        bends = random.normal(0.0, 0.2, (2, 2)) * (i > 3)
        q = np.column_stack([bends, [60.0, 60.0]])
        if robot.violations(q):
            continue
        ends = [solver.step(q, random.normal(0.0, 300.0, 3), DT, rates=rates).q]
        ends.append(solver.solve(sn.Target(robot.tip(ends[0])[:3, 3] * [2.0, 2.0, 1.0]), q, within=rates * DT).q)
        for end in ends:
            ways = (1.0 - looks) * q + looks * end
            values = robot.to_actuators(ways)
            share = np.abs(np.diff(values, axis=0)).max(axis=0) * 200.0 / (rates.actuator * DT)
            assert share.max() <= 1.0 + 1e-9
            used += int(share.max() > 0.9)
            slack = robot.drive.tensions(ways, values) < 1e-9
            went_slack += int((slack[1:] != slack[1]).any())
    assert used > 8, "rates of motors held hardly anything back"
    assert went_slack > 2
