"""Retraction: bodies drawn back along themselves, out of bores, by motions that are clear; and paths through them."""

from collections.abc import Iterator
from itertools import islice, takewhile

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.motions import wrong_in
from benchmarks.motion.hidden import straight
from benchmarks.places import make
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.motion.configurations import distances
from sinuous.motion.planning.local_planner import LocalPlanner, QueryEnds
from sinuous.motion.planning.query import ProvedPath, Query
from sinuous.motion.planning.retraction import (
    ENOUGH,
    KINDS,
    LONGEST,
    TURNS_BEFORE,
    Retraction,
    RetractionKind,
    _moved_ends,
    retraction,
    slid_back,
)
from sinuous.motion.planning.rrt_connect import RRTConnect, rrt_connect
from sinuous.problem.curve import Curve
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore, query

OTHER = -INSIDE * [1.0, 1.0, -1.0]
"""The mirror image: turned half about the base's axis."""


def paths(asked: Query) -> Iterator[ProvedPath | None]:
    return retraction(asked, QueryEnds(asked))


def straight_trees(asked: Query, ends: QueryEnds | None = None) -> Iterator[ProvedPath | None]:
    return rrt_connect(asked, ends or QueryEnds(asked), RRTConnect(asked.robot, asked.scene))


def draw_back(
    scene: Scene, q: Floats, kind: int, seconds: float = 60.0, robot: sn.Robot = ROBOT, other: Floats = OUTSIDE
) -> Floats:
    made = Retraction(LocalPlanner(query(scene, OUTSIDE, q, seconds, robot)), q, kind, other)
    assert made.run()
    return np.stack(made.knots)


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_it_leads_out_of_a_bore(kind: int) -> None:
    scene = Scene(bore())
    knots = draw_back(scene, INSIDE, kind)
    np.testing.assert_array_equal(knots[0], INSIDE)
    assert wrong_in(ROBOT, scene, knots) == ""
    curve = Curve(ROBOT.backbone(INSIDE, 40))
    tips = ROBOT.forward(knots)[:, -1, :3, 3]
    assert curve.distance(tips).max() < 1e-3 * ROBOT.mean_length
    gone = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    assert gone.max() <= (LONGEST + 2e-4) * ROBOT.mean_length  # and a tolerance at either end
    assert gone.sum() > 1.5  # the bore is 0.55 deep in front of the tip
    assert np.linalg.norm(tips[-1] - ROBOT.base[:3, 3]) > ENOUGH


