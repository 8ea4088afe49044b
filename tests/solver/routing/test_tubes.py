"""Chains out of tubes: in the tube they lie in its middle, beyond it they lead to the target."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places.parts.surfaces import hollow, open_tube, solid
from sinuous import Box, Robot, Scene, Segment, Target, Tolerance
from sinuous.kernels.tables import QUERY_RADIUS
from sinuous.kernels.tubes import MOUTH
from sinuous.model.actuators import Tendons
from sinuous.problem.problem import Problem
from sinuous.solver.attempts import IKQuery, RandomRestarts
from sinuous.solver.routing.partial_problems import Groups
from sinuous.solver.routing.searches import Searches
from sinuous.solver.routing.tubes import Tube, chains_out_of_tube, find_tube_around, line_to_target_in_tube
from sinuous.solver.strategy import attempts_of
from tests.helpers import Floats

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
PIPE = Scene([solid(open_tube(AXIS, 1.3 * RADIUS, 2.1 * RADIUS), "pipe")])
TARGET = Target(ROBOT.tip(Q)[:3, 3])


def asked(robot: Robot, scene: Scene, targets: list[Target]) -> tuple[Searches, Problem, Groups, Floats]:
    tolerance = Tolerance().for_robot(robot)
    router = Searches(robot, scene, tolerance)
    problem = Problem.prepared(robot, tuple(targets), scene.snapshot(), tolerance)
    query = router.query(problem)
    assert query is not None
    return router, problem, router.groups(problem), query


def chains(robot: Robot, scene: Scene, targets: list[Target]) -> list[tuple[Floats, Floats]]:
    _, _, groups, query = asked(robot, scene, targets)
    tube = find_tube_around(groups[1], query, 60.0)
    assert tube is not None
    assert tube.open
    return list(chains_out_of_tube(tube, groups, lambda: 60.0))


def test_chains_out_of_a_pipe_lie_free_in_it_and_reach_the_target() -> None:
    found = chains(ROBOT, PIPE, [TARGET])
    assert 1 <= len(found) <= 2
    best = 0.0
    for q, route in found:
        assert ROBOT.excess(q) <= 1e-12
        assert np.allclose(route[0], ROBOT.base[:3, 3])
        points = ROBOT.backbone(q, 20)
        assert np.allclose(route[-1], points[-1])
        inside = points[: 20 * (ENCLOSED - 1)]
        best = max(best, float(PIPE.distance(inside).min() - RADIUS))
        assert np.linalg.norm(points[-1] - TARGET.position) < 1e-2
    assert best > 0.0


def test_what_lies_in_a_pipe_is_solved_along_it() -> None:
    solution = sn.solve(ROBOT, TARGET, PIPE)
    assert solution.solved
    assert sn.check(ROBOT, solution.q, PIPE, TARGET).ok
    assert solution.start == "route"
    assert solution.route is not None
    assert np.allclose(solution.route[0], ROBOT.base[:3, 3])


def test_an_elbow_beyond_the_pipe_is_asked_of_the_same_segment() -> None:
    elbow = Target(ROBOT.forward(Q)[4, :3, 3], segment=5)
    assert elbow.position is not None
    for q, _ in chains(ROBOT, PIPE, [elbow, TARGET])[:1]:
        assert np.linalg.norm(ROBOT.forward(q)[4, :3, 3] - elbow.position) < 1e-2


def test_a_target_in_the_pipe_is_reached_along_its_axis() -> None:
    wall = hollow(poses(ROBOT, Q), 1.4 * RADIUS, 2.2 * RADIUS)
    scene = Scene([solid(wall, "pipe")])
    _, _, groups, query = asked(ROBOT, scene, [TARGET])
    tube = find_tube_around(groups[1], query, 60.0)
    assert tube is not None
    assert not tube.open
    line = line_to_target_in_tube(tube, query)
    assert line is not None
    assert TARGET.position is not None
    assert np.allclose(line[-1], TARGET.position)
    assert scene.distance(line).min() >= 0.8 * RADIUS
    assert sn.solve(ROBOT, TARGET, scene).solved


def test_a_target_beyond_the_mouth_is_not_within() -> None:
    _, _, groups, query = asked(ROBOT, PIPE, [TARGET])
    tube = find_tube_around(groups[1], query, 60.0)
    assert tube is not None
    assert line_to_target_in_tube(tube, query) is None


def test_there_are_none_in_the_open_nor_for_a_body_without_radius() -> None:
    scene = Scene([Box((2.0, 0.0, 0.0), (0.5, 0.5, 0.5))])
    _, _, groups, query = asked(ROBOT, scene, [TARGET])
    assert find_tube_around(groups[1], query, 60.0) is None
    _, _, groups, query = asked(ROBOT, PIPE, [TARGET])
    query[QUERY_RADIUS] = 0.0
    assert find_tube_around(groups[1], query, 60.0) is None


def test_a_tube_as_long_as_the_robot_leaves_nothing_to_go_on_with() -> None:
    _, _, groups, _ = asked(ROBOT, PIPE, [TARGET])
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 9.0), 80)
    assert not list(chains_out_of_tube(Tube(line, MOUTH), groups, lambda: 60.0))


def test_there_is_no_chain_when_the_time_is_over() -> None:
    _, _, groups, query = asked(ROBOT, PIPE, [TARGET])
    tube = find_tube_around(groups[1], query, 60.0)
    assert tube is not None
    assert not list(chains_out_of_tube(tube, groups, lambda: 0.0))


@pytest.mark.parametrize("tendons", [False, True])
def test_robots_with_limits_of_actuators_are_left_alone(tendons: bool) -> None:
    lines = Tendons(3, 0.05, displacement=(-0.5, 0.5)) if tendons else None
    robot = Robot([Segment((0.8, 1.2), 1.8, radius=RADIUS, tendons=lines)] * 7)
    searches, problem, _, _ = asked(robot, PIPE, [TARGET])
    question = IKQuery(problem, np.empty((0, len(robot), 3)), lambda: 60.0)
    batches = attempts_of(question, RandomRestarts(3, 10), searches).batches()
    first = next(batch for batch in batches if len(batch.initial))
    assert len(first.initial) == 1
    in_tube = PIPE.distance(robot.backbone(first.initial[0], 20)[: 20 * (ENCLOSED - 1)]).min() > RADIUS
    assert in_tube != tendons
