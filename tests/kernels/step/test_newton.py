"""The step against a dense least squares problem, and the laws of a descent."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.clock import SEGMENT_WORK, STRIDE
from sinuous.kernels.fields import solids
from sinuous.kernels.problem import Problem
from sinuous.kernels.step import newton
from sinuous.kernels.step.newton import MISSED
from sinuous.kernels.step.states import ANGLE, MERIT, POSITION, pick
from tests.helpers import Floats, kernel_problem, random_pose
from tests.kernels.workspace import NEVER, make_workspace, put

WIDE = sn.Robot(
    [sn.Segment((0.5, 1.5), 6.0), sn.Segment(1.0, 6.0), sn.Segment((0.2, 0.8), 6.0), sn.Segment((0.9, 1.1), 6.0)],
    base=random_pose(np.random.default_rng(1)),
    tool=random_pose(np.random.default_rng(2), 0.1),
)
TIGHT = sn.Robot(
    [
        sn.Segment((0.5, 1.5), 1.0, max_curvature=0.9, tendons=sn.Tendons(3, 0.05, displacement=(-0.03, 0.04))),
        sn.Segment(1.0, 0.7),
        sn.Segment((0.2, 0.8), 2.0),
    ]
)


def shape(robot: sn.Robot, seed: int, share: float = 0.4) -> Floats:
    """Return a configuration well within the limits."""
    rng = np.random.default_rng(seed)
    low, high, bend = robot.limits[:, :3].T
    angle, size = rng.uniform(-math.pi, math.pi, len(robot)), share * bend * rng.random(len(robot))
    length = low + (high - low) * rng.uniform(0.3, 0.7, len(robot))
    return np.stack([size * np.cos(angle), size * np.sin(angle), length], axis=-1)


def targets_at(robot: sn.Robot, q: Floats, seed: int) -> list[sn.Target]:
    """Targets that a configuration meets: pose or direction of the tip, and place or direction of a segment before."""
    tip, inner = robot.tip(q), robot.forward(q)[1]
    whole, elbow = sn.Target(tip[:3, 3], rotation=tip[:3, :3]), sn.Target(inner[:3, 3], segment=2)
    pointing = [sn.Target(tip[:3, 3], direction=tip[:3, 2]), sn.Target(direction=inner[:3, 2], segment=2)]
    return [[whole, elbow], [whole], pointing][seed % 3]


def dense(robot: sn.Robot, targets: list[sn.Target], q: Floats) -> tuple[Floats, Floats]:
    """Jacobian and what is missing, places before turns, in the units of a step: lengths relative to the robot's."""
    unit = robot.mean_length
    places, turns = list[tuple[Floats, Floats]](), list[tuple[Floats, Floats]]()
    for target in targets:
        jacobian = robot.jacobian(q, target.segment)
        end = robot.tip(q) if target.segment is None else robot.forward(q)[target.segment - 1]
        tangent = end[:3, 2]
        if target.position is not None:
            places.append((jacobian[3:] / unit, (target.position - end[:3, 3]) / unit))
        if target.rotation is not None:
            turns.append((jacobian[:3], Rotation.from_matrix(target.rotation @ end[:3, :3].T).as_rotvec()))
        elif target.direction is not None:
            turn = Rotation.align_vectors(target.direction, tangent)[0]  # the shortest
            turns.append(((np.eye(3) - np.outer(tangent, tangent)) @ jacobian[:3], turn.as_rotvec()))
    matrices, missing = zip(*places, *turns, strict=True)
    return np.concatenate(matrices), np.concatenate(missing)


def linearised(problem: Problem, q: Floats) -> tuple[Any, Any]:
    states, work = make_workspace(problem)
    state = put(states, 0, q)
    newton.linearise(problem, state, work, 3, solids.EXACT, 0.0, False)
    return state, work


@pytest.mark.parametrize(("far", "mu"), [(1e-3, 1e-6), (1e-3, 1e-2), (1e-3, 10.0), (0.3, 1e3)])
@pytest.mark.parametrize("seed", range(6))
def test_the_step_is_the_dense_damped_gauss_newton_step(seed: int, far: float, mu: float) -> None:
    """Among limits that it does not reach: a small way from where the targets are met, or held back by damping."""
    goal = shape(WIDE, seed)
    rng = np.random.default_rng(seed)
    q = goal + far * rng.normal(size=goal.shape) * [1, 1, 0]
    targets = targets_at(WIDE, goal, seed)
    state, work = linearised(kernel_problem(WIDE, targets), q)
    bound = newton.step(kernel_problem(WIDE, targets), state, work, mu)
    jacobian, missing = dense(WIDE, targets, q)
    scale = WIDE.limits[:, [5, 5, 6]].ravel()
    system = np.concatenate([jacobian * scale / math.sqrt(mu), np.eye(len(scale))])
    z = np.linalg.lstsq(system, np.concatenate([missing / math.sqrt(mu), np.zeros(len(scale))]))[0]
    assert not bound
    np.testing.assert_allclose(work.step.ravel(), scale * z, atol=1e-9 / max(1.0, mu))
    # A segment that cannot stretch does not.
    np.testing.assert_array_equal(work.step[1, 2], 0.0)
    sizes, places = np.linalg.norm(missing.reshape(-1, 3), axis=1), sum(each.position is not None for each in targets)
    assert state.norms[POSITION] == pytest.approx(WIDE.mean_length * sizes[:places].max())
    assert state.norms[ANGLE] == pytest.approx(sizes[places:].max())


