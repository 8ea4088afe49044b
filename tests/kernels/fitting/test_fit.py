"""The chain fitted to a route.

Lines of points: how far they are from the obstacles.

Chains drawn to their targets in short steps.
"""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import sinuous as sn
from sinuous.kernels.fitting.fit import fit_route, fit_workspace_size
from sinuous.kernels.fitting.lines import LINE_SIDES, SIDE_STEPS, widths_across
from sinuous.kernels.fitting.short_steps import MOST_STEPS, REACH_STEP
from sinuous.solver.polylines import respaced
from tests.helpers import Floats, kernel_groups

POINTS = 300


def lay(robot: sn.Robot, route: Floats, seconds: float = 60.0, scene: sn.Scene | None = None) -> Floats:
    problem = sn.Problem(robot, sn.Target(route[-1]), scene or sn.Scene())
    workspace = np.full(fit_workspace_size(len(robot), len(robot.actuation), len(problem.scene), 1), np.nan)
    out = np.empty((len(robot), 3))
    fit_route(*kernel_groups(problem), route, seconds, workspace, out)
    return out


def shape(seed: int, n: int, spread: float) -> Floats:
    rng = np.random.default_rng(seed)
    angle, bend = rng.uniform(-np.pi, np.pi, n), rng.uniform(0.2, 1.8, n)
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), 1.0 + spread * rng.uniform(-1, 1, n)], axis=-1)


@pytest.mark.parametrize("n", [1, 3, 8, 20])
@pytest.mark.parametrize("spread", [0.0, 0.15])
def test_a_chain_finds_into_its_own_backbone(n: int, spread: float) -> None:
    robot = sn.Robot.uniform(n, length=(0.8, 1.2) if spread else 1.0, max_bend=2.4)
    q = shape(n, n, spread)
    found = lay(robot, respaced(robot.backbone(q, 400), POINTS))
    off, _ = cKDTree(robot.backbone(q, 2000)).query(robot.backbone(found, 20))
    assert np.max(off) < (0.01 if spread == 0.0 else 0.05)
    assert np.linalg.norm(robot.tip(found)[:3, 3] - robot.tip(q)[:3, 3]) < 0.03
    assert robot.excess(found) <= 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_keeps_off_what_the_route_keeps_off(seed: int) -> None:
    robot = sn.Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
    q = shape(seed, 5, 0.1)
    route = respaced(robot.backbone(q, 400), POINTS)
    away = np.cross(np.gradient(route, axis=0), np.random.default_rng(seed).normal(size=3))
    balls = [sn.Sphere(p + 0.31 * off / np.linalg.norm(off), 0.2) for p, off in zip(route, away, strict=True)][40::20]
    scene = sn.Scene([ball for ball in balls if (np.linalg.norm(route - ball.center, axis=1) > 0.30).all()])
    assert len(scene) > 1
    coarser = sn.Robot.uniform(4, length=(1.0, 1.5), max_bend=3.0, radius=0.1)  # it cannot lie along all of the route
    body = coarser.backbone(lay(coarser, route, scene=scene), 50)
    assert scene.distance(body).min() > 0.1


def beside(scene: sn.Scene, line: Floats, radius: float, enough: float) -> Floats:
    room = np.empty(len(line))
    widths_across(scene.snapshot().group.copy(), line, radius, enough, room)
    return room


def some_lines(seed: int) -> tuple[sn.Scene, Floats]:
    rng = np.random.default_rng(seed)
    scene = sn.Scene([sn.Box(rng.uniform(-1.0, 1.0, 3), rng.uniform(0.2, 0.5, 3)) for _ in range(9)])
    return scene, np.linspace(rng.uniform(-2.0, 0.0, 3), rng.uniform(0.0, 2.0, 3), 60)


