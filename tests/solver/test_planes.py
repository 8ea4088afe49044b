"""Solves, motions and control steps of robots with bends in one plane, locked coordinates and values that are held."""

import math
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels import tables as t
from sinuous.solver.routing.chains import find_terminal_poses
from sinuous.solver.routing.partial_chains import FLIP, problem_from_pose, reverse_chain, reverse_problem, segments_in
from sinuous.solver.routing.searches import Searches
from tests.helpers import refused

LOOSE: dict[str, Any] = {"routes": False, "max_starts": 12}
ROBOT = sn.Robot(
    [sn.Segment((0.5, 1.0), 2.0, plane=0.7), sn.Segment(1.0, (-0.5, 1.5), plane=1.7), sn.Segment(1.0, 2.0)]
)
LOCKED = ROBOT.locked({3: (0.4, -0.2, None)})
ROWS = np.vstack([[[1, 0, 0] * 3], np.eye(9)[[0, 1, 3, 4, 6, 7]]])
SUM = sn.Robot.uniform(3, 1.0, 2.0, actuators=sn.Actuators(ROWS, limits=[(0, 0), *[None] * 6]))
WIRES = sn.Tendons(2, 2.0, displacement=(-6, 6))
SCOPE = sn.Robot([sn.Segment((0.0, 150.0), 0.0, stage=sn.Stage()), sn.Segment(50.0, 3.1415, tendons=WIRES)])


@pytest.mark.parametrize("robot", [ROBOT, LOCKED, SUM])
def test_solves_stay_within_planes_and_locks(robot: sn.Robot) -> None:
    rng = np.random.default_rng(0)
    for _ in range(4):
        q = robot.drive.coordinates.project(0.5 * rng.normal(size=(3, 3)) + np.array([0.0, 0.0, 1.0]))
        q[:, 0] -= q[:, 0].mean() if robot is SUM else 0.0
        found = sn.solve(robot, sn.Target(robot.tip(q)[:3, 3]), **LOOSE)
        assert found.solved
        assert robot.violations(found.q) == []
        assert found.verify().ok
        if robot is SUM:
            np.testing.assert_allclose(robot.from_actuators(found.actuators or {}), found.q, atol=1e-12)


def test_nearest_is_that_of_the_plane() -> None:
    """By brute force over the two coordinates that are driven."""
    target = np.array([0.0, 25.0, 120.0])
    found = sn.solve(SCOPE, sn.Target(target), **LOOSE)
    assert not found.solved
    bends, lengths = np.meshgrid(np.linspace(-3.0, 3.0, 121), np.linspace(0.0, 150.0, 151))
    shapes = np.zeros((bends.size, 2, 3))
    shapes[:, 0, 2], shapes[:, 1, 0], shapes[:, 1, 2] = lengths.ravel(), bends.ravel(), 50.0
    nearest = np.linalg.norm(SCOPE.tip(shapes)[:, :3, 3] - target, axis=1).min()
    assert found.position_error == pytest.approx(25.0, abs=1e-6)
    assert nearest == pytest.approx(25.0, abs=0.2)
    assert found.to_dict()["locked"] == list(SCOPE.notes)
    solved = sn.solve(SCOPE, sn.Target((25.0, 0.0, 120.0)), **LOOSE)
    assert solved.solved
    np.testing.assert_allclose(SCOPE.from_actuators(solved.actuators or {}), solved.q, atol=1e-12)


