"""Curves of configurations and routes: drawn tight beyond the mount, and compared."""

import numpy as np
import pytest

from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.solver.route_classes.curves import RouteCurves
from tests.helpers import Floats
from tests.solver.route_classes.places import ROBOT, ball, pillar


def curves(scene: Scene, robot: Robot = ROBOT) -> RouteCurves:
    return RouteCurves(robot, scene.snapshot())


def shapes(robot: Robot, count: int, seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    bends = rng.uniform(-1.0, 1.0, (count, len(robot), 2))
    return np.concatenate([bends, np.full((count, len(robot), 1), 50.0)], axis=2)


def arch(angle: float, radius: float = 60.0) -> Floats:
    """A route past the ball, on this side of it."""
    side = np.array([np.cos(angle), np.sin(angle), 0.0])
    heights = np.linspace(0.0, 250.0, 100)
    return np.asarray(np.outer(np.sin(np.pi * heights / 250.0) * radius, side) + np.outer(heights, (0.0, 0.0, 1.0)))


def test_in_the_open_a_curve_is_the_straight_line_beyond_the_mount() -> None:
    scene = Scene([Sphere((900.0, 0.0, 0.0), 1.0)])
    robot = ROBOT.changed(mount=35.0)
    for q in shapes(robot, 5, 0):
        curve = curves(scene, robot).of(q)
        line = robot.backbone(q, 200)
        gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        start = line[int(np.searchsorted(gone, 35.0))]
        np.testing.assert_allclose(curve[0], start, atol=1.0)
        np.testing.assert_allclose(curve, np.linspace(curve[0], line[-1], len(curve)), atol=1e-6)


def test_a_route_and_itself_the_other_way_are_alike_just_on_one_side() -> None:
    own = curves(Scene(pillar()))
    left, right, wide = (own.along(arch(angle, r)) for angle, r in ((0.0, 60.0), (np.pi, 60.0), (0.4, 90.0)))
    assert own.alike(left, wide)
    assert not own.alike(left, right)
    assert own.alike_one(wide, [right, left]) == 1
    assert own.alike_one(wide, [right]) is None
    assert own.alike_one(wide, []) is None


def test_round_a_ball_neighbours_are_alike_and_opposites_are_not() -> None:
    own = curves(Scene(ball()))
    first = own.along(arch(0.0))
    alike = [own.alike(first, own.along(arch(angle))) for angle in np.linspace(0.0, np.pi, 13)]
    assert alike == sorted(alike, reverse=True)
    assert alike[3]
    assert not alike[-1]


def test_what_is_between() -> None:
    own = curves(Scene([*ball(), Sphere((0.0, 0.0, 900.0), 1.0)]))
    left, right = (own.along(arch(angle)) for angle in (0.0, np.pi))
    assert set(own.between(left, right).tolist()) == {-1, 0}
    assert set(own.between(left, left).tolist()) == {-1}


@pytest.mark.parametrize("radius", [0.0, 4.0])
def test_a_body_longer_than_its_mount_is_not_needed(radius: float) -> None:
    robot = Robot.uniform(2, (40.0, 60.0), radius=radius, mount=500.0)
    own = curves(Scene(ball()), robot)
    q = shapes(robot, 1, 1)[0]
    assert own.alike(own.of(q), own.of(q))
