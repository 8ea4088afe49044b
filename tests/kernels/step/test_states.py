"""The workspace: every array has its own place in the buffer, and all of them have room."""

import numpy as np
import pytest

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import Problem as KernelProblem
from sinuous.kernels.problem import read_problem
from sinuous.kernels.step.states import STATES, carve, pick, workspace_size
from sinuous.model.actuators import Tendons
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Sphere
from tests.helpers import kernel_groups, kernel_problem, random_pose
from tests.kernels.workspace import make_states, make_work, same


@entry
def fill(robot: Array, scene: Array, settings: Array, targets: Array, buffer: Array, frames: Array) -> None:
    """Copy the frames; then number the arrays, each filled with its number."""
    problem = read_problem(robot, scene, settings, targets)
    states, work = carve(buffer, problem)
    same(states.frames, frames)
    rows = states.rows
    states.q[:], states.frames[:], states.columns[:], states.norms[:] = 1.0, 2.0, 3.0, 4.0
    rows.start[:], rows.kind[:] = 5, 6
    rows.twist[:], rows.inner[:], rows.total[:], rows.value[:], rows.gain[:] = 7.0, 8.0, 9.0, 10.0, 11.0
    rows.innovation[:] = 12.0
    work.root[:], work.mean[:], work.step[:], work.solved[:] = 13.0, 14.0, 15.0, 16.0
    work.bound[:], work.among[:], work.clock[:] = 17, 18, 19
    work.rest[:] = 20.0


@entry
def choose(robot: Array, scene: Array, settings: Array, targets: Array, buffer: Array, i: int) -> None:
    """Fill state number `i` alone."""
    states, _ = carve(buffer, read_problem(robot, scene, settings, targets))
    state = pick(states, i)
    state.q[:], state.frames[:], state.columns[:], state.norms[:] = 1.0, 1.0, 1.0, 1.0
    state.rows.start[:], state.rows.kind[:], state.rows.twist[:], state.rows.inner[:] = 1, 1, 1.0, 1.0
    state.rows.total[:], state.rows.value[:], state.rows.gain[:], state.rows.innovation[:] = 1.0, 1.0, 1.0, 1.0


def problems() -> list[Problem]:
    base = random_pose(np.random.default_rng(0))
    plain = Robot.uniform(3, (0.5, 1.0), base=base)
    driven = Robot.uniform(5, (0.5, 1.0), base=base, tendons=Tendons(3, 0.05, displacement=(-0.1, 0.1)))
    ball = Sphere((0.0, 0.0, 9.0), 1.0)
    tip, inner = Target((0.0, 1.0, 2.0)), Target((0.0, 0.0, 1.0), segment=2)
    return [
        Problem(plain, tip),
        Problem(plain, [tip, inner], [ball] * 3),
        Problem(driven, [tip], [ball]),
        Problem(driven, [tip, inner], tolerance=Tolerance(1e-3)),
    ]


def size_of(problem: Problem) -> int:
    robot = problem.robot
    return workspace_size(len(robot), len(robot.actuation), len(problem.scene), len(problem.targets))


@pytest.mark.parametrize("problem", problems(), ids=range(4))
def test_no_array_is_in_the_place_of_another(problem: Problem) -> None:
    size = size_of(problem)
    buffer, frames = np.full(size + 7, -1.0), np.empty((STATES, len(problem.robot) + 1, 12))
    fill(*kernel_groups(problem), buffer, frames)
    written = buffer.copy()
    whole = buffer.view(np.int64)
    states, work = make_states(kernel_form(problem)), make_work(kernel_form(problem))
    arrays = [states.q, states.frames, states.columns, states.norms, *states.rows, *work]
    for number, array in enumerate(arrays, start=1):
        seen = whole == number if array.dtype == np.int64 else written == float(number)
        assert seen.sum() == array.size, f"array {number}"
    assert (written[size:] == -1.0).all(), "beyond the size that was said"
    base = problem.robot.base
    np.testing.assert_array_equal(frames[:, 0, :9].reshape(-1, 3, 3), np.tile(base[:3, :3], (STATES, 1, 1)))
    np.testing.assert_array_equal(frames[:, 0, 9:], np.tile(base[:3, 3], (STATES, 1)))


@pytest.mark.parametrize("problem", problems(), ids=range(4))
def test_a_state_is_picked_whole_and_alone(problem: Problem) -> None:
    states = make_states(kernel_form(problem))
    arrays = states.q, states.frames, states.columns, states.norms, *states.rows
    one = sum(array[0].size for array in arrays)
    touched = []
    for i in range(STATES):
        buffer = np.full(size_of(problem), -1.0)
        choose(*kernel_groups(problem), buffer, i)
        touched.append(set(np.flatnonzero(buffer != -1.0)))
        # The frame of the base is written in all states.
        assert len(touched[i]) == one + 12 * (STATES - 1)
    assert len(touched[0] & touched[1] & touched[2]) == 12 * STATES
    assert len(touched[0] | touched[1] | touched[2]) == one * STATES


def kernel_form(problem: Problem) -> KernelProblem:
    return kernel_problem(problem.robot, list(problem.targets), problem.scene, problem.tolerance)
