"""Contact-retraction trees: past what stops a straight edge, by motions that are clear."""

import numpy as np

from benchmarks.judges.motions import wrong_in
from sinuous.motion.planning.contact_retraction import ContactRetractionTrees
from sinuous.motion.planning.local_planner import LocalPlanner
from sinuous.motion.planning.retraction import Retraction
from sinuous.motion.planning.tree import Chain
from sinuous.scene.scene import Scene
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore, query


def grow(scene: Scene, seed: int = 0, seconds: float = 60.0) -> Chain | None:
    """The path into a bore that trees find from how far its goal can be drawn back."""
    local = LocalPlanner(query(scene, seconds=seconds))
    drawn_back = Retraction(local, INSIDE, 0, OUTSIDE)
    drawn_back.run()
    trees = ContactRetractionTrees(local, seed)
    trees.plant(0, [[OUTSIDE]])
    trees.plant(1, [drawn_back.knots])
    return trees.grow(200)


def test_the_path_is_clear_and_the_same_each_time() -> None:
    scene = Scene(bore())
    one, other = grow(scene), grow(scene)
    assert one is not None
    np.testing.assert_array_equal(np.stack(one)[[0, -1]], [OUTSIDE, INSIDE])
    assert wrong_in(ROBOT, scene, np.stack(one)) == ""
    np.testing.assert_array_equal(one, other)
