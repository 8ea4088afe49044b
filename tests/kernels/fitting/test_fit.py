"""The chain fitted to a route."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sinuous.kernels.fitting.fit import fit_route, fit_workspace_size
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_groups

POINTS = 300


def lay(robot: Robot, route: Floats, seconds: float = 60.0, scene: Scene | None = None) -> Floats:
    problem = Problem(robot, Target(route[-1]), scene or Scene())
    workspace = np.full(fit_workspace_size(len(robot), len(robot.actuation), len(problem.scene), 1), np.nan)
    out = np.empty((len(robot), 3))
    fit_route(*kernel_groups(problem), route, seconds, workspace, out)
    return out


def own_route(robot: Robot, q: Floats) -> Floats:
    """The backbone itself, as evenly spaced points."""
    dense = robot.backbone(q, 400)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], POINTS)
    return np.stack([np.interp(at, along, dense[:, axis]) for axis in range(3)], axis=-1)


def shape(seed: int, n: int, spread: float) -> Floats:
    rng = np.random.default_rng(seed)
    angle, bend = rng.uniform(-np.pi, np.pi, n), rng.uniform(0.2, 1.8, n)
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), 1.0 + spread * rng.uniform(-1, 1, n)], axis=-1)


@pytest.mark.parametrize("n", [1, 3, 8, 20])
@pytest.mark.parametrize("spread", [0.0, 0.15])
def test_a_chain_finds_into_its_own_backbone(n: int, spread: float) -> None:
    robot = Robot.uniform(n, length=(0.8, 1.2) if spread else 1.0, max_bend=2.4)
    q = shape(n, n, spread)
    found = lay(robot, own_route(robot, q))
    off, _ = cKDTree(robot.backbone(q, 2000)).query(robot.backbone(found, 20))
    assert np.max(off) < (0.01 if spread == 0.0 else 0.05)
    assert np.linalg.norm(robot.tip(found)[:3, 3] - robot.tip(q)[:3, 3]) < 0.03
    assert robot.excess(found) <= 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_keeps_off_what_the_route_keeps_off(seed: int) -> None:
    robot = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
    q = shape(seed, 5, 0.1)
    route = own_route(robot, q)
    away = np.cross(np.gradient(route, axis=0), np.random.default_rng(seed).normal(size=3))
    balls = [Sphere(p + 0.31 * off / np.linalg.norm(off), 0.2) for p, off in zip(route, away, strict=True)][40::20]
    scene = Scene([ball for ball in balls if (np.linalg.norm(route - ball.center, axis=1) > 0.30).all()])
    assert len(scene) > 1
    coarser = Robot.uniform(4, length=(1.0, 1.5), max_bend=3.0, radius=0.1)  # it cannot lie along all of the route
    body = coarser.backbone(lay(coarser, route, scene=scene), 50)
    assert scene.distance(body).min() > 0.1
