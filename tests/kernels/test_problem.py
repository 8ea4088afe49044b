"""What is packed is what the kernels read."""

import math
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.model.actuators import Chambers, Tendons
from sinuous.model.robot import Robot, robot_group
from sinuous.model.segment import Segment
from sinuous.problem.problem import Preferences, settings_group
from sinuous.problem.target import Target, Tolerance, target_table
from sinuous.scene.scene import Scene
from tests.helpers import Floats, random_pose

lengths = st.tuples(st.floats(0.1, 5.0), st.floats(0.0, 2.0)).map(lambda pair: (pair[0], pair[0] + pair[1]))
limits = st.floats(0.01, 1.0).map(lambda most: (-most, 2.0 * most))
tendons = st.none() | st.builds(
    lambda lines, own: Tendons(lines, 0.05, 0.1, displacement=own), st.integers(1, 4), limits
)
chambers = st.none() | st.builds(lambda lines: Chambers(lines, 0.1, length=(0.05, 9.0)), st.integers(2, 4))
curvatures = st.none() | st.floats(0.1, 9.0)
segments = st.builds(Segment, lengths, st.floats(0.0, 7.0), curvatures, st.floats(0.0, 0.1), tendons, chambers)
seeds = st.integers(0, 10**6)
poses = seeds.map(lambda seed: random_pose(np.random.default_rng(seed)))
robots = st.builds(
    lambda own, base, tool, mount: Robot(own, mount=mount, base=base, tool=tool),
    st.lists(segments, min_size=1, max_size=6),
    poses,
    poses,
    st.floats(0.0, 1.0),
)


ANY_TARGET = (Target((0, 0, 1)),)


def read(robot: Robot, targets: Any = ANY_TARGET, scene: Any = (), settings: Floats | None = None) -> Problem:
    own = settings_group(robot, Tolerance(1e-3)) if settings is None else settings
    return read_problem(robot_group(robot), Scene(scene).group.copy(), own, target_table(robot, tuple(targets)).copy())


@given(robots)
def test_a_robot_is_read_back(robot: Robot) -> None:
    problem = read(robot)
    for row, segment, curvature in zip(problem.limits, robot.segments, robot.curvatures, strict=True):
        assert (row[t.MIN_LENGTH], row[t.MAX_LENGTH]) == segment.length
        assert row[t.MAX_CURVATURE] == curvature
        assert row[t.RADIUS] == row[t.SELF_RADIUS] == segment.radius
        assert (row[t.MAX_BEND], row[t.BEND_SCALE]) == (segment.max_bend, float(segment.max_bend > 0.0))
        fixed = segment.length[0] == segment.length[1]
        assert row[t.LENGTH_SCALE] == (0.0 if fixed else 0.5 * sum(segment.length))
    for pose, matrix in ((problem.base, robot.base), (problem.tool, robot.tool)):
        np.testing.assert_array_equal(pose[0, : t.POSE_POSITION].reshape(3, 3), matrix[:3, :3])
        np.testing.assert_array_equal(pose[0, t.POSE_POSITION :], matrix[:3, 3])


@given(robots, seeds)
def test_limits_of_actuators_say_what_their_lines_do(robot: Robot, seed: int) -> None:
    q = np.random.default_rng(seed).normal(size=(len(robot), 3))
    table = read(robot).actuation
    first, last = table[:, t.FIRST_SEGMENT].astype(int), table[:, t.LAST_SEGMENT].astype(int)
    seen = [
        q[a : b + 1].sum(axis=0) @ row[t.WEIGHTS : t.WEIGHTS + 3] for a, b, row in zip(first, last, table, strict=True)
    ]
    limited = np.array([math.isfinite(sum(map(abs, each.limits))) for each in robot.actuators], bool)
    np.testing.assert_allclose(seen, robot.to_actuators(q)[limited], atol=1e-12)
    assert list(last) == sorted(last)


@given(robots, st.tuples(*[st.floats(1e-6, 1.0)] * 5), st.lists(st.floats(-9.0, 9.0), max_size=4))
def test_settings_are_read_back(robot: Robot, values: tuple[float, ...], options: list[float]) -> None:
    off, turn, *wishes = values
    settings = settings_group(robot, Tolerance(off, turn), Preferences(*wishes), options)
    problem = read(robot, settings=settings)
    assert (problem.mount, problem.unit) == (robot.mount, robot.mean_length)
    assert (problem.margin, problem.avoids_itself) == (packing.MARGIN * robot.mean_length, robot.avoids_itself)
    assert (problem.position_tolerance, problem.angle_tolerance) == (off, turn)
    assert (problem.coarse_depth, problem.step_depth) == (packing.LOOK_DEPTH, packing.STEP_DEPTH)
    assert settings[t.MAX_ITERATIONS] == packing.ITERATIONS
    assert list(settings[[t.INITIAL_WEIGHT, t.BENDS_WEIGHT, t.WISHED_CLEARANCE]]) == wishes
    assert list(settings[t.METHOD_OPTIONS :]) == options


def test_answers_and_records_are_read_back_in_the_order_of_their_columns() -> None:
    answers = np.arange(2.0 * t.answer_size(3)).reshape(2, -1)
    q, record = answer_of(answers, 1, 3)
    np.testing.assert_array_equal([*record, *q.ravel()], answers[1])
    outcome = t.Outcome.from_record(q, record.tolist())
    columns = {name: getattr(t, name.upper()) for name in outcome._fields if name not in ("q", "cell", "route")}
    assert sorted(columns.values()) == list(range(t.RECORD_WIDTH))
    for name, column in columns.items():
        assert float(getattr(outcome, name)) == (1.0 if name == "bound" else record[column])
