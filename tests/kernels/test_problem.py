"""What is packed is what the kernels read."""

import math
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import answer_of, read_problem
from sinuous.model.actuators import Chambers, Tendons
from sinuous.model.robot import Robot, robot_group
from sinuous.model.segment import Segment
from sinuous.problem.problem import Preferences, settings_group
from sinuous.problem.target import Target, Tolerance, target_table
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Sphere
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.scene import Scene
from tests.helpers import Floats, random_pose
from tests.kernels.workspace import same

LENGTHS = ("mount", "unit", "margin")
FIELDS = (*LENGTHS, "position_tolerance", "angle_tolerance", "look_depth", "step_depth", "avoids_itself")


@entry
def take_apart(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    parts: tuple[Array, Array, Array, Array, Array, Array, Array],
    numbers: Array,
) -> None:
    """Copy what a kernel reads of a problem, and its numbers in the order of `FIELDS`."""
    problem = read_problem(robot, scene, settings, targets)
    limits, actuation, base, tool, table, store, rows = parts
    same(problem.limits, limits)
    same(problem.actuation, actuation)
    same(problem.base, base)
    same(problem.tool, tool)
    same(problem.scene.table, table)
    same(problem.scene.store, store)
    same(problem.targets, rows)
    numbers[0], numbers[1], numbers[2] = problem.mount, problem.unit, problem.margin
    numbers[3], numbers[4] = problem.position_tolerance, problem.angle_tolerance
    numbers[5], numbers[6], numbers[7] = problem.look_depth, problem.step_depth, 1.0 if problem.avoids_itself else 0.0


def read(robot: Robot, scene: Scene, targets: Any, settings: Floats) -> tuple[tuple[Floats, ...], dict[str, float]]:
    rows = target_table(robot, tuple(targets)).copy()
    table, store = packing.scene_parts(scene.group.copy())
    shapes = [
        (len(robot), t.SEGMENT_WIDTH),
        (len(robot.actuation), 7),
        (1, 12),
        (1, 12),
        table.shape,
        store.shape,
        rows.shape,
    ]
    parts: Any = tuple(np.full(shape, np.nan) for shape in shapes)
    numbers = np.full(len(FIELDS), np.nan)
    take_apart(robot_group(robot), scene.group.copy(), settings, rows, parts, numbers)
    return parts, dict(zip(FIELDS, numbers.tolist(), strict=True))


lengths = st.tuples(st.floats(0.1, 5.0), st.floats(0.0, 2.0)).map(lambda pair: (pair[0], pair[0] + pair[1]))
limits = st.floats(0.01, 1.0).map(lambda most: (-most, 2.0 * most))
tendons = st.none() | st.builds(
    lambda lines, own: Tendons(lines, 0.05, 0.1, displacement=own), st.integers(1, 4), limits
)
chambers = st.none() | st.builds(lambda lines: Chambers(lines, 0.1, length=(0.05, 9.0)), st.integers(2, 4))
curvatures = st.none() | st.floats(0.1, 9.0)
segments = st.builds(Segment, lengths, st.floats(0.0, 7.0), curvatures, st.floats(0.0, 0.1), tendons, chambers)
seeds = st.integers(0, 10**6)
robots = st.builds(
    lambda own, seed, mount: Robot(
        own,
        mount=mount,
        base=random_pose(np.random.default_rng(seed)),
        tool=random_pose(np.random.default_rng(seed + 1)),
    ),
    st.lists(segments, min_size=1, max_size=6),
    seeds,
    st.floats(0.0, 1.0),
)
points = st.tuples(*[st.floats(-9.0, 9.0)] * 3)
sizes = st.floats(0.01, 3.0)
obstacles = st.one_of(
    st.builds(Sphere, points, sizes, st.booleans()),
    st.builds(lambda p, size, inside: Box(p, size, inside=inside), points, st.tuples(*[sizes] * 3), st.booleans()),
    st.builds(lambda p, r: Capsule(p, (p[0], p[1], p[2] + 1.0), r), points, sizes),
    st.builds(lambda p, r: Cylinder(p, (p[0] + 1.0, p[1], p[2]), r), points, sizes),
    st.builds(lambda p: HalfSpace(p, (0.0, 1.0, 1.0)), points),
)


