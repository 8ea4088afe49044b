"""Workspaces of plans: each is lent to one plan at a time, and only for the scene that it was made for."""

import pickle

import numpy as np

import sinuous as sn
from sinuous.motion.plan import Workspaces
from sinuous.motion.planning.query import Deadline
from sinuous.scene.scene import Scene

ROBOT = sn.Robot([sn.Segment(1.0, 2.0, radius=0.05)] * 3)
BALL = [sn.Sphere((1.0, 0.0, 1.0), 0.2)]


def test_what_was_given_back_is_lent_again() -> None:
    scene, kept = Scene(BALL).snapshot(), Workspaces(ROBOT)
    with kept.lent(scene) as one, kept.lent(scene) as other:
        assert one.trees is not other.trees
        assert one.prover is not other.prover
    with kept.lent(scene) as first, kept.lent(scene) as second, kept.lent(scene) as third:
        assert {id(first), id(second)} == {id(one), id(other)}
        assert third not in (one, other)


def test_another_scene_has_another_workspace() -> None:
    scene, kept = Scene(BALL).snapshot(), Workspaces(ROBOT)
    with kept.lent(scene):
        pass
    changed = Scene([*BALL, sn.Sphere((0.0, 2.0, 1.0), 0.2)]).snapshot()
    with kept.lent(changed) as work:
        assert work.scene is changed
        assert work.prover.scene is changed
        still = np.tile([0.0, 0.0, 1.0], (2, 3, 1))
        assert work.trees.grow(still, 0, (0, 1), Deadline(1.0)) is not None


def test_memory_is_not_sent_along() -> None:
    kept = Workspaces(ROBOT)
    with kept.lent(Scene(BALL).snapshot()):
        pass
    again = pickle.loads(pickle.dumps(kept))
    assert len(pickle.dumps(again)) < 10_000
    with again.lent(Scene(BALL).snapshot()) as work:
        assert work is not None