@pytest.mark.parametrize("seed", range(4))
def test_the_width_across_a_line_is_that_of_a_place_at_most_so_far_aside(seed: int) -> None:
    scene, line = some_lines(seed)
    radius, enough = 0.1, 0.4
    found, own = beside(scene, line, radius, enough), scene.distance(line)
    ahead = (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    x = np.cross(ahead, (0.3, 0.5, 0.8))
    x /= np.linalg.norm(x)
    angles = np.linspace(0.0, 2.0 * np.pi, 200 * LINE_SIDES)[:, None]
    ring = np.cos(angles) * x + np.sin(angles) * np.cross(ahead, x)
    around = line[:, None, None] + radius * np.arange(1, SIDE_STEPS + 1)[:, None, None] * ring
    most = np.maximum(own, scene.distance(around).max(axis=(1, 2)))
    free = (own > 0.0) & (own < enough)
    assert free.any()
    assert (found[free] >= own[free] - 1e-12).all()
    assert (found[free] <= most[free] + 0.01 * radius).all()
    np.testing.assert_allclose(found[own <= 0.0], own[own <= 0.0])
    assert (found[own >= enough] >= enough).all()


def test_a_wall_between_two_points_is_not_stepped_over() -> None:
    door = sn.Scene([sn.Box((side * 1.15, 0.0, 0.0), (2.0, 4.0, 0.1)) for side in (-1.0, 1.0)])
    coarse = np.array([(0.0, 0.0, z) for z in (-3.6, -2.1, -0.6, 0.9, 2.4)])
    assert door.distance(coarse).min() > 0.4
    room = beside(door, coarse, 0.1, 0.4)
    assert room[2] == pytest.approx(0.15, abs=0.01)
    assert (room[[0, 1, 4]] >= 0.4).all()
    assert (beside(door, coarse, 0.0, 0.4) >= 0.4).all()


RADIUS = 0.1
ROBOT = sn.Robot.uniform(6, length=1.0, max_bend=1.6, radius=RADIUS)
CHAIN = np.tile([0.3, 0.1, 1.0], (6, 1))
TIP = ROBOT.tip(CHAIN)


def settled(scene: sn.Scene, target: sn.Target, seconds: float = 60.0, robot: sn.Robot = ROBOT) -> Floats:
    problem = sn.Problem(robot, target, scene)
    workspace = np.full(fit_workspace_size(6, 0, len(problem.scene), 1), np.nan)
    out = CHAIN.copy()
    fit_route(*kernel_groups(problem), np.empty((0, 3)), seconds, workspace, out)
    return out


@pytest.mark.parametrize("direction", [None, tuple(TIP[:3, 2])])
def test_the_target_is_met_that_is_near(direction: tuple[float, float, float] | None) -> None:
    goal = TIP[:3, 3] + [0.4, -0.3, -0.2]
    found = settled(sn.Scene([]), sn.Target(goal, direction=direction))
    assert np.linalg.norm(ROBOT.tip(found)[:3, 3] - goal) < 1e-2
    assert ROBOT.excess(found) <= 1e-12


def test_no_step_is_long() -> None:
    """However far the target is: the end comes no nearer than all steps are long, and a little for curves."""
    goal = TIP[:3, 3] + [-9.0, 0.0, 0.0]
    moved = np.linalg.norm(ROBOT.tip(settled(sn.Scene([]), sn.Target(goal)))[:3, 3] - TIP[:3, 3])
    assert 0.1 < moved < 1.2 * MOST_STEPS * REACH_STEP * RADIUS


def test_what_overlaps_is_pushed_off() -> None:
    line = ROBOT.backbone(CHAIN, 40)
    beside = line[150] + [0.0, 0.3, 0.0]
    wall = sn.Scene([sn.Box(beside, (0.5, 0.52, 0.5))])
    assert wall.distance(line).min() < 0.6 * RADIUS
    found = settled(wall, sn.Target(TIP[:3, 3]))
    assert wall.distance(ROBOT.backbone(found, 40)).min() > 0.97 * RADIUS
    assert np.linalg.norm(ROBOT.tip(found)[:3, 3] - TIP[:3, 3]) < 1e-2
