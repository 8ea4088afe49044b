"""Ends of plans with room around them: what is in contact is eased, by a motion that is proved clear."""

import numpy as np
import pytest

from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.motions import wrong_in
from sinuous.motion.planning.local_planner import ENOUGH, LOOSE, QueryEnds
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
