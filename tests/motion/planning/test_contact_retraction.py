"""Contact-retraction trees: past what stops a straight edge, by motions that are clear."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.motions import wrong_in
from benchmarks.motion.known import make
from sinuous.motion.planning import contact_retraction
from sinuous.motion.planning.contact_retraction import ContactRetractionTrees
from sinuous.motion.planning.local_planner import LocalPlanner
from sinuous.motion.planning.retraction import Retraction
from sinuous.motion.planning.tree import Chain, Tree
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore, query

LEFT: Floats = np.array([[0.25, 0.0, 1.0]] * 5)
RIGHT: Floats = LEFT * [-1.0, 1.0, 1.0]
BALL = sn.Sphere([0.0, 0.15, 3.0], 0.4)
"""Between both, a little beside the middle of the way."""


def grow(scene: Scene, seed: int = 0, seconds: float = 60.0) -> Chain | None:
    """The path into a bore that trees find from how far its goal can be drawn back."""
    local = LocalPlanner(query(scene, seconds=seconds))
    drawn_back = Retraction(local, INSIDE, 0, OUTSIDE)
    drawn_back.run()
    trees = ContactRetractionTrees(local, seed)
    trees.plant(0, [[OUTSIDE]])
    trees.plant(1, [drawn_back.knots])
    return trees.grow(200)


def test_an_edge_goes_on_beside_what_stops_it() -> None:
    scene = Scene([BALL])
    straight = np.stack([LEFT, RIGHT])
    assert wrong_in(ROBOT, scene, straight[:1]) == wrong_in(ROBOT, scene, straight[1:]) == ""
    assert wrong_in(ROBOT, scene, straight) == "overlap"
    tree = Tree(ROBOT)
    tree.plant([LEFT])
    node, there = ContactRetractionTrees(LocalPlanner(query(scene, LEFT, RIGHT)), 0)._connect(
        tree, 0, RIGHT, np.inf, 0.05
    )
    assert there
    path = np.stack(tree.chain(node))
    np.testing.assert_array_equal(path[[0, -1]], straight)
    assert wrong_in(ROBOT, scene, path) == ""


def test_the_path_is_clear_and_the_same_each_time() -> None:
    scene = Scene(bore())
    one, other = grow(scene), grow(scene)
    assert one is not None
    np.testing.assert_array_equal(np.stack(one)[[0, -1]], [OUTSIDE, INSIDE])
    assert wrong_in(ROBOT, scene, np.stack(one)) == ""
    np.testing.assert_array_equal(one, other)


def test_all_that_is_in_a_tree_is_clear() -> None:
    scene = Scene(bore())
    trees = ContactRetractionTrees(LocalPlanner(query(scene)), 3)
    trees.plant(0, [[OUTSIDE]])
    trees.plant(1, [[INSIDE]])
    trees.grow(12)
    for tree in trees._trees:
        for node in range(1, len(tree)):
            assert wrong_in(ROBOT, scene, np.stack(tree.chain(node)[-2:])) == ""


def test_trees_that_are_large_are_planted_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(bore())
    monkeypatch.setattr(contact_retraction, "MOST_NODES", 30)
    trees = ContactRetractionTrees(LocalPlanner(query(scene)), 0)
    trees.plant(0, [[OUTSIDE]])
    trees.plant(1, [[INSIDE]])
    trees.grow(40)
    for tree, end in zip(trees._trees, (OUTSIDE, INSIDE), strict=True):
        assert len(tree) < 100
        np.testing.assert_array_equal(tree.chain(len(tree) - 1)[0], end)


def test_without_time_there_is_none() -> None:
    assert grow(Scene(bore()), seconds=0.0) is None


def test_a_fold_becomes_another_fold() -> None:
    """Retractions and straight edges alone need longer here than anybody waits."""
    place = make("folded", 12)
    motion = sn.plan(place.robot, place.knots[0], place.knots[-1], place.scene, time=60.0)
    assert motion.solved
    assert wrong_in(place.robot, place.scene, motion.q) == ""
