"""Ticks of a control loop under load: the loaded tip moves as asked, within limits and rates, and is proved clear."""

from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.statics import imbalance
from sinuous.model.rates import Changes
from sinuous.solver import loaded_control_step
from sinuous.statics.rest import Rest, Way
from tests.helpers import present, refused, states_of
from tests.solver.test_control_step import reach_within
from tests.solver.test_loaded_solve import Q, arm
from tests.solver.test_loaded_solve import pulled as strong

DT = 0.02

PATIENCE = 120.0
"""Seconds of a step: a busy machine that still compiles kernels must not change what is proved."""


GOAL = Q + np.array([[0.3, -0.2, 0.0], [0.2, 0.2, 0.005], [-0.3, 0.2, 0.0]])


def test_the_loaded_tip_moves_as_asked() -> None:
    robot = arm()
    solver, before = sn.Solver(robot, time=PATIENCE), robot.shape(Q).tip[:3, 3]
    velocity = np.array([0.05, -0.02, 0.03])
    step = solver.step(Q, velocity, DT)
    assert step.status == "reached"
    assert step.proved
    moved = robot.shape(step.q).tip[:3, 3] - before
    assert moved == pytest.approx(DT * velocity, abs=2e-5)
    assert step.twist[3:] == pytest.approx(velocity, rel=1e-3, abs=1e-5)
    free = robot.changed(gravity=None, payload=None)
    assert np.abs(robot.tip(step.q)[:3, 3] - robot.tip(Q)[:3, 3] - DT * velocity).max() > 1e-4, "as without load"
    assert sn.Solver(free, time=PATIENCE).step(Q, velocity, DT).q.tolist() != step.q.tolist()
    turned = solver.step(Q, [0.1, 0.0, 0.0, 0.0, 0.02, 0.0], DT)
    assert turned.twist == pytest.approx([0.1, 0.0, 0.0, 0.0, 0.02, 0.0], abs=1e-4)


def test_ticks_come_to_a_target_within_rates_and_limits() -> None:
    robot = arm()
    target = sn.Target(robot.shape(GOAL).tip[:3, 3])
    rates, solver, q = sn.Rates(bend=2.0, length=0.05), sn.Solver(robot, time=PATIENCE), Q
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
    solver = sn.Solver(robot, time=PATIENCE)
    for _ in range(6):
        step = solver.step(q, robot.shape(q).tip[:3, 0] * 0.3, 0.1)
        assert robot.excess(step.q) == 0.0
        q = step.q
    assert {each.constraint for each in step.active} <= {"bend", "length"}


def test_rounding_leaves_no_limit_at_the_end_of_a_step() -> None:
    """A step that is not shortened until its limits hold ends 4e-16 beyond one."""
    robot = arm(payload=sn.Payload(0.01759554980476594))
    q = [
        [1.2239801520282734, -1.5817308833808632, 0.0726268962444168],
        [0.4934964539485659, 1.6194574380584994, 0.0862304225239036],
        [-1.2065464405106376, 0.47778043208242926, 0.08279576731212283],
    ]
    rates = sn.Rates(bend=0.9734911835188162, length=0.05253792488838626)
    twist = [-0.023510718098415612, 0.0032015178506868153, -0.042756487161811546]
    step = sn.Solver(robot, time=PATIENCE).step(q, twist, 0.05, rates=rates)
    assert robot.excess(step.q) == 0.0


def test_the_loaded_body_stays_clear_and_slides_along() -> None:
    robot = arm()
    shape = robot.shape(Q)
    ball = sn.Sphere(shape.tip[:3, 3] + np.array([0.03, 0.0, 0.0]), 0.015)
    solver, q = sn.Solver(robot, [ball], time=PATIENCE), Q
    held = set[str]()
    for _ in range(12):
        step = solver.step(q, [0.1, 0.1, 0.0], DT)
        assert step.proved
        assert present(step.clearance) <= sn.check(robot, step.q, [ball]).clearance + 1e-12
        held, q = held | {each.constraint for each in step.active}, step.q
    assert held == {"clearance"}
    assert robot.shape(q).tip[1, 3] - shape.tip[1, 3] > 0.01, "it stuck"


