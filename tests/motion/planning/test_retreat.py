"""A body drawn back along itself: out of a bore, by motions that are clear, its tip on the curve that it made."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion.judged import collides
from sinuous.motion.configurations import distances
from sinuous.motion.planning.goals import FixedGoal
from sinuous.motion.planning.means import Means
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.retreat import ENOUGH, KINDS, LONGEST, Kind, Retreat, _moved_ends, slid_back
from sinuous.motion.planning.watch import Watch
from sinuous.problem.curve import Curve
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore


def retreat(
    scene: Scene, q: Floats, kind: int, seconds: float = 60.0, robot: sn.Robot = ROBOT, other: Floats = OUTSIDE
) -> Floats:
    asked = Question(robot, scene.snapshot(), OUTSIDE, FixedGoal(q), 0, 0, Watch(seconds))
    made = Retreat(Means(asked), q, kind, other)
    assert made.run()
    return np.stack(made.knots)


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_it_leads_out_of_a_bore(kind: int) -> None:
    scene = Scene(bore())
    knots = retreat(scene, INSIDE, kind)
    np.testing.assert_array_equal(knots[0], INSIDE)
    assert collides(ROBOT, scene, knots) == ""
    curve = Curve(ROBOT.backbone(INSIDE, 40))
    tips = ROBOT.forward(knots)[:, -1, :3, 3]
    assert curve.distance(tips).max() < 1e-3 * ROBOT.mean_length
    gone = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    assert gone.max() <= (LONGEST + 2e-4) * ROBOT.mean_length  # and a tolerance at either end
    assert gone.sum() > 1.5  # the bore is 0.55 deep in front of the tip
    assert np.linalg.norm(tips[-1] - ROBOT.base[:3, 3]) > ENOUGH


def test_what_is_free_goes_to_where_it_is_at_the_other_end() -> None:
    scene = Scene(bore())
    out = retreat(scene, INSIDE, KINDS.index(Kind(True, False)))
    other = out[len(out) // 2]

    def nearest(kind: Kind) -> float:
        knots = retreat(scene, INSIDE, KINDS.index(kind), other=other)
        return min(float(distances(ROBOT, np.stack([q, other]))[0]) for q in knots)

    apart = float(distances(ROBOT, np.stack([INSIDE, other]))[0])
    assert nearest(Kind(True, False, True)) < 0.3 * apart


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
    asked = Question(ROBOT, scene.snapshot(), OUTSIDE, FixedGoal(INSIDE), 0, 0, Watch(60.0))
    made, runs = Retreat(Means(asked), INSIDE, 0, OUTSIDE), 1
    while not made.run(7):
        runs += 1
    assert runs > 2
    np.testing.assert_array_equal(np.stack(made.knots), retreat(scene, INSIDE, 0))
    assert made.run(1)


def test_a_tool_goes_with_the_tip() -> None:
    robot, scene = ROBOT.changed(tool=sn.pose((0.0, 0.0, 0.1))), Scene(bore())
    np.testing.assert_array_equal(retreat(scene, INSIDE, 0, robot=robot), retreat(scene, INSIDE, 0))


def test_without_time_it_stays_where_it_is() -> None:
    np.testing.assert_array_equal(retreat(Scene(bore()), INSIDE, 0, seconds=0.0), INSIDE[None])


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