@given(st.integers(0, 10**6), st.sampled_from([1e-10, 1e-3, 1.0]))
def test_a_step_keeps_the_limits(seed: int, mu: float) -> None:
    far = random_pose(np.random.default_rng(seed), 2.0)
    problem = kernel_problem(TIGHT, sn.Target(far[:3, 3], rotation=far[:3, :3]))
    states, work = make_workspace(problem)
    put(states, 0, shape(TIGHT, seed, 3.0))
    newton.project_to_limits(problem, pick(states, 0), work)
    assert TIGHT.excess(states.q[0]) <= 1e-12
    newton.linearise(problem, pick(states, 0), work, 3, solids.EXACT, 0.0, False)
    newton.step(problem, pick(states, 0), work, mu)
    newton.move(problem, pick(states, 0), work, pick(states, 1))
    assert TIGHT.excess(states.q[1]) <= 1e-11


def descended(problem: Problem, q: Floats, most: int = 60, deadline: int = NEVER) -> tuple[Floats, Any, int, int]:
    """Configuration, its norms, verdict and iterations of a descent."""
    states, work = make_workspace(problem, deadline)
    put(states, 0, q)
    at, verdict, used, _, _, _ = newton.descend(problem, states, 0, work, most, 0.0, False)
    return states.q[at].copy(), states.norms[at].copy(), verdict, used


@settings(max_examples=10)
@given(st.integers(0, 10**6), st.sampled_from([WIDE, TIGHT]))
def test_the_merit_never_grows(seed: int, robot: sn.Robot) -> None:
    """A descent that may take one step more is the same one, and its best is no worse."""
    targets = targets_at(robot, shape(robot, seed + 1), seed)
    problem = kernel_problem(robot, targets)
    q, last = shape(robot, seed), math.inf
    for most in range(12):
        found, norms, verdict, used = descended(problem, q, most)
        assert used <= most
        assert norms[MERIT] <= last
        assert robot.excess(found) <= 1e-11
        last = norms[MERIT]
        _, missing = dense(robot, targets, found)
        assert norms[MERIT] == pytest.approx(missing @ missing, rel=1e-9, abs=1e-15)
        assert (verdict == CLEAR) == (
            norms[POSITION] <= problem.position_tolerance and norms[ANGLE] <= problem.angle_tolerance
        )


@pytest.mark.parametrize("seed", range(6))
def test_close_to_a_solution_it_converges_like_newton(seed: int) -> None:
    q = shape(WIDE, seed)
    rng = np.random.default_rng(seed)
    near = q + 0.02 * rng.normal(size=q.shape) * [1, 1, 0]
    targets = targets_at(WIDE, q, seed)
    _, _, verdict, used = descended(kernel_problem(WIDE, targets, tolerance=sn.Tolerance(1e-9, 1e-9)), near)
    assert verdict == CLEAR
    assert used <= 5


def test_a_deadline_ends_a_descent_when_the_time_is_read() -> None:
    problem = kernel_problem(WIDE, sn.Target((0.0, 0.0, 99.0), direction=(1, 0, 0)))
    q = shape(WIDE, 3)
    *_, free = descended(problem, q)
    *_, verdict, used = descended(problem, q, 60, 0)
    assert verdict == MISSED
    assert used * len(WIDE) * SEGMENT_WORK <= STRIDE
    assert used <= free


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_a_start_without_numbers_is_no_solution(number: float) -> None:
    """Comparisons with NaN are false, also those that should find something wrong: it was called met, and clear."""
    problem = kernel_problem(WIDE, targets_at(WIDE, shape(WIDE, 5), 5))
    for place in (0, 4, slice(None)):
        q = shape(WIDE, 3)
        q.reshape(-1)[place] = number
        states, work = make_workspace(problem)
        put(states, 0, q)
        at, verdict, _, _, _, _ = newton.descend(problem, states, 0, work, 0, 0.0, False)
        assert verdict == MISSED
        assert np.isfinite(states.q[at]).all()
        assert not WIDE.violations(states.q[at])