def test_out_of_a_contact_it_goes_unproved_and_never_deeper() -> None:
    robot = arm()
    ball = sn.Sphere(robot.shape(Q).tip[:3, 3] + np.array([0.012, 0.0, 0.0]), 0.01)
    solver, depth = sn.Solver(robot, [ball], time=PATIENCE), sn.check(robot, Q, [ball]).clearance
    assert depth < 0.0
    for asked in ([0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]):
        step = solver.step(Q, asked, DT)
        assert (step.status, step.proved) == ("touching", False)
        assert sn.check(robot, step.q, [ball]).clearance > depth
    onward = solver.step(step.q, [-0.1, 0.0, 0.0], DT)
    assert onward.proved
    assert present(onward.clearance) > 0.0


def test_what_was_measured_corrects_the_loaded_model() -> None:
    robot, real = arm(), arm(mass=0.06)
    place = robot.shape(Q + 0.1 * np.array([1.0, 1.0, 0.0])).tip[:3, 3]
    target = sn.Target(place)
    solver = sn.Solver(robot, time=PATIENCE)
    step = solver.step(Q, target=target, dt=DT, measured=real.shape(Q).tip)
    for _ in range(12):
        step = solver.step(step, target=target, dt=DT, measured=real.shape(step.q).tip, gain=0.6)
    off = np.linalg.norm(real.shape(step.q).tip[:3, 3] - place)
    alone = np.linalg.norm(real.shape(sn.solve(robot, target, initial=Q).q).tip[:3, 3] - place)
    assert off < 1e-3 * robot.mean_length < alone


def test_what_is_reached_within_changes_comes_to_the_target() -> None:
    robot = arm()
    target, solver = sn.Target(robot.shape(GOAL).tip[:3, 3]), sn.Solver(robot, time=PATIENCE)
    way = reach_within(sn.Rates(bend=2.0, length=0.05) * 0.04, solver, target, Q, 10)
    change = np.abs(np.diff(way, axis=0))
    assert np.hypot(change[..., 0], change[..., 1]).max() <= 0.08
    assert change[..., 2].max() <= 0.002
    assert sn.Motion(robot, way).solved
    assert len(way) > 3


def test_changes_among_obstacles_end_where_the_way_is_proved() -> None:
    robot = arm()
    end = robot.shape(GOAL).tip[:3, 3]
    ball = sn.Sphere(0.5 * (robot.shape(Q).tip[:3, 3] + end), 0.02)
    found = sn.Solver(robot, [ball], time=PATIENCE).solve(sn.Target(end), initial=Q, within=Changes(bend=1.0))
    assert not found.solved
    assert sn.Motion(robot, [Q, found.q], [ball]).solved


def test_changes_from_a_drive_that_cannot_hold_its_load() -> None:
    with pytest.warns(sn.SuspiciousInput, match="hangs like a thread"):
        solver, target = sn.Solver(arm(payload=sn.Payload(1e8)), time=PATIENCE), sn.Target((0.0, 0.0, 0.2))
    found = solver.solve(target, initial=Q, within=Changes(bend=0.5))
    assert not found.solved
    assert found.status is sn.Status.STALLED
    assert "no stable equilibrium" in str(found)
    refused("initial", lambda: solver.solve(target, within=Changes(0.5)))
    refused("within", lambda: solver.solve(target, initial=Q, within=0.1))  # type: ignore[arg-type]


@pytest.mark.filterwarnings("ignore:.*is not bent at all")
@pytest.mark.parametrize("stretches", [None, 1e9])
@pytest.mark.parametrize("among", [False, True])
def test_a_step_without_a_load_is_that_of_the_robot_alone(stretches: float | None, among: bool) -> None:
    """Law: what gives way to nothing, or has nothing to give way to, moves as a rigid body does."""
    stiff = sn.Stiffness(bend=1e7, twist=1e7, stretch=stretches)
    loaded = arm(stiffness=stiff, payload=None, arcs=1)  # contacts are looked for in every arc
    free, twist = loaded.changed(gravity=None, payload=None), np.array([0.1, 0.05, -0.1, 0.03, 0.02, -0.04])
    ball = [sn.Sphere(free.tip(Q)[:3, 3] + np.array([0.012, 0.0, 0.012]), 0.01)] if among else []
    rates = sn.Rates(bend=2.0, length=0.05, acceleration=sn.Rates(bend=200.0))
    target = sn.Target(free.tip(Q + 0.05)[:3, 3])
    still = np.zeros_like(Q)
    for given in ({"twist": twist}, {"twist": twist[:3], "rates": rates, "velocity": still}, {"target": target}):
        steps = [sn.Solver(each, ball, time=PATIENCE).step(Q, dt=DT, **given) for each in (loaded, free)]
        assert steps[0].q == pytest.approx(steps[1].q, abs=1e-6)
        assert steps[0].proved == steps[1].proved
        assert [each.constraint for each in steps[0].active] == [each.constraint for each in steps[1].active]