@given(robots)
def test_a_robot_is_read_back(robot: Robot) -> None:
    parts, numbers = read(robot, Scene(), [Target((0, 0, 1))], settings_group(robot, Tolerance(1e-3)))
    own, actuation, base, tool = parts[:4]
    for row, segment, curvature in zip(own, robot.segments, robot.curvatures, strict=True):
        assert (row[t.MIN_LENGTH], row[t.MAX_LENGTH]) == segment.length
        assert row[t.MAX_CURVATURE] == curvature
        assert row[t.RADIUS] == row[t.SELF_RADIUS] == segment.radius
        moves = segment.max_bend > 0.0
        assert row[t.MAX_BEND] == (segment.max_bend if moves else 0.0)
        assert row[t.BEND_SCALE] == float(moves)
        fixed = segment.length[0] == segment.length[1]
        assert row[t.LENGTH_SCALE] == (0.0 if fixed else 0.5 * sum(segment.length))
    np.testing.assert_array_equal(own, robot.limits)
    np.testing.assert_array_equal(actuation, robot.actuation)
    for pose, matrix in ((base, robot.base), (tool, robot.tool)):
        np.testing.assert_array_equal(pose[0, : t.POSE_POSITION].reshape(3, 3), matrix[:3, :3])
        np.testing.assert_array_equal(pose[0, t.POSE_POSITION :], matrix[:3, 3])
    assert numbers["mount"] == robot.mount
    assert numbers["unit"] == robot.mean_length


@given(robots, seeds)
def test_limits_of_actuators_say_what_their_lines_do(robot: Robot, seed: int) -> None:
    q = np.random.default_rng(seed).normal(size=(len(robot), 3))
    seen = []
    for row in robot.actuation:
        first, last = int(row[t.FIRST_SEGMENT]), int(row[t.LAST_SEGMENT])
        seen.append(q[first : last + 1].sum(axis=0) @ row[t.WEIGHTS : t.WEIGHTS + 3])
    limited = np.array([math.isfinite(sum(map(abs, each.limits))) for each in robot.actuators], bool)
    np.testing.assert_allclose(seen, robot.to_actuators(q)[limited], atol=1e-12)
    assert list(robot.actuation[:, t.LAST_SEGMENT]) == sorted(robot.actuation[:, t.LAST_SEGMENT])


def read_scene(drawn: list[Any]) -> tuple[Floats, Floats]:
    robot = Robot.uniform(2, 1.0)
    parts, _ = read(robot, Scene(drawn), [Target((0, 0, 1))], settings_group(robot, Tolerance(1e-3)))
    return parts[4], parts[5]


@given(st.lists(obstacles, max_size=5))
def test_a_scene_is_read_back(drawn: list[Any]) -> None:
    table, _ = read_scene(drawn)
    assert table.shape == (len(drawn), t.OBSTACLE_WIDTH)
    for row, obstacle in zip(table, drawn, strict=True):
        assert row[t.SIGN] == (-1.0 if getattr(obstacle, "inside", False) else 1.0)
        np.testing.assert_array_equal(row, packing.scene_parts(Scene([obstacle]).group)[0][0])
        if isinstance(obstacle, Sphere):
            np.testing.assert_array_equal(row[t.CENTER : t.CENTER + 3], obstacle.center)
            assert (row[t.KIND], row[t.ROUNDING]) == (t.SPHERE, obstacle.radius)


def test_a_row_points_to_its_own_part_of_the_store() -> None:
    rng = np.random.default_rng(0)
    clouds = [PointCloud(rng.normal(size=(count, 3)), 0.1) for count in (1, 5, 30)]
    table, store = read_scene([clouds[0], Sphere((0, 0, 9), 1.0), clouds[1], clouds[2]])
    for row, cloud in zip(table[[0, 2, 3]], clouds, strict=True):
        assert (row[t.KIND], row[t.ITEM_KIND]) == (t.TREE, t.BALLS)
        first, count = int(row[t.ITEMS]), int(row[t.COUNT])
        balls = store[first : first + count * t.BALL_SIZE].reshape(-1, t.BALL_SIZE)
        np.testing.assert_array_equal(np.unique(balls[:, :3], axis=0), np.unique(cloud.points, axis=0))
        assert (balls[:, 3] == 0.1).all()


