"""Steps of a control loop: laws first, then what they are for."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import Bounds, NonlinearConstraint, lsq_linear, minimize

import sinuous as sn
from sinuous.answer.step import CONSTRAINTS, Active
from sinuous.kernels.velocity import layout
from sinuous.kernels.velocity.active_set import GAIN, LEAST_DAMPING
from sinuous.kernels.velocity.bounds import RATE_INSET
from sinuous.model.rates import Changes
from tests.helpers import Floats, present, with_each

N = 5
ROBOT = sn.Robot.uniform(N, (45, 70), max_bend=2.4, radius=4, tendons=sn.Tendons(3, radius=3))
UNIT = ROBOT.mean_length


@cache
def free_solver() -> sn.Solver:
    """Not made when tests are collected, since that compiles."""
    return sn.Solver(ROBOT)


ASKED, METRIC = np.array([1.0] * 3 + [1.0 / UNIT] * 3), np.array([1.0, 1.0, 57.5] * N)


def shape(rng: np.random.Generator, bend: float = 0.5) -> Floats:
    bends = np.clip(rng.normal(0.0, bend, (N, 2)), -1.5, 1.5)
    return np.column_stack([bends, rng.uniform(48.0, 67.0, N)])


def twist(rng: np.random.Generator) -> Floats:
    return np.asarray(rng.normal(0.0, 1.0, 6) / ASKED * 0.2)


def jacobian(q: Floats) -> Floats:
    return np.asarray(ASKED[:, None] * ROBOT.jacobian(q) * METRIC)


def cost(q: Floats, asked: Floats, motion: Floats) -> float:
    """What a step minimises, for a motion (n, 3)."""
    z = motion.ravel() / METRIC
    return float(((jacobian(q) @ z - ASKED * asked) ** 2).sum() + LEAST_DAMPING * z @ z)


@with_each("seed", range(20))
def test_a_small_free_step_is_least_squares_by_the_least_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, asked = shape(rng), twist(rng)
    expected = METRIC * (np.linalg.pinv(jacobian(q)) @ (ASKED * asked))
    step = free_solver().step(q, asked, 1e-4)
    np.testing.assert_allclose(step.velocity.ravel(), expected, atol=1e-4 * np.abs(expected).max())
    np.testing.assert_allclose(step.twist, asked, atol=1e-4 * np.abs(asked).max())
    assert step.status == "reached"


@with_each("seed", range(10))
def test_rates_of_lengths_are_those_of_least_squares_in_a_box(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, asked, dt = shape(rng), 3.0 * twist(rng), 0.01
    most = float(rng.uniform(5.0, 40.0))
    step = free_solver().step(q, asked, dt, rates=sn.Rates(length=most))
    system = np.vstack([jacobian(q), np.sqrt(LEAST_DAMPING) * np.eye(3 * N)])
    box = np.tile([1e3, 1e3, most * dt / 57.5], N)
    best = lsq_linear(system, np.append(ASKED * asked * dt, np.zeros(3 * N)), (-box, box), tol=1e-14)
    assert cost(q, asked * dt, step.q - q) <= 2.0 * best.cost * (1.0 + 1e-5) + 1e-15
    assert np.abs(step.velocity[:, 2]).max() <= most * (1.0 + 1e-12)


@pytest.mark.parametrize("limit", ["rate", "curvature"])
@pytest.mark.parametrize("seed", range(10))
def test_limits_of_bends_leave_the_best_of_what_they_allow(seed: int, limit: str) -> None:
    """Of rates, which are discs, and of curvature, which grow with the length, from shapes that are at it."""
    rng = np.random.default_rng(seed)
    q, asked, dt, most = shape(rng), 3.0 * twist(rng), 0.01, float(rng.uniform(0.2, 1.0))
    bends, curvature = np.hypot(q[:, 0], q[:, 1]), 0.012
    if limit == "rate":
        ik, rates = free_solver(), sn.Rates(bend=most)
    else:
        q[:, :2] *= (curvature * q[:, 2] / bends)[:, None]
        ik, rates = sn.Solver(sn.Robot.uniform(N, (45, 70), max_bend=2.4, max_curvature=curvature, radius=4)), None
    step = ik.step(q, asked, dt, rates=rates)
    hessian, pull = jacobian(q).T @ jacobian(q) + LEAST_DAMPING * np.eye(3 * N), jacobian(q).T @ (ASKED * asked * dt)

    def left(z: Floats) -> Floats:
        moved = z.reshape(N, 3)
        if limit == "rate":
            return np.asarray(((1.0 - RATE_INSET) * most * dt) ** 2 - (moved[:, :2] ** 2).sum(axis=1))
        bent = np.hypot(q[:, 0] + moved[:, 0], q[:, 1] + moved[:, 1])
        return np.asarray(curvature * (q[:, 2] + 57.5 * moved[:, 2]) - bent)

    least, longest = np.full((N, 3), -np.inf), np.full((N, 3), np.inf)
    least[:, 2], longest[:, 2] = (45.0 - q[:, 2]) / 57.5, (70.0 - q[:, 2]) / 57.5
    best: Any = minimize(  # type: ignore[call-overload]
        lambda z: float(z @ hessian @ z - 2.0 * pull @ z),
        np.zeros(3 * N),
        jac=lambda z: 2.0 * (hessian @ z - pull),
        bounds=Bounds(least.ravel(), longest.ravel()),
        constraints=[NonlinearConstraint(left, 0.0, np.inf)],
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-16},
    )
    offset = float(((ASKED * asked * dt) ** 2).sum())
    assert cost(q, asked * dt, step.q - q) <= (best.fun + offset) * 1.001 + (1e-9 if limit == "rate" else 1e-6) * offset
    assert limit != "rate" or np.hypot(*step.velocity[:, :2].T).max() <= most * (1.0 + 1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_limits_and_rates_are_never_exceeded(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = sn.Robot.uniform(4, (45, 70), max_bend=0.4, radius=4, tendons=sn.Tendons(3, radius=3, displacement=(-3, 3)))
    ik, rates, dt = sn.Solver(robot), sn.Rates(bend=1.0, length=20.0, actuator=4.0), 0.01
    q = np.column_stack([rng.normal(0.0, 0.1, (4, 2)), np.full(4, 55.0)])
    seen = set()
    for i in range(60):
        asked = twist(np.random.default_rng(100 * seed + i // 30)) * 3.0
        step = ik.step(q, asked, dt, rates=rates)
        driven = np.abs(robot.to_actuators(step.q) - robot.to_actuators(q)).max()
        assert robot.violations(step.q) == []
        assert np.hypot(*(step.q - q)[:, :2].T).max() <= 1.0 * dt * (1.0 + 1e-9)
        assert np.abs(step.q - q)[:, 2].max() <= 20.0 * dt * (1.0 + 1e-9)
        assert driven <= 4.0 * dt * (1.0 + 1e-9)
        seen |= {each.constraint for each in step.active}
        q = step.q
    assert {"bend_rate", "length_rate"} <= seen
    assert seen & {"bend", "length", "actuator", "curvature"}


@pytest.mark.parametrize(("outward", "held"), [(1.0, "actuator"), (-1.0, "actuator_rate")])
def test_an_actuator_is_held_by_its_limit_on_one_side_and_by_its_rate_on_the_other(outward: float, held: str) -> None:
    """From a shape in which one tendon of two is at its highest value, and the other at its lowest."""
    robot = sn.Robot([sn.Segment((50, 60), 2.0, tendons=sn.Tendons(2, 5.0, displacement=(-3, 3)))])
    q = np.array([[0.6, 0.0, 55.0]])
    asked = robot.jacobian(q) @ [5.0 * outward, 0.0, 0.0]
    step = sn.Solver(robot).step(q, asked, 0.01, rates=sn.Rates(bend=100.0, length=100.0, actuator=4.0))
    assert {(each.constraint, each.actuator) for each in step.active} == {(held, "s1.t1"), (held, "s1.t2")}


@with_each("seed", range(5))
def test_mirrored_questions_have_mirrored_answers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, asked, rates = shape(rng), 2.0 * twist(rng), sn.Rates(bend=0.5, length=10.0)
    balls = [sn.Sphere((30.0 * i - 60.0, 80.0, 40.0 * i), 20.0) for i in range(5)]
    mirrored = [sn.Sphere(ball.center * [1, -1, 1], 20.0) for ball in balls]
    robot = ROBOT.changed(segments=[sn.Segment((45, 70), 2.4, radius=4)] * N)
    one = sn.Solver(robot, balls, routes=False).step(q, asked, 0.01, rates=rates)
    other = sn.Solver(robot, mirrored, routes=False).step(
        q * [1, -1, 1], asked * [-1, 1, -1, 1, -1, 1], 0.01, rates=rates
    )
    np.testing.assert_allclose(other.q * [1, -1, 1], one.q, atol=1e-6)


@with_each("bend", [0.0, 1e-9, 1e-6, 1e-3, 0.098, 0.6])
def test_singular_shapes_move_little(bend: float) -> None:
    for seed in range(5):
        asked = twist(np.random.default_rng(seed))
        step = free_solver().step([[bend, 0.0, 55.0]] * N, asked, 0.001)
        assert np.isfinite(step.q).all()
        assert np.linalg.norm(step.velocity.ravel() / METRIC) <= 1.01 * GAIN * np.linalg.norm(ASKED * asked)
        wanted, reached = ASKED * asked, ASKED * step.twist
        assert np.linalg.norm(reached - wanted) <= np.linalg.norm(wanted)


def test_a_wall_is_not_passed_and_is_slid_along() -> None:
    wall = sn.Box((0.0, 120.0, 200.0), (400.0, 40.0, 400.0), name="wall")
    ik, dt = sn.Solver(ROBOT, [wall], routes=False), 0.01
    q = np.tile([0.0, 0.05, 57.5], (N, 1))
    began = ROBOT.tip(q)[:3, 3]
    for _ in range(80):
        step = ik.step(q, (10.0, 120.0, 0.0), dt, rates=sn.Rates(bend=2.0))
        assert step.proved
        assert present(step.clearance) > 0.0
        q = step.q
    assert step.status == "held_back"
    assert "wall" in {each.obstacle for each in step.active}
    moved = ROBOT.tip(q)[:3, 3] - began
    assert moved[0] > 3.0
    assert sn.check(ROBOT, q, ik.scene).clearance > 0.0


def test_clearance_is_a_wish_that_comes_first() -> None:
    ball = sn.Sphere((0.0, 45.0, 150.0), 30.0)
    ik = sn.Solver(ROBOT, [ball], routes=False)
    step = ik.step(np.tile([0.0, 0.0, 57.5], (N, 1)), np.zeros(6), 0.01, rates=sn.Rates(bend=1.0), clearance=15.0)
    for _ in range(100):
        step = ik.step(step, np.zeros(6), 0.01, rates=sn.Rates(bend=1.0), clearance=15.0)
    assert step.clearance == pytest.approx(15.0, rel=0.11)


def test_a_start_in_contact_is_left_and_said_plainly() -> None:
    ball = sn.Sphere((0.0, 30.0, 150.0), 28.0, name="ball")
    ik, q = sn.Solver(ROBOT, [ball], routes=False), np.tile([0.0, 0.0, 57.5], (N, 1))
    step = ik.step(q, (0.0, 0.0, 0.0), 0.01, rates=sn.Rates(bend=1.0))
    assert (step.status, step.touching, step.proved) == ("touching", True, False)
    assert step.active[0] == Active("clearance", 3, obstacle="ball")
    gaps = []
    for _ in range(30):
        gaps.append(float(sn.check(ROBOT, step.q, ik.scene).clearance))
        step = ik.step(step, (0.0, 0.0, 0.0), 0.01, rates=sn.Rates(bend=1.0))
    assert (np.diff(gaps) >= -1e-9).all()
    assert step.proved
    assert step.clearance is not None


def test_no_place_moves_much_farther_than_is_asked_beside_what_is_touched() -> None:
    robot, random = ROBOT.changed(self_collision="allow"), np.random.default_rng(3)
    asked, begun = 0.2, 0
    for _ in range(200):
        q = random.normal(0.0, 0.6, (N, 3))
        q[:, 2] = random.uniform(46.0, 69.0, N)
        points = robot.backbone(q)
        away = random.normal(0.0, 1.0, 3)
        place = points[random.integers(2 * len(points) // 3, len(points))]
        ball = sn.Sphere(place + 14.0 * away / np.linalg.norm(away), 10.0)
        deep = -sn.check(robot, q, [ball]).clearance
        if robot.violations(q) or deep > 0.1:
            continue
        begun += 1
        solver, velocity = sn.Solver(robot, [ball]), random.normal(0.0, 1.0, 3)
        velocity *= asked / np.linalg.norm(velocity)
        for step in (solver.step(q, velocity, 1.0), solver.step(q, target=robot.tip(q)[:3, 3] + velocity, dt=1.0)):
            moved = np.linalg.norm(robot.backbone(step.q) - points, axis=1).max()
            assert moved <= 100.0 * (asked + max(0.0, deep) + 0.01)
            assert not step.touching or moved <= 10.0 * (asked + max(0.0, deep) + 0.01)
        rates = sn.Rates(bend=10.0, length=1000.0)
        fast = solver.step(q, velocity, 1.0, rates=rates)
        assert np.abs(fast.q - q).max() <= 1000.0
    assert begun > 10


def test_the_body_does_not_run_into_itself() -> None:
    robot = sn.Robot.uniform(4, 60.0, max_bend=2.6, radius=6)
    ik, q = sn.Solver(robot), np.array([[1.2, 0.0, 60.0], [1.3, 0.0, 60.0], [1.2, 0.05, 60.0], [1.1, 0.0, 60.0]])
    touched = False
    for _ in range(150):
        step = ik.step(q, robot.jacobian(q) @ np.tile([2.0, 0.0, 0.0], 4), 0.01, rates=sn.Rates(bend=1.0))
        assert step.proved
        touched = touched or any(each.constraint == "self_clearance" for each in step.active)
        q = step.q
    assert touched
    checked = sn.check(robot, q)
    assert present(checked.self_clearance) > 0.0


def test_steps_towards_a_target_end_there() -> None:
    q = shape(np.random.default_rng(5))
    target = sn.Target((60.0, 0.0, 240.0), direction=(0.2, 0.0, 1.0))
    for _ in range(400):
        step = free_solver().step(q, target=target, dt=0.01, rates=sn.Rates(bend=1.0, length=30.0))
        q = step.q
        if step.status == "reached":
            break
    assert step.status == "reached"
    assert present(step.position_error) <= 1e-4 * UNIT
    np.testing.assert_allclose(ROBOT.tip(q)[:3, 3], (60.0, 0.0, 240.0), atol=1e-4 * UNIT)
    assert step.share is None


@pytest.mark.parametrize("plane", [None, 0.5])
def test_accelerations_are_kept(plane: float | None) -> None:
    rates, dt = sn.Rates(bend=1.0, length=30.0, acceleration=sn.Rates(bend=5.0, length=100.0)), 0.01
    robot = ROBOT if plane is None else sn.Robot([sn.Segment((45, 70), 2.4, plane=plane + k) for k in range(N)])
    q, velocity = robot.drive.coordinates.project(shape(np.random.default_rng(2))), np.zeros((N, 3))
    solver = free_solver() if plane is None else sn.Solver(robot)
    for i in range(60):
        step = solver.step(q, (0.0, 60.0 if i < 30 else -60.0, 0.0), dt, rates=rates, velocity=velocity)
        change = step.velocity - velocity
        assert np.hypot(*change[:, :2].T).max() <= 5.0 * dt * 1.01
        assert np.abs(change[:, 2]).max() <= 100.0 * dt * 1.01
        q, velocity = step.q, step.velocity


def test_a_limit_of_an_actuator_comes_before_its_acceleration_and_holds_back_no_other() -> None:
    actuators = sn.Actuators(np.eye(6)[[0, 1, 3, 4]], limits=[(-0.5, 0.5), None, None, None])
    robot = sn.Robot([sn.Segment(50.0, 2.0)] * 2, actuators=actuators)
    q, velocity = np.array([[0.48, 0.0, 50.0], [0.0, 0.0, 50.0]]), np.array([[10.0, 0.0, 0.0]] * 2)
    rates = sn.Rates(actuator=20.0, acceleration=sn.Rates(actuator=1.0))
    step = sn.Solver(robot).step(q, robot.jacobian(q) @ velocity.ravel(), 0.01, rates=rates, velocity=velocity)
    assert step.q[0, 0] == pytest.approx(0.5, abs=1e-6)
    assert step.q[1, 0] > 0.09


@with_each(
    ("given", "words"),
    [
        ({"dt": 0.01}, "twist: missing; expected one of twist, target"),
        ({"twist": (0,) * 6}, "dt: missing; expected a number greater than 0"),
        ({"twist": (0,) * 6, "dt": 0.0}, "dt: expected a number greater than 0"),
        ({"twist": (0,) * 4, "dt": 0.01}, "twist: expected 6 finite numbers (omega, v), or 3 (v)"),
        ({"twist": (0, 0, float("nan")), "dt": 0.01}, "twist: expected 6 finite numbers"),
        ({"twist": (0,) * 3, "target": sn.Target((0, 0, 1)), "dt": 0.01}, "cannot be combined with target; "),
        ({"twist": (0,) * 3, "dt": 0.01, "rates": 1.0}, "rates: expected Rates"),
        ({"twist": (0,) * 3, "dt": 0.01, "clearance": -1.0}, "clearance: expected a number of at least 0"),
        ({"twist": (0,) * 3, "dt": 0.01, "rates": sn.Rates(bend=(1, 2))}, "bend: expected one number, or 5"),
        (
            {"twist": (0,) * 3, "dt": 0.01, "rates": sn.Rates(acceleration=sn.Rates(1))},
            "velocity: missing; expected that of",
        ),
        ({"twist": (0,) * 3, "dt": 0.01, "q": [[0, 0, 1]]}, "q: shape (1, 3); expected 5 rows of 3"),
    ],
)
def test_bad_input_is_refused_in_a_line(given: dict[str, Any], words: str) -> None:
    with pytest.raises(sn.InputError) as caught:
        free_solver().step(**({"q": np.tile([0.0, 0.0, 57.5], (N, 1))} | given))
    assert words in str(caught.value)


def reach_within(changes: Changes, solver: sn.Solver, target: sn.Target, q: Floats, most: int) -> list[Floats]:
    """Demand that solves within changes come nearer each time, and to the target in the end; return the way there."""
    way, ends = [q], list[float]()
    for _ in range(most):
        found = solver.solve(target, initial=way[-1], within=changes)
        ends.append(present(found.position_error))
        way.append(found.q)
        if found.solved:
            break
        assert found.status is sn.Status.RATE_BOUND
    assert (np.diff(ends) < 0.0).all()
    assert found.solved
    assert found.verify().ok
    return way


@pytest.mark.parametrize("seed", range(5))
def test_what_is_reached_within_changes_never_jumps(seed: int) -> None:
    q, target = shape(np.random.default_rng(seed), 0.3), sn.Target((40.0, 30.0, 240.0))
    way = reach_within(sn.Rates(bend=1.0, length=30.0) * 0.02, free_solver(), target, q, 80)
    change = np.abs(np.diff(way, axis=0))
    assert np.hypot(change[..., 0], change[..., 1]).max() <= 0.02 * (1.0 + 1e-9)
    assert change[..., 2].max() <= 0.6 * (1.0 + 1e-9)


def test_words_of_constraints_are_those_of_the_kernels() -> None:
    assert [getattr(layout, f"{word.upper()}_LIMIT") for word in CONSTRAINTS] == list(range(len(CONSTRAINTS)))
