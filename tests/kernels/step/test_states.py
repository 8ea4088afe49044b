"""The workspace: every array has its own place in the buffer, and all of them fill it."""

import numpy as np
import pytest

from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.states import STATES, carve, pick, workspace_size
from sinuous.model.actuators import Tendons
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Sphere
from tests.helpers import kernel_problem, random_pose

BASE = random_pose(np.random.default_rng(0))
PLAIN = Robot.uniform(3, (0.5, 1.0), base=BASE)
DRIVEN = Robot.uniform(5, (0.5, 1.0), base=BASE, tendons=Tendons(3, 0.05, displacement=(-0.1, 0.1)))
TARGETS = [Target((0.0, 1.0, 2.0)), Target((0.0, 0.0, 1.0), segment=2)]
PROBLEMS = [
    kernel_problem(robot, TARGETS[:count], [Sphere((0.0, 0.0, 9.0), 1.0)] * obstacles)
    for robot, count, obstacles in ((PLAIN, 1, 0), (PLAIN, 2, 3), (DRIVEN, 1, 1), (DRIVEN, 2, 0))
]


@pytest.mark.parametrize("problem", PROBLEMS, ids=range(4))
def test_arrays_fill_the_workspace_and_none_is_in_the_place_of_another(problem: Problem) -> None:
    sizes = len(problem.limits), len(problem.actuation), number_of(problem.scene), len(problem.targets)
    buffer = np.zeros(workspace_size(*sizes) + 7)
    states, work = carve(buffer, problem)
    for i in range(STATES):
        np.testing.assert_array_equal(states.frames[i, 0], problem.base[0])
    buffer[:] = 0.0
    each = [pick(states, i) for i in range(STATES)]
    arrays = [part for one in each for part in (*one[:3], *one.rows, one.norms)]
    for array in (*arrays, *work):
        array.view(np.uint8)[...] += 1
    used, spare = np.split(buffer.view(np.uint8), [8 * workspace_size(*sizes)])
    assert (used == 1).all()
    assert not spare.any()