directions = points.filter(lambda p: math.hypot(*p) > 1e-3)
targets = st.one_of(
    st.builds(lambda p, k: Target(p, segment=k), points, st.sampled_from([None, 1, 2, 3])),
    st.builds(lambda p, d, k: Target(p, direction=d, segment=k), points, directions, st.sampled_from([None, 2])),
    st.builds(lambda d: Target(direction=d), directions),
    st.builds(
        lambda p, seed: Target(p, rotation=random_pose(np.random.default_rng(seed))[:3, :3]), st.none() | points, seeds
    ),
)


@given(st.lists(targets, min_size=1, max_size=5))
def test_targets_are_read_back(drawn: list[Target]) -> None:
    robot = Robot.uniform(3, 1.0)
    parts, _ = read(robot, Scene(), drawn, settings_group(robot, Tolerance(1e-3)))
    for row, target in zip(parts[6], drawn, strict=True):
        assert row[t.TARGET_SEGMENT] == (-1 if target.segment is None else target.segment - 1)
        assert row[t.HAS_POSITION] == (target.position is not None)
        if target.position is not None:
            np.testing.assert_array_equal(row[t.TARGET_POSITION : t.TARGET_POSITION + 3], target.position)
        if target.rotation is not None:
            assert row[t.ORIENTATION] == t.ROTATION
            np.testing.assert_array_equal(row[t.GOAL : t.GOAL + 9].reshape(3, 3), target.rotation)
        elif target.direction is not None:
            assert row[t.ORIENTATION] == t.DIRECTION
            np.testing.assert_array_equal(row[t.GOAL : t.GOAL + 3], target.direction)
        else:
            assert row[t.ORIENTATION] == t.FREE


@given(robots, st.tuples(*[st.floats(1e-6, 1.0)] * 5), st.lists(st.floats(-9.0, 9.0), max_size=4))
def test_settings_are_read_back(robot: Robot, values: tuple[float, ...], options: list[float]) -> None:
    off, turn, initial, bends, clearance = values
    wishes = Preferences(initial, bends, clearance)
    settings = settings_group(robot, Tolerance(off, turn), wishes, options)
    _, numbers = read(robot, Scene(), [Target((0, 0, 1))], settings)
    assert numbers == {
        "mount": robot.mount,
        "unit": robot.mean_length,
        "margin": packing.MARGIN * robot.mean_length,
        "position_tolerance": off,
        "angle_tolerance": turn,
        "look_depth": packing.LOOK_DEPTH,
        "step_depth": packing.STEP_DEPTH,
        "avoids_itself": float(robot.avoids_itself),
    }
    assert settings[t.MAX_ITERATIONS] == packing.ITERATIONS
    assert tuple(settings[[t.INITIAL_WEIGHT, t.BENDS_WEIGHT, t.WISHED_CLEARANCE]]) == (initial, bends, clearance)
    assert list(settings[t.METHOD_OPTIONS :]) == options


@entry
def copy_answer(answers: Array, i: int, q: Array, record: Array) -> None:
    """Copy one answer of a batch."""
    own, said = answer_of(answers, i, q.shape[0])
    same(own, q)
    same(said, record)


@given(st.integers(1, 6), st.integers(1, 5), seeds)
def test_answers_of_a_batch_are_read_back(n: int, count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    answers = rng.normal(size=(count, t.answer_size(n)))
    q, record = np.empty((n, 3)), np.empty(t.RECORD_WIDTH)
    for i in range(count):
        copy_answer(answers, i, q, record)
        np.testing.assert_array_equal(np.concatenate([record, q.ravel()]), answers[i])


def test_a_record_is_an_outcome_in_the_order_of_its_columns() -> None:
    record = [float(i) for i in range(t.RECORD_WIDTH)]
    outcome = t.Outcome.from_record(np.zeros((1, 3)), record)
    columns = {name: getattr(t, name.upper()) for name in outcome._fields if name not in ("q", "cell", "route")}
    assert sorted(columns.values()) == list(range(t.RECORD_WIDTH))
    for name, column in columns.items():
        assert float(getattr(outcome, name)) == (1.0 if name == "bound" else record[column])
    assert math.isnan(outcome.cell)
    assert outcome.route is None
    assert isinstance(outcome.code, int)