@pytest.mark.parametrize("robot", [LOCKED, SUM])
def test_control_steps_keep_what_is_held(robot: sn.Robot) -> None:
    solver, q = sn.Solver(robot), np.array([[0.3, 0.1, 1.0], [-0.3, 0.2, 1.0], [0.0, 0.3, 1.0]])
    q = robot.drive.coordinates.project(q)
    goal = sn.Target((0.3, 0.8, 2.3))
    rates = sn.Rates(bend=2.0, length=1.0)
    errors = []
    for _ in range(25):
        step = solver.step(q, None, 0.05, target=goal, rates=rates)
        assert np.abs(step.q - q)[:, :2].max() <= 0.1 + 1e-12
        assert robot.excess(step.q) <= 1e-12
        q = step.q
        errors.append(float(np.linalg.norm(robot.tip(q)[:3, 3] - (0.3, 0.8, 2.3))))
    assert errors[-1] < 0.5 * errors[0]


def test_derivatives_move_within_planes() -> None:
    q = LOCKED.drive.coordinates.project(np.array([[0.5, 0.5, 0.8], [0.2, 0.4, 1.0], [0.0, 0.0, 1.0]]))
    found = sn.solve(LOCKED, sn.Target(LOCKED.tip(q)[:3, 3]), initial=q, **LOOSE)
    slope = np.asarray(found.derivative(("target",)).q["target"])
    for k, plane in ((0, 0.7), (1, 1.7)):
        across = math.cos(plane) * slope[k, 1] - math.sin(plane) * slope[k, 0]
        np.testing.assert_allclose(across, 0.0, atol=1e-12)
    np.testing.assert_array_equal(slope[2, :2], 0.0)


@pytest.mark.parametrize("method", ["fabrikc", "fabrikx", "fabrik_avoid", "slinki", "opti_path"])
def test_methods_for_free_bends_refuse_planes(method: Any) -> None:
    refused("method", lambda: sn.Solver(LOCKED, method=method), "bends in one plane")


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
@pytest.mark.parametrize("asked", [False, True])
def test_chains_from_the_target_stay_in_the_plane_of_the_body(angle: float, asked: bool) -> None:
    bending = [sn.Segment((0.5, 1.0), 2.0, plane=turn) for turn in (angle, angle + math.pi, angle)]
    robot = sn.Robot([sn.Segment((0.0, 2.0), 0.0), *bending], base=sn.pose((1, 2, 3), rotation=(1, 2, 3, 4)))
    way = np.array([math.cos(angle), math.sin(angle), 0.0])
    q = np.array([1.0, 0.9, -0.4, 1.5])[:, None] * way * [[0.0], [1.0], [1.0], [1.0]] + [0.0, 0.0, 0.8]
    tip = robot.tip(q)
    target = sn.Target(tip[:3, 3], direction=tip[:3, 2] if asked else None)
    scene = sn.Scene([sn.Sphere((50.0, 0.0, 0.0), 1.0)])
    searches = Searches(robot, scene, sn.Tolerance().for_robot(robot))
    groups = searches.groups(sn.Problem(robot, (target,), scene))
    normal = robot.base[:3, :3] @ np.cross([0.0, 0.0, 1.0], way)
    poses = find_terminal_poses(groups, np.linspace(robot.base[:3, 3], tip[:3, 3], 20))
    assert len(poses) == 1 if asked else len(poses) > 4
    turns = poses[:, :9].reshape(-1, 3, 3)  # in the frames of chains that begin there, the plane is the same for all
    np.testing.assert_allclose(normal @ turns, np.broadcast_to([-way[1], -way[0], 0.0], (len(poses), 3)), atol=1e-12)
    end = np.append((tip[:3, :3] @ FLIP).ravel(), tip[:3, 3])
    if asked:
        np.testing.assert_allclose(poses[0], end, atol=1e-12)
    other, chain = reverse_problem(groups, end), q[::-1] * [1.0, -1.0, 1.0]
    bends = segments_in(other[0])[:3, t.PLANE : t.PLANE + 2]
    across = bends[:, 0] * chain[:3, 1] - bends[:, 1] * chain[:3, 0]
    np.testing.assert_allclose(across, 0.0, atol=1e-12)
    np.testing.assert_allclose(reverse_chain(groups, problem_from_pose(other, end), chain), q, atol=1e-12)
