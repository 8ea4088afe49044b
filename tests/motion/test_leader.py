"""Follow the leader: the tip is on the curve, the body behind it, and every step is proved; on an insertion stage."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.following import body_places
from sinuous.motion import leader
from tests.helpers import present, refused, with_each

BEZIER = sn.Curve.bezier([(0, 0, 0), (0, 0, 1.6), (2, 0, 1.3)])
STAGED = sn.on_stage(sn.Robot.uniform(3, 1.0, radius=0.05), BEZIER.length)
UNROLLING = sn.Robot.uniform(5, (10, 70), max_bend=2.4, radius=4)
BALL = sn.Sphere((0, 40, 120), radius=25)
ARM = sn.Robot.uniform(
    2, (40, 60), radius=3, tendons=sn.Tendons(3, radius=2), base=sn.pose((1, 2, 3), direction=(0, 1, 1))
)


@pytest.fixture(scope="module")
def entered() -> sn.Motion:
    return sn.follow_the_leader(STAGED, BEZIER)


def test_the_tip_is_on_the_curve_and_the_body_behind_it(entered: sn.Motion) -> None:
    assert entered.solved
    tips = STAGED.forward(entered.q)[:, -1, :3, 3]
    longer = sn.Curve(BEZIER.points, start=STAGED.base[:3, 3])
    assert longer.distance(tips).max() < 1e-8
    np.testing.assert_allclose(tips, longer.at(entered.times), atol=1e-8)
    found = entered.deviation(longer)
    assert found.length == 3.0
    assert found.shares["tip"] < 2e-5
    assert found.shares["shape_mean"] < 0.005
    assert found.shares["shape"] < 0.02


def test_it_begins_drawn_back_and_ends_with_the_tip_at_the_end(entered: sn.Motion) -> None:
    assert entered.times[0] == pytest.approx(3.0)
    np.testing.assert_allclose(entered.q[0, :, 2], (0, 1, 1, 1), atol=1e-9)
    np.testing.assert_allclose(STAGED.forward(entered.q[-1])[-1, :3, 3], (2, 0, 1.3), atol=1e-8)
    assert np.abs(STAGED.violations(entered.q[-1])).size == 0


def test_a_curve_that_is_met_half_way_is_looked_at_elsewhere() -> None:
    """Ripples as long as the steps at first: the curve crosses the way of the tip at knots, and between them."""
    spacing = 1.0 / leader.FITTED
    height = np.arange(0.0, 2.0, spacing / 16.0)
    points = np.stack([0.004 * np.sin(2.0 * np.pi * height / spacing), 0.0 * height, height], axis=1)
    curve = sn.Curve(points, start=STAGED.base[:3, 3])
    staged = sn.on_stage(sn.Robot.uniform(3, 1.0, radius=0.05), curve.length - 3.0)
    motion = sn.follow_the_leader(staged, curve, tip_deviation=1e-3)
    assert motion.deviation(curve, between=20).tip < 1.2e-3


def test_an_arm_that_stretches_unrolls_into_a_solved_shape() -> None:
    solution = sn.solve(UNROLLING, sn.Target((60, 20, 200), direction=(0.7, 0, 0.7)), [BALL])
    motion = sn.follow_the_leader(UNROLLING, solution, [BALL])
    assert motion.solved
    np.testing.assert_allclose(motion.q[0, :, 2], 10.0, atol=1e-6)
    np.testing.assert_allclose(motion.q[-1], solution.q, atol=0.02)
    places = body_places(UNROLLING, motion.at(np.linspace(motion.times[0], motion.times[-1], 300)))
    assert np.linalg.norm(places - BALL.center, axis=-1).min() - 25 - 4 >= present(motion.clearance)


def test_it_ends_before_what_is_in_the_way() -> None:
    ball = sn.Sphere((1.5, 0, 1.3), radius=0.2)
    motion = sn.follow_the_leader(STAGED, BEZIER, [ball])
    assert motion.status in ("target_blocked", "blocked")
    assert len(motion.solutions) == 2
    assert motion.waypoint_knots == (0, None)
    assert motion.clearance is None or motion.clearance > 0.0
    tip = STAGED.forward(motion.q[-1])[-1, :3, 3]
    assert 0.25 <= np.linalg.norm(tip - (1.5, 0, 1.3)) < 0.5


def test_beside_walls_the_knots_do_not_depend_on_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two rows of balls touch the body; a proof is no longer or shorter for the time that it may take."""
    along = np.linspace(0.4, BEZIER.length, 30)
    balls = [sn.Sphere(np.add(BEZIER.at(s), [0.0, side * 0.36, 0.0]), radius=0.3) for s in along for side in (-1, 1)]
    motions = []
    for seconds in (leader.SECONDS, 100.0 * leader.SECONDS):
        monkeypatch.setattr(leader, "SECONDS", seconds)
        motions.append(sn.follow_the_leader(STAGED, BEZIER, balls, tip_deviation=1e-3))
    assert np.array_equal(motions[0].q, motions[1].q)
    assert motions[0].unproved_steps == motions[1].unproved_steps
    assert motions[0].seconds < 60.0


