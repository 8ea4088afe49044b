"""Plans into places: from another shape that is clear, and judged."""

import numpy as np

from benchmarks.judges.clearances import least_clearance
from benchmarks.motion.places.into import AWAY, OTHER, STRAIGHT, Task, elsewhere, examine
from benchmarks.places import make


def test_another_shape_is_clear_and_its_tip_away_from_the_hidden_one() -> None:
    place = make("bore", 0)
    q = elsewhere(place)
    assert q is not None
    assert least_clearance(place.robot, place.scene, q[None], 0.0)[0] > 0.0
    far = float(np.linalg.norm(place.robot.tip(q)[:3, 3] - place.robot.tip(place.hidden_q)[:3, 3]))
    assert AWAY[0] * 0.99 < far / place.robot.mean_length < AWAY[1] * 1.01


def test_plans_into_a_bore_are_found_from_both_starts() -> None:
    for begin in (STRAIGHT, OTHER):
        trial = examine(Task("bore", 7, begin))
        assert trial.begins
        assert trial.good