pulled = partial(strong, arcs=3, payload=sn.Payload(0.01))


@pytest.mark.parametrize("seed", range(6))
def test_tensions_under_load_are_kept_at_the_end_and_between(seed: int) -> None:
    """Tensions of the limit's own judge, at places between both ends; steps at the limit are not stuck."""
    random, most = np.random.default_rng(seed), 0.0
    lax, q = pulled(1e3), np.column_stack([random.uniform(-0.4, 0.4, (3, 2)), np.full(3, 0.1)])
    most = float(np.nanmax(Rest(lax, q).pulls)) * random.uniform(1.01, 1.3)
    robot, held, moved = pulled(most), set[str](), 0.0
    solver = sn.Solver(robot, time=PATIENCE)
    for twist in random.normal(0.0, 0.2, (4, 3)).repeat(4, axis=0):
        step = solver.step(q, twist, DT)
        assert step.proved
        way = Way(Rest(robot, q), Rest(robot, step.q))
        rests = [way.rest(share) for share in np.linspace(0.0, 1.0, 7).tolist()]
        assert imbalance(robot, *states_of(rests)) < 1e-7
        assert np.nanmax([rest.pulls for rest in rests]) <= most * (1.0 + 1e-6)
        held |= {each.actuator or "" for each in step.active if each.constraint == "actuator"}
        moved += float(np.abs(step.q - q).max())
        q = step.q
    assert held, "no limit was met"
    assert moved > 0.02, "it stuck"


def test_what_is_reached_within_changes_keeps_tensions() -> None:
    lax, q = pulled(1e3), np.array([[0.3, 0.1, 0.1], [-0.2, 0.3, 0.1], [0.1, 0.2, 0.1]])
    most = 1.02 * float(np.nanmax(Rest(lax, q).pulls))
    robot, target = pulled(most), sn.Target(lax.shape(q * [2.5, 2.5, 1.0]).tip[:3, 3])
    found = sn.Solver(robot, time=PATIENCE).solve(target, initial=q, within=Changes(bend=0.4))
    free = sn.Solver(lax, time=PATIENCE).solve(target, initial=q, within=Changes(bend=0.4))
    assert float(np.nanmax(Rest(lax, free.q).pulls)) > most, "no limit is in the way"
    way = Way(Rest(robot, q), Rest(robot, found.q))
    assert max(float(np.nanmax(way.rest(share).pulls)) for share in (0.25, 0.5, 0.75, 1.0)) <= most * (1.0 + 1e-6)
    assert np.abs(found.q - q).max() > 0.01
    assert sn.Motion(robot, [q, found.q]).solved


@pytest.mark.parametrize("seconds", [1e-9, 1e-4, PATIENCE])
@pytest.mark.parametrize("asked", [{"twist": [0.05, -0.02, 0.03]}, {"target": sn.Target(direction=(0, 0, 1))}])
def test_a_step_reads_nothing_of_its_workspace_that_it_did_not_write(asked: dict[str, Any], seconds: float) -> None:
    """One whose time was over before its first derivatives took the motion of the tip from what was left there."""
    ball = sn.Sphere(arm().shape(Q).tip[:3, 3] + np.array([0.03, 0.0, 0.0]), 0.015)
    numbers, found = 1_000_000, []
    for left in (0.0, np.nan, 1e300):
        loaded_control_step._SCRATCH.space = np.full(numbers, left)
        step = sn.Solver(strong(20.0), [ball], time=seconds).step(Q, dt=DT, **asked)
        assert len(loaded_control_step._SCRATCH.space) == numbers, "another workspace was used"
        found.append((step.status, step.proved, step.q.tolist(), step.twist.tolist(), step.clearance))
    assert found[0] == found[1] == found[2]
