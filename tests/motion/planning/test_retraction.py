"""Retraction: bodies drawn back along themselves, out of bores, by motions that are clear; and paths through them.

Contact-retraction trees: past what stops a straight edge, by motions that are clear.
"""

from itertools import islice

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.judge import wrong_in
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.motion.planning.contact_retraction import ContactRetractionTrees
from sinuous.motion.planning.local_planner import LocalPlanner
from sinuous.motion.planning.planners import PlanSearch
from sinuous.motion.planning.retraction import ENOUGH, KINDS, LONGEST, Retraction, sliding
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.motion.planning.tree import Chain
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore, query

OTHER = -INSIDE * [1.0, 1.0, -1.0]
"""The mirror image: turned half about the base's axis."""


def draw_back(
    scene: sn.Scene, q: Floats, kind: int, seconds: float = 60.0, robot: sn.Robot = ROBOT, other: Floats = OUTSIDE
) -> Floats:
    made = Retraction(LocalPlanner(query(scene, OUTSIDE, q, seconds, robot)), q, kind, other)
    assert made.run()
    return np.stack(made.knots)


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_it_leads_out_of_a_bore(kind: int) -> None:
    scene = sn.Scene(bore())
    knots = draw_back(scene, INSIDE, kind)
    np.testing.assert_array_equal(knots[0], INSIDE)
    assert wrong_in(ROBOT, scene, knots) == ""
    curve = sn.Curve(ROBOT.backbone(INSIDE, 40))
    tips = ROBOT.forward(knots)[:, -1, :3, 3]
    assert curve.distance(tips).max() < 1e-3 * ROBOT.mean_length
    gone = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    assert gone.max() <= LONGEST + 1e-3  # each segment has a length of 1; and a tolerance at either end
    assert gone.sum() > 1.5  # the bore is 0.55 deep in front of the tip
    assert np.linalg.norm(tips[-1] - ROBOT.base[:3, 3]) > ENOUGH


def test_sliding_back_is_the_least_that_the_ends_are_off() -> None:
    by, n = 1e-3, len(ROBOT)
    weights = np.arange(1, n + 1) / n
    ends = ROBOT.forward(INSIDE)[-n:]
    asked = ends[:, :3, 3] - by * ends[:, :3, 2]

    def off(q: Floats) -> float:
        return float(np.linalg.norm(weights[:, None] * (ROBOT.forward(q)[-n:, :3, 3] - asked)))

    back = INSIDE + by * sliding(ROBOT, INSIDE, weights, np.zeros((n, 3)))
    rng = np.random.default_rng(0)
    bends = rng.normal(size=(200, n, 3)) * [1.0, 1.0, 0.0]
    assert off(back) < 0.5 * off(INSIDE)
    assert min(off(back + size * each) for each in bends for size in (1e-5, 1e-4)) > 0.99 * off(back)


@pytest.mark.parametrize(
    ("start", "goal", "walls"),
    [(OUTSIDE, INSIDE, bore()), (INSIDE, OUTSIDE, bore()), (OTHER, INSIDE, [*bore(), *bore(OTHER)])],
    ids=["into a bore", "out of it", "from one into another"],
)
def test_paths_are_found_that_trees_alone_do_not_find(start: Floats, goal: Floats, walls: list[sn.Box]) -> None:
    scene = sn.Scene(walls)
    asked = query(scene, start, goal)
    trees = RRTConnect(ROBOT, asked.scene)
    assert trees.grow(np.stack([start, goal]), 0, (0, 1024), asked.deadline) is None
    path = next(path for path in islice(PlanSearch(asked, trees).paths(), 9) if path is not None)
    np.testing.assert_array_equal(path.q[[0, -1]], [start, goal])
    assert (path.answers[:, VERDICT] == CLEAR).all()
    assert wrong_in(ROBOT, scene, path.q) == ""
    motion = sn.plan(ROBOT, start, goal, scene, time=60.0)
    assert motion.solved
    assert wrong_in(ROBOT, scene, motion.q) == ""


def grow(scene: sn.Scene, seed: int = 0, seconds: float = 60.0) -> Chain | None:
    """The path into a bore that trees find from how far its goal can be drawn back."""
    local = LocalPlanner(query(scene, seconds=seconds))
    drawn_back = Retraction(local, INSIDE, 0, OUTSIDE)
    drawn_back.run()
    trees = ContactRetractionTrees(local, seed)
    trees.plant(0, [[OUTSIDE]])
    trees.plant(1, [drawn_back.knots])
    return trees.grow(200)


def test_the_path_is_clear_and_the_same_each_time() -> None:
    scene = sn.Scene(bore())
    one, other = grow(scene), grow(scene)
    assert one is not None
    np.testing.assert_array_equal(np.stack(one)[[0, -1]], [OUTSIDE, INSIDE])
    assert wrong_in(ROBOT, scene, np.stack(one)) == ""
    np.testing.assert_array_equal(one, other)
