"""Ticks of a control loop under load: the loaded tip moves as asked, within limits and rates, and is proved clear."""

import numpy as np
import pytest

import sinuous as sn
from tests.solving.test_under_load import Q, arm

DT = 0.02


def test_the_loaded_tip_moves_as_asked() -> None:
    robot = arm()
    solver, before = sn.Solver(robot), robot.shape(Q).tip[:3, 3]
    velocity = np.array([0.05, -0.02, 0.03])
    step = solver.step(Q, velocity, DT)
    assert step.status == "reached"
    assert step.proved
    moved = robot.shape(step.q).tip[:3, 3] - before
    assert moved == pytest.approx(DT * velocity, abs=2e-5)
    assert step.twist[3:] == pytest.approx(velocity, rel=1e-3, abs=1e-5)
    free = robot.changed(gravity=None, payload=None)
    assert np.abs(robot.tip(step.q)[:3, 3] - robot.tip(Q)[:3, 3] - DT * velocity).max() > 1e-4, "as without load"
    assert sn.Solver(free).step(Q, velocity, DT).q.tolist() != step.q.tolist()
    turned = solver.step(Q, [0.1, 0.0, 0.0, 0.0, 0.02, 0.0], DT)
    assert turned.twist == pytest.approx([0.1, 0.0, 0.0, 0.0, 0.02, 0.0], abs=1e-4)


def test_ticks_come_to_a_target_within_rates_and_limits() -> None:
    robot = arm()
    goal = Q + np.array([[0.3, -0.2, 0.0], [0.2, 0.2, 0.005], [-0.3, 0.2, 0.0]])
    target = sn.Target(robot.shape(goal).tip[:3, 3])
    rates, solver, q = sn.Rates(bend=2.0, length=0.05), sn.Solver(robot), Q
    for _ in range(40):
        step = solver.step(q, target=target, dt=DT, rates=rates)
        change = np.abs(step.q - step.initial)
        assert np.hypot(change[:, 0], change[:, 1]).max() <= 2.0 * DT
        assert change[:, 2].max() <= 0.05 * DT
        assert robot.excess(step.q) == 0.0
        q = step.q
    assert step.status == "reached"
    assert sn.check(robot, q, None, target).ok


def test_limits_of_bends_and_lengths_hold_to_the_last_digit() -> None:
    robot = arm()
    q = Q.copy()
    q[:, :2] *= (1.99 / np.hypot(q[:, 0], q[:, 1]))[:, None]
    q[1, 2] = 0.13
    solver = sn.Solver(robot)
    for _ in range(6):
        step = solver.step(q, robot.shape(q).tip[:3, 0] * 0.3, 0.1)
        assert robot.excess(step.q) == 0.0
        q = step.q
    assert {each.constraint for each in step.active} <= {"bend", "length"}


def test_the_loaded_body_stays_clear_and_slides_along() -> None:
    robot = arm()
    shape = robot.shape(Q)
    ball = sn.Sphere(shape.tip[:3, 3] + np.array([0.03, 0.0, 0.0]), 0.015)
    solver, q = sn.Solver(robot, [ball]), Q
    held = set[str]()
    for _ in range(12):
        step = solver.step(q, [0.1, 0.1, 0.0], DT)
        assert step.proved
        assert step.clearance is not None
        assert step.clearance <= sn.check(robot, step.q, [ball]).clearance + 1e-12
        held, q = held | {each.constraint for each in step.active}, step.q
    assert held == {"clearance"}
    assert robot.shape(q).tip[1, 3] - shape.tip[1, 3] > 0.01, "it stuck"


def test_what_was_measured_corrects_the_loaded_model() -> None:
    robot, real = arm(), arm(mass=0.06)
    place = robot.shape(Q + 0.1 * np.array([1.0, 1.0, 0.0])).tip[:3, 3]
    target = sn.Target(place)
    solver = sn.Solver(robot)
    step = solver.step(Q, target=target, dt=DT, measured=real.shape(Q).tip)
    for _ in range(12):
        step = solver.step(step, target=target, dt=DT, measured=real.shape(step.q).tip, gain=0.6)
    off = np.linalg.norm(real.shape(step.q).tip[:3, 3] - place)
    alone = np.linalg.norm(real.shape(sn.solve(robot, target, initial=Q).q).tip[:3, 3] - place)
    assert off < 1e-3 * robot.mean_length < alone