def test_the_tool_is_not_led() -> None:
    robot = STAGED.changed(tool=sn.pose((0, 0.1, 0.2)))
    motion, bare = (sn.follow_the_leader(each, BEZIER, tip_deviation=0.01) for each in (robot, STAGED))
    np.testing.assert_array_equal(motion.q, bare.q)
    longer = sn.Curve(BEZIER.points, start=STAGED.base[:3, 3])
    assert motion.solved
    assert longer.distance(robot.forward(motion.q)[:, -1, :3, 3]).max() < 1e-8


@with_each(
    ("key", "given", "words"),
    [
        (
            "robot",
            {"robot": sn.Robot.uniform(3, 1.0)},
            "no segment stretches; expected an insertion stage (see on_stage), or such segments",
        ),
        ("curve", {"robot": UNROLLING}, "expected more than 50 and at most 350 from the base"),
        (
            "curve",
            {"curve": [(1, 0, -3), (2, 0, -3)]},
            "leads elsewhere; expected a curve that begins along the axis of the base",
        ),
        ("curve", {"curve": [(0, 0, 0)]}, "expected at least two points"),
        ("tip_deviation", {"tip_deviation": 0.0}, "expected a number greater than 0"),
    ],
)
def test_what_cannot_be_followed_is_refused(key: str, given: dict[str, Any], words: str) -> None:
    whole: dict[str, Any] = {"robot": STAGED, "curve": BEZIER, **given}
    refused(key, lambda: sn.follow_the_leader(**whole), words)


def test_what_is_known_of_each_segment_goes_onto_the_stage_too() -> None:
    arm = ARM.changed(
        clearance=(1, 2),
        self_clearance=(3, 4),
        uncertainty=sn.Uncertainty((0.5, 0.7), 0.99),
        payload=sn.Payload(2, segment=1),
    )
    robot = sn.on_stage(arm, 100)
    assert (robot.clearance, robot.self_clearance) == ((1, 1, 2), (3, 3, 4))
    assert robot.uncertainty is not None
    assert (robot.uncertainty.bound, robot.uncertainty.level) == ((0.5, 0.5, 0.7), 0.99)
    assert [(load.mass, load.segment) for load in robot.payload] == [(2, 2)]


def test_joints_carry_the_arm_along_the_curve() -> None:
    """A gantry with a wrist; judged by products of rotations, see `body_places`."""
    joints: list[Any] = [sn.Prismatic(axis, (-4.0, 4.0)) for axis in np.eye(3)]
    joints += [
        sn.Revolute((1, 0, 0), (-2, 2)),
        sn.Revolute((0, 1, 0), (-2, 2), body=[((0, 0, -0.5), (0, 0, -0.1), 0.1)]),
    ]
    robot = sn.Robot([sn.Segment(1.0, radius=0.05)] * 3, joints=joints)
    wall = sn.Sphere((1.2, 0.0, 0.2), 0.5)
    motion = sn.follow_the_leader(robot, BEZIER, [wall], tip_deviation=1e-3)
    assert motion.solved
    assert motion.times[0] == pytest.approx(3.0)
    start, end = (body_places(robot, q[None])[0, -3:].reshape(-1, 3) for q in motion.configuration[[0, -1]])
    np.testing.assert_allclose(start[:, :2], 0.0, atol=1e-3)
    np.testing.assert_allclose(start[[0, -1], 2], (-3.0, 0.0), atol=1e-3)
    np.testing.assert_allclose(end[-1], (2, 0, 1.3), atol=1e-8)
    found = motion.deviation(BEZIER)
    assert found.length == 3.0
    assert found.shares["tip"] < 1e-3 / 3.0
    assert found.shares["shape_mean"] < 0.005
    assert found.shares["shape"] < 0.02
    assert all(each.ok for each in motion.verify())
    solution = sn.solve(robot, sn.Target(end[-1], direction=(1, 0, 0)))
    assert sn.follow_the_leader(robot, solution).solved
