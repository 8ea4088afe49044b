"""Ends of plans with room around them: what is in contact is eased, by a motion that is proved clear."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.motions import wrong_in
from sinuous.motion.planning.local_planner import ENOUGH, LOOSE, QueryEnds
from sinuous.motion.planning.rrt_connect import RRTConnect, _joined, rrt_connect
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import HALF, INSIDE, OUTSIDE, ROBOT, bore, query

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


def test_what_has_room_is_left_alone() -> None:
    scene = Scene([ball(INSIDE, 0.5 * RADIUS)])
    ends = QueryEnds(query(scene, OUTSIDE, INSIDE))
    assert [len(chain) for chain in (ends.with_clearance(INSIDE), ends.start, *ends.goals(OUTSIDE[None]))] == [1, 1, 1]


def test_what_cannot_have_room_is_left_alone() -> None:
    """The last segment just fits into a bore that is 1e-4 wider than the body."""
    assert HALF > RADIUS
    around = [ball(INSIDE, 1e-4)]
    place = ROBOT.forward(INSIDE)[2]
    turned = place.copy()
    for k in (1, 2, 3):
        turn = np.pi / 2 * k
        turned[:3, 0] = np.cos(turn) * place[:3, 0] + np.sin(turn) * place[:3, 1]
        around.append(Sphere(place[:3, 3] + (0.3 + RADIUS + 1e-4) * turned[:3, 0], 0.3))
    fixed = sn.Robot([segment.changed(max_bend=1.0) for segment in ROBOT.segments], base=ROBOT.base)
    scene = Scene(around)
    for q in QueryEnds(query(scene, robot=fixed)).with_clearance(INSIDE)[1:]:
        assert least_clearance(fixed, scene, q[None])[0] > 1e-4


def test_paths_lead_on_from_ends_with_room_into_the_ends_themselves() -> None:
    scene = Scene([ball(INSIDE, TOUCHING), ball(OUTSIDE, TOUCHING), *bore()])
    asked = query(scene, OUTSIDE, INSIDE)
    ends, trees = QueryEnds(asked), RRTConnect(ROBOT, scene.snapshot())
    path = _joined(asked, ends, trees, [ends.start], 0, (0, 0, 64))
    assert path is not None
    np.testing.assert_array_equal(path.q[[0, -1]], [OUTSIDE, OUTSIDE])
    assert wrong_in(ROBOT, scene, path.q) == ""


def test_trees_leave_contact_in_the_second_round() -> None:
    start = INSIDE * [-1.0, -1.0, 1.0]
    scene = Scene([ball(INSIDE, TOUCHING), ball(start, TOUCHING)])
    asked = query(scene, start, INSIDE)
    paths = rrt_connect(asked, QueryEnds(asked), RRTConnect(ROBOT, scene.snapshot()))
    path = next(path for path in (next(paths) for _ in range(4)) if path is not None)
    np.testing.assert_array_equal(path.q[[0, -1]], [start, INSIDE])
    assert wrong_in(ROBOT, scene, path.q) == ""
