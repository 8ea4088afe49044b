"""Workspaces of plans: each in one pair of hands, and only for the scene that it was made for."""

import pickle

import numpy as np

import sinuous as sn
from sinuous.motion.planning.workspaces import Workspaces
from sinuous.scene.scene import Scene

ROBOT = sn.Robot([sn.Segment(1.0, 2.0, radius=0.05)] * 3)
BALL = [sn.Sphere((1.0, 0.0, 1.0), 0.2)]


def test_what_was_given_back_is_taken_again() -> None:
    scene, kept = Scene(BALL).snapshot(), Workspaces(ROBOT)
    one, other = kept.take(scene), kept.take(scene)
    assert one.trees is not other.trees
    assert one.prover is not other.prover
    kept.give_back(one)
    assert kept.take(scene) is one
    assert kept.take(scene) is not one


def test_another_scene_has_another_workspace() -> None:
    scene, kept = Scene(BALL).snapshot(), Workspaces(ROBOT)
    kept.give_back(kept.take(scene))
    changed = Scene([*BALL, sn.Sphere((0.0, 2.0, 1.0), 0.2)]).snapshot()
    work = kept.take(changed)
    assert work.scene is changed
    assert work.prover.scene is changed
    way = work.trees.grow(np.tile([0.0, 0.0, 1.0], (2, 3, 1)), 0, (0, 1), 1.0)
    assert way is not None


def test_memory_is_not_sent_along() -> None:
    kept = Workspaces(ROBOT)
    kept.give_back(kept.take(Scene(BALL).snapshot()))
    again = pickle.loads(pickle.dumps(kept))
    assert len(pickle.dumps(again)) < 10_000
    assert again.take(Scene(BALL).snapshot()) is not None
