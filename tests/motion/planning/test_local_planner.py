"""Ends of plans with room around them: what is in contact is eased, by a motion that is proved clear."""

import numpy as np
import pytest

from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.motions import wrong_in
from sinuous.kernels import tables
from sinuous.model.joints import Revolute
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.motion.planning.local_planner import ENOUGH, LOOSE, QueryEnds, with_radii
from sinuous.motion.planning.rrt_connect import RRTConnect, rrt_connect
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, query

RADIUS = 0.1
TOUCHING = 1e-5


def ball(q: Floats, gap: float) -> Sphere:
    """A ball beside the end of the third segment."""
    place = ROBOT.forward(q)[2]
    return Sphere(place[:3, 3] + (0.3 + RADIUS + gap) * place[:3, 0], 0.3)


@pytest.mark.parametrize("gap", [TOUCHING, 1e-3])
def test_what_is_near_to_contact_gets_room_by_a_clear_motion(gap: float) -> None:
    scene = Scene([ball(INSIDE, gap)])
    chain = QueryEnds(query(scene, OUTSIDE, INSIDE)).with_clearance(INSIDE)
    assert len(chain) == 2
    np.testing.assert_array_equal(chain[0], INSIDE)
    assert wrong_in(ROBOT, scene, np.stack(chain)) == ""
    before, after = least_clearance(ROBOT, scene, np.stack(chain))
    assert before < 1.1 * gap
    assert after > ENOUGH * RADIUS
    tips = ROBOT.forward(np.stack(chain))[:, -1, :3, 3]
    assert np.linalg.norm(tips[1] - tips[0]) <= LOOSE * RADIUS * 1.001


def test_trees_leave_contact_in_the_second_round() -> None:
    start = INSIDE * [-1.0, -1.0, 1.0]
    scene = Scene([ball(INSIDE, TOUCHING), ball(start, TOUCHING)])
    asked = query(scene, start, INSIDE)
    paths = rrt_connect(asked, QueryEnds(asked), RRTConnect(ROBOT, scene.snapshot()))
    path = next(path for path in (next(paths) for _ in range(4)) if path is not None)
    np.testing.assert_array_equal(path.q[[0, -1]], [start, INSIDE])
    assert wrong_in(ROBOT, scene, path.q) == ""


def test_thicker_robots_have_thicker_links_too() -> None:
    bodies = [[((0.0, 0.0, 0.1), (0.0, 0.0, 0.3), 0.04)], []]
    robot = Robot([Segment(0.2, 1.0, radius=0.02)], joints=[Revolute((0.0, 0.0, 1.0), body=body) for body in bodies])
    thicker = with_radii(robot, 1.5)
    solid = robot.limits[:, tables.RADIUS] >= 0.0
    assert robot.limits[solid, tables.RIGID].tolist() == [tables.LINK, 0.0]
    np.testing.assert_allclose(thicker.limits[solid, tables.RADIUS], 1.5 * robot.limits[solid, tables.RADIUS])
    np.testing.assert_array_equal(thicker.limits[~solid], robot.limits[~solid])