def test_what_is_free_goes_to_where_it_is_at_the_other_end() -> None:
    scene = Scene(bore())
    out = draw_back(scene, INSIDE, KINDS.index(RetractionKind(True, False)))
    other = out[len(out) // 2]

    def nearest(kind: RetractionKind) -> float:
        knots = draw_back(scene, INSIDE, KINDS.index(kind), other=other)
        return min(float(distances(ROBOT, np.stack([q, other]))[0]) for q in knots)

    apart = float(distances(ROBOT, np.stack([INSIDE, other]))[0])
    assert nearest(RetractionKind(True, False, True)) < 0.3 * apart


def test_what_no_end_holds_makes_the_change_that_is_wished() -> None:
    weights, drawn = np.array([0.0, 0.0, 0.0, 0.0, 1.0]), np.full((5, 3), 0.05) * [1.0, 1.0, 0.0]
    tip = ROBOT.jacobian(INSIDE, 5)[3:] * np.tile([1.0, 1.0, 0.0], 5)
    pull = drawn - (np.linalg.pinv(tip) @ tip @ drawn.ravel()).reshape(5, 3)
    still, pulled = (slid_back(ROBOT, INSIDE, 0.01, weights, share * pull) for share in (0.0, 1.0))
    tips = ROBOT.forward(np.stack([still, pulled]))[:, -1, :3, 3]
    assert np.linalg.norm(tips[1] - tips[0]) < 0.02 * ROBOT.mean_length
    assert np.sum((pulled - still) * pull) > 0.9 * np.sum(pull * pull)


def test_it_goes_on_where_it_was() -> None:
    scene = Scene(bore())
    made, runs = Retraction(LocalPlanner(query(scene)), INSIDE, 0, OUTSIDE), 1
    while not made.run(7):
        runs += 1
    assert runs > 2
    np.testing.assert_array_equal(np.stack(made.knots), draw_back(scene, INSIDE, 0))
    assert made.run(1)


def test_a_tool_goes_with_the_tip() -> None:
    robot, scene = ROBOT.changed(tool=sn.pose((0.0, 0.0, 0.1))), Scene(bore())
    np.testing.assert_array_equal(draw_back(scene, INSIDE, 0, robot=robot), draw_back(scene, INSIDE, 0))


def test_without_time_it_stays_where_it_is() -> None:
    np.testing.assert_array_equal(draw_back(Scene(bore()), INSIDE, 0, seconds=0.0), INSIDE[None])


def test_a_body_on_a_stage_slides_back_with_it() -> None:
    robot = sn.on_stage(ROBOT, 2.0)
    q = np.vstack([[[0.0, 0.0, 1.0]], [[0.0, 0.0, 1.0]] * 5])
    back = slid_back(robot, q, 0.1, np.arange(1, 7) / 6, np.zeros((6, 3)))
    moved = (robot.forward(back) - robot.forward(q))[-6:, :3, 3]
    np.testing.assert_allclose(moved, np.tile([0.0, 0.0, -0.1], (6, 1)), atol=2e-3)


def test_sliding_back_is_the_least_that_the_ends_are_off() -> None:
    by, n = 1e-3, len(ROBOT)
    weights = np.arange(1, n + 1) / n
    ends = ROBOT.forward(INSIDE)[-n:]
    asked = ends[:, :3, 3] - by * ends[:, :3, 2]

    def off(q: Floats) -> float:
        return float(np.linalg.norm(weights[:, None] * (ROBOT.forward(q)[-n:, :3, 3] - asked)))

    back = slid_back(ROBOT, INSIDE, by, weights, np.zeros((n, 3)))
    rng = np.random.default_rng(0)
    bends = rng.normal(size=(200, n, 3)) * [1.0, 1.0, 0.0]
    assert off(back) < 0.5 * off(INSIDE)
    assert min(off(back + size * each) for each in bends for size in (1e-5, 1e-4)) > 0.99 * off(back)


def test_sliding_back_keeps_limits() -> None:
    bent = np.array([[2.4, 0.0, 1.0]] * 5)
    for by in (0.1, 1.0):
        assert ROBOT.excess(slid_back(ROBOT, bent, by, np.ones(5), np.ones((5, 3)))) < 1e-12


def test_ends_move_as_the_jacobian_of_each_says() -> None:
    robot = sn.on_stage(ROBOT, 2.0)
    q = np.vstack([[[0.0, 0.0, 0.5]], INSIDE])
    moved = _moved_ends(robot, q, robot.forward(q)[-6:, :3, 3])
    np.testing.assert_allclose(moved, [robot.jacobian(q, k)[3:] for k in range(1, 7)], atol=1e-12)


@pytest.mark.parametrize(
    ("start", "goal", "walls"),
    [(OUTSIDE, INSIDE, bore()), (INSIDE, OUTSIDE, bore()), (OTHER, INSIDE, [*bore(), *bore(OTHER)])],
    ids=["into a bore", "out of it", "from one into another"],
)
def test_paths_are_found_that_trees_alone_do_not_find(start: Floats, goal: Floats, walls: list[sn.Box]) -> None:
    scene = Scene(walls)
    assert list(islice(straight_trees(query(scene, start, goal)), 3)) == [None] * 3
    path = next(path for path in islice(paths(query(scene, start, goal)), TURNS_BEFORE + 7) if path is not None)
    np.testing.assert_array_equal(path.q[[0, -1]], [start, goal])
    assert (path.answers[:, VERDICT] == CLEAR).all()
    assert wrong_in(ROBOT, scene, path.q) == ""
    motion = sn.plan(ROBOT, start, goal, scene, time=60.0)
    assert motion.solved
    assert wrong_in(ROBOT, scene, motion.q) == ""


def test_the_same_seed_gives_the_same_path() -> None:
    scene = Scene(bore())
    one, other = (next(filter(None, paths(query(scene)))) for _ in range(2))
    np.testing.assert_array_equal(one.q, other.q)


def test_without_time_there_is_no_path() -> None:
    assert list(islice(paths(query(Scene(bore()), seconds=0.0)), 4)) == [None] * 4


def test_where_it_is_narrow_it_begins_at_once() -> None:
    asked = query(Scene(bore()))
    narrow, wide = QueryEnds(asked), QueryEnds(asked)
    narrow.narrow = True
    turns = [len(list(takewhile(lambda path: path is None, retraction(asked, ends)))) for ends in (narrow, wide)]
    assert turns[1] == turns[0] + TURNS_BEFORE


def test_trees_see_how_narrow_it_is() -> None:
    place = make("square bore", 14)
    for goal, narrow in ((place.hidden_q, True), (0.9 * straight(place.robot) + 0.1 * place.hidden_q, False)):
        asked = query(place.scene, straight(place.robot), goal, robot=place.robot)
        ends = QueryEnds(asked)
        next(straight_trees(asked, ends))
        assert ends.narrow == narrow
