"""Hidden shapes keep their limits, and a distance from themselves."""

import numpy as np

import sinuous as sn
from benchmarks.judges.judge import within_limits
from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import arc, curve_of, draw_shape
from tests.cases import with_each


@with_each("seed", range(20))
def test_shapes_keep_apart_and_within_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = robot_of(seed, rng)
    apart = 6.0 * min(robot.radii)
    q = draw_shape(robot, apart, rng)
    assert within_limits(robot, q[None]).all()
    curve = curve_of(robot, q, 10)
    gaps = np.linalg.norm(curve.points[:, None] - curve.points, axis=-1)
    far = np.abs(curve.along[:, None] - curve.along) > 0.5 * np.pi * apart + 1e-9
    assert gaps[far].min(initial=np.inf) > apart


def test_curves_are_those_of_the_robot() -> None:
    robot = sn.Robot.uniform(4, (0.5, 1.0), 2.5, base=sn.pose((1, 2, 3), direction=(0, 1, 1)))
    q = draw_shape(robot, 0.1, np.random.default_rng(1))
    curve = curve_of(robot, q, 7)
    np.testing.assert_allclose(curve.points, robot.backbone(q, 7), atol=1e-12)
    np.testing.assert_allclose(curve.along[-1], q[:, 2].sum())
    np.testing.assert_allclose(curve.tangents[-1], robot.tip(q)[:3, 2], atol=1e-12)


def test_an_arc_begins_where_it_is_put() -> None:
    start = sn.pose((1, 2, 3), direction=(1, 0, 0))
    poses = arc(start, np.array([0.0, 0.0, 2.0]), 4)
    np.testing.assert_allclose(poses[0], start, atol=1e-15)
    np.testing.assert_allclose(poses[-1, :3, 3], [3, 2, 3], atol=1e-15)


def test_shapes_that_go_ahead_never_turn_back() -> None:
    rng = np.random.default_rng(0)
    robot = robot_of(3, rng)
    for _ in range(5):
        curve = curve_of(robot, draw_shape(robot, 0.1, rng, 0.3), 10)
        assert (curve.tangents @ robot.base[:3, 2]).min() >= 0.3 - 1e-12
