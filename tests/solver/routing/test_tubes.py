"""Bodies in pipes: shapes lie along the pipe, beyond it they lead to the target."""

import numpy as np

import sinuous as sn
from benchmarks.places.solids import hollow, open_tube
from sinuous import Robot, Scene, Segment, Target
from tests.helpers import Floats, present

RADIUS = 0.08
SEGMENTS = [Segment((0.8, 1.2), 1.8, radius=RADIUS)] * 7
ROBOT = Robot(SEGMENTS)
Q = np.array([[0.7, 0.2, 1.0], [-0.4, 0.6, 1.1], [0.1, -0.8, 0.9]] + [[0.9, 0.5, 1.0]] * 4)
ENCLOSED = 3
"""Segments that the pipe encloses."""


def poses(robot: Robot, q: Floats, samples: int = 10) -> Floats:
    frames = [robot.base]
    for k in range(len(q)):
        for share in np.linspace(0.0, 1.0, samples + 1)[1:]:
            part = q.copy()
            part[k] *= share
            frames.append(Robot([Segment((0.0, 2.0), 2.0)] * len(robot), base=robot.base).forward(part)[k])
    return np.array(frames)


AXIS = poses(ROBOT, Q)[: 10 * ENCLOSED + 1]
PIPE = Scene([open_tube(AXIS, 1.3 * RADIUS, 2.1 * RADIUS).mesh("pipe")])
TARGET = Target(ROBOT.tip(Q)[:3, 3])


def test_what_lies_in_a_pipe_is_solved_along_it() -> None:
    solution = sn.solve(ROBOT, TARGET, PIPE)
    assert solution.solved
    assert sn.check(ROBOT, solution.q, PIPE, TARGET).ok
    assert solution.start == "route"
    assert np.allclose(present(solution.route)[0], ROBOT.base[:3, 3])


def test_a_target_in_the_pipe_is_reached_along_its_axis() -> None:
    wall = hollow(poses(ROBOT, Q), 1.4 * RADIUS, 2.2 * RADIUS)
    scene = Scene([wall.mesh("pipe")])
    solution = sn.solve(ROBOT, TARGET, scene)
    assert (solution.solved, solution.start) == (True, "route")
    assert sn.check(ROBOT, solution.q, scene, TARGET).ok
    assert scene.distance(present(solution.route)).min() >= 0.8 * RADIUS
