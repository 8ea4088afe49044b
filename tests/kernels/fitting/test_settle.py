"""Chains drawn to their targets in short steps."""

import numpy as np
import pytest

from sinuous.kernels.fitting.fit import fit_workspace_size
from sinuous.kernels.fitting.settle import MOST_STEPS, REACH_STEP, settle_chain
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_groups

RADIUS = 0.1
ROBOT = Robot.uniform(6, length=1.0, max_bend=1.6, radius=RADIUS)
CHAIN = np.tile([0.3, 0.1, 1.0], (6, 1))
TIP = ROBOT.tip(CHAIN)


def settled(scene: Scene, target: Target, seconds: float = 60.0, robot: Robot = ROBOT) -> Floats:
    problem = Problem(robot, target, scene)
    workspace = np.full(fit_workspace_size(6, 0, len(problem.scene), 1), np.nan)
    out = CHAIN.copy()
    settle_chain(*kernel_groups(problem), seconds, workspace, out)
    return out


@pytest.mark.parametrize("direction", [None, tuple(TIP[:3, 2])])
def test_the_target_is_met_that_is_near(direction: tuple[float, float, float] | None) -> None:
    goal = TIP[:3, 3] + [0.4, -0.3, -0.2]
    found = settled(Scene([]), Target(goal, direction=direction))
    assert np.linalg.norm(ROBOT.tip(found)[:3, 3] - goal) < 1e-2
    assert ROBOT.excess(found) <= 1e-12


def test_no_step_is_long() -> None:
    """However far the target is: the end comes no nearer than all steps are long, and a little for curves."""
    goal = TIP[:3, 3] + [-9.0, 0.0, 0.0]
    moved = np.linalg.norm(ROBOT.tip(settled(Scene([]), Target(goal)))[:3, 3] - TIP[:3, 3])
    assert 0.1 < moved < 1.2 * MOST_STEPS * REACH_STEP * RADIUS


def test_what_overlaps_is_pushed_off() -> None:
    line = ROBOT.backbone(CHAIN, 40)
    beside = line[150] + [0.0, 0.3, 0.0]
    wall = Scene([Box(beside, (0.5, 0.52, 0.5))])
    assert wall.distance(line).min() < 0.6 * RADIUS
    found = settled(wall, Target(TIP[:3, 3]))
    assert wall.distance(ROBOT.backbone(found, 40)).min() > 0.97 * RADIUS
    assert np.linalg.norm(ROBOT.tip(found)[:3, 3] - TIP[:3, 3]) < 1e-2
