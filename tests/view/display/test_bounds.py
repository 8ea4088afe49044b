"""What must be seen is within the bounds, and obstacles far away do not make it small."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.bounds import best_view, bounds_of, direction_of, find_hidden, seen_places
from sinuous.view.display.contents import gather
from tests.helpers import random_pose

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, base=random_pose(np.random.default_rng(3)))
Q = np.array([[0.8, 0.3, 1.0], [-0.6, 0.5, 1.1], [0.4, -0.9, 0.9]])


def test_bodies_targets_and_motions_are_within_the_bounds() -> None:
    target = sn.Target((3, 3, 3), direction=(0, 0, 1))
    motion = sn.Motion(ROBOT, [Q, 0.5 * Q + [0.0, 0.0, 0.5]])
    bounds = bounds_of(gather([motion, target]))
    seen = np.concatenate([ROBOT.backbone(motion.q).reshape(-1, 3), [(3, 3, 3)]])
    assert (seen >= bounds.low).all()
    assert (seen <= bounds.high).all()


def test_only_what_is_near_of_obstacles_counts() -> None:
    alone = bounds_of(gather([ROBOT, Q]))
    far = [
        sn.Sphere(alone.middle + 50.0, 1.0),
        sn.HalfSpace(alone.low - 99.0, (0, 0, 1)),
        sn.PointCloud([[90, 0, 0]], 1),
    ]
    np.testing.assert_array_equal(bounds_of(gather([ROBOT, Q, *far])), alone)
    beside = sn.Sphere((*alone.high[:2], alone.middle[2]), 0.05)
    assert (bounds_of(gather([ROBOT, Q, beside])).high[:2] >= beside.center[:2] + 0.05 - 1e-12).all()
    around = bounds_of(gather([ROBOT, Q, sn.Sphere((0, 0, 0), 1e3, inside=True)]))
    assert around.span < 2.0 * alone.span


def test_the_view_is_across_the_plane_that_the_robot_reaches_out_in() -> None:
    robot = sn.Robot.uniform(1, 1.0, max_bend=2)
    for angle in (0.0, 1.0, -2.0):
        q = np.array([[np.cos(angle), np.sin(angle), 1.0]])
        reach = robot.tip(q)[:2, 3] / np.linalg.norm(robot.tip(q)[:2, 3])
        side = direction_of(best_view(gather([robot, q])))
        assert side[2] > 0.0
        assert 0.3 < abs(float(side[:2] @ reach)) < 0.5


def test_the_view_begins_where_the_robot_is_hidden_least() -> None:
    robot = sn.Robot.uniform(2, 1.0, max_bend=2)
    q = np.array([[0.5, 0.0, 1.0], [0.5, 0.0, 1.0]])
    alone = direction_of(best_view(gather([robot, q])))
    place = 0.7 * alone * np.array([1, 1, 0]) + [0.3, 0, 1], (0.4, 0.4, 4)
    pillar, room = sn.Box(*place), sn.Box(*place, inside=True)
    contents = gather([robot, q, pillar])
    seen, middle = seen_places(contents), bounds_of(contents).middle
    assert find_hidden([pillar], seen, (middle + 9 * alone)[None]).mean() > 0.3
    assert find_hidden([pillar], seen, (middle + 9 * direction_of(best_view(contents)))[None]).mean() < 0.05
    np.testing.assert_array_equal(direction_of(best_view(gather([robot, q, room]))), alone)


RNG = np.random.default_rng(0)
SOLIDS: list[Obstacle] = [
    sn.Sphere((0.2, 0.1, 0), 0.4),
    sn.Box((0, 0.3, 0.1), (0.5, 0.9, 0.3), rotation=(1, 2, 3, 4)),
    sn.HalfSpace((0, 0, -0.3), (0.3, 0.2, 1)),
]
"""Those that are not looked at by the box around them."""


def meets(obstacle: Obstacle, begin: np.ndarray, end: np.ndarray) -> bool:
    """Whether a line meets an obstacle, by many places on it."""
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    return bool((sn.Scene([obstacle]).distance((1.0 - share) * begin + share * end) < 0.0).any())


@pytest.mark.parametrize("obstacle", SOLIDS, ids=lambda obstacle: obstacle.kind)
def test_lines_of_sight_meet_what_is_on_them(obstacle: Obstacle) -> None:
    points, eyes = RNG.uniform(-1, 1, (12, 3)), RNG.uniform(-2, 2, (6, 3))
    points = points[sn.Scene([obstacle]).distance(points) > 0.0]
    found = find_hidden([obstacle], points, eyes)[0]
    expected = [[meets(obstacle, point, eye) for point in points] for eye in eyes]
    assert 0 < found.sum() < found.size
    assert (found == expected).mean() > 0.95  # lines that graze an edge
