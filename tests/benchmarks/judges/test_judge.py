"""A judge that cannot fail is a defect: each is shown what is wrong, and what is only just right.

The judge of tensions agrees with what the package finds, and sees what is pulled by more than it may be.

Self-collision: what sampling sees is what brute force sees, and laws of the thickness of a tube.
"""

import math

import numpy as np
import pytest
from scipy.linalg import expm

import sinuous as sn
from benchmarks import problems
from benchmarks.judges.clearances import overlaps
from benchmarks.judges.judge import right, within_limits
from benchmarks.judges.kinematics import arc_poses, body_points, segment_ends, tip_poses
from benchmarks.judges.self_collision import FINEST, look, surely_clear
from benchmarks.motion.limits import KINDS, arm, drawn, is_false, most_pulled
from benchmarks.problems import random_configurations
from benchmarks.wild import worlds
from tests.helpers import Floats, present, twist_matrix, with_each

STRAIGHT = np.array([[[0.0, 0.0, 1.0]] * 3])
"""One configuration of `ARM`, from the origin to (0, 0, 3)."""

ARM = sn.Robot.uniform(3, (0.8, 1.2), 2.0, max_curvature=2.2, radius=0.1)
TOLERANCE = sn.Tolerance(1e-6, 1e-6)


def changed(segment: int, coordinate: int, by: float) -> Floats:
    q = STRAIGHT.copy()
    q[0, segment, coordinate] += by
    return q


@with_each("bend", [0.0, 1e-12, 1e-6, 0.3, 1.7, math.pi, 5.0])
def test_arcs_are_the_exponential_of_their_twist(bend: float) -> None:
    q = np.array([bend * math.cos(0.7), bend * math.sin(0.7), 1.3])
    np.testing.assert_allclose(arc_poses(*q[:, None])[0], expm(twist_matrix(q)), atol=1e-14)


def test_reference_agrees_with_the_library() -> None:
    robot = sn.Robot.uniform(4, (0.5, 1.0), 2.5, base=sn.pose((1, 2, 3), direction=(0, 1, 1)), tool=sn.pose((0, 0, 1)))
    q = problems.random_configurations(robot, 20, np.random.default_rng(0))
    np.testing.assert_allclose(segment_ends(robot, q)[:, 1:], robot.forward(q), atol=1e-13)
    np.testing.assert_allclose(tip_poses(robot, q), robot.tip(q), atol=1e-13)
    points, along = body_points(robot, q, 8)
    np.testing.assert_allclose(points[:, :, 1:].reshape(20, -1, 3), robot.backbone(q, 8)[:, 1:], atol=1e-13)
    np.testing.assert_allclose(along[:, -1, -1], q[..., 2].sum(axis=1))


@with_each(
    "target",
    [
        sn.Target((0, 0, 3 + 2e-6), direction=(0, 0, 1)),
        sn.Target((2e-6, 0, 3), direction=(0, 0, 1)),
        sn.Target((0, 0, 3), direction=(2e-6, 0, 1)),
        sn.Target((0, 0, 3), direction=(0, 0, -1)),
        sn.Target((0, 0, 3), rotation=(1, 0, 0, 2e-6)),
        sn.Target((0, 0, 1 + 2e-6), segment=1),
        sn.Target(direction=(0, 1, 0)),
    ],
)
def test_a_missed_target_is_seen(target: sn.Target) -> None:
    assert not right(ARM, [target], STRAIGHT, TOLERANCE).any()


@pytest.mark.parametrize(
    "target",
    [
        sn.Target((0, 0, 3 + 0.9e-6), direction=(0.9e-6, 0, 1)),
        sn.Target((0, 0, 3), rotation=(1, 0, 0, 0.4e-6)),
        sn.Target((0, 0, 1), segment=1),
    ],
)
def test_within_tolerance_is_met(target: sn.Target) -> None:
    assert right(ARM, [target], STRAIGHT, TOLERANCE).all()


@with_each(
    ("segment", "coordinate", "by"),
    [(0, 2, 0.2 + 1e-7), (2, 2, -0.2 - 1e-7), (1, 0, 2.0 + 1e-7), (1, 1, -2.0 - 1e-7), (0, 0, math.nan)],
)
def test_a_broken_limit_is_seen(segment: int, coordinate: int, by: float) -> None:
    assert not within_limits(ARM, changed(segment, coordinate, by)).any()


@with_each("seed", range(5))
def test_limits_of_actuators_are_what_the_robot_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tendons = sn.Tendons(angles=rng.uniform(-3, 3, 3), radius=0.1, displacement=(-0.1, 0.08))
    pulled, blown = sn.Segment((0.5, 1.5), tendons=tendons), sn.Chambers(3, 0.1, length=(0.6, 1.4))
    robot = sn.Robot([pulled, sn.Segment(1.0), pulled, sn.Segment((0.5, 1.5), chambers=blown)])
    q = problems.random_configurations(robot, 200, rng)
    q[..., :2] *= rng.random((200, 1, 1))
    assert within_limits(robot, q).tolist() == [robot.excess(one) <= 1e-9 for one in q]
    assert 20 < within_limits(robot, q).sum() < 180


@pytest.mark.parametrize("seed", range(2))
def test_collisions_agree_with_distances_of_samples(seed: int) -> None:
    """Clearly free and clearly touching bodies, as told by the library's own distances, are told so."""
    asked = worlds.clutter(seed, 60)
    robot, scene = asked.robot, asked.scene
    q = problems.random_configurations(robot, 60, np.random.default_rng(seed))
    points, along = body_points(robot, q, 400)
    gaps = scene.distance(points) - np.array(robot.radii)[:, None]
    clearance = np.where(along >= robot.mount, gaps, np.inf).min(axis=(1, 2))
    told = overlaps(robot, scene, q)
    slack = 0.02 * robot.mean_length
    assert not told[clearance > 0.0].any()
    assert told[clearance < -slack].all()


@pytest.mark.parametrize("kind", KINDS)
def test_least_energies_have_the_tensions_of_equilibria(kind: str) -> None:
    rng = np.random.default_rng(1)
    robot = arm(kind, rng)
    q = drawn(robot, rng)
    found = most_pulled(robot, robot.to_actuators(q), q[:, 2], q)
    own = robot.shape(q).tensions if robot.has_external_load else robot.tensions(robot.to_actuators(q), q)
    assert found == pytest.approx(np.nanmax(own), rel=1e-3)
    lines = present(robot.segments[0].tendons)
    for share, false in ((1.01, False), (0.98, True)):
        held = lines.changed(tension=(0.0, share * found))
        assert (
            is_false(robot.changed(segments=[each.changed(tendons=held) for each in robot.segments]), q[None]) == false
        )


def brute(robot: sn.Robot, q: Floats, samples: int) -> float:
    """Least gap of all pairs of evenly spaced places of one configuration (n, 3)."""
    points, along = body_points(robot, q[None], samples)
    radii = np.repeat(robot.radii, samples + 1)
    flat, place = points.reshape(-1, 3), along.ravel()
    gaps = np.linalg.norm(flat[:, None] - flat, axis=-1) - radii[:, None] - radii
    counted = np.abs(place[:, None] - place) >= math.pi * np.maximum(radii[:, None], radii)
    return float(np.where(counted, gaps, math.inf).min())


@pytest.mark.parametrize(("radii", "seed"), [((0.1,) * 4, 0), ((0.03,) * 4, 1), ((0.15, 0.05, 0.1, 0.05), 2)])
def test_it_sees_what_brute_force_sees(radii: tuple[float, ...], seed: int) -> None:
    robot = sn.Robot([sn.Segment((0.9, 1.1), 5.0, radius=radius) for radius in radii])
    q = random_configurations(robot, 30, np.random.default_rng(seed))
    samples = 60
    expected = np.array([brute(robot, one, samples) for one in q])
    seen = look(robot, q, 0.0)
    # Places that are sampled here are at most half a spacing from those sampled there, on either side.
    near = np.abs(expected) < 1.1 / samples
    assert ((seen.least < 0.0) == (expected < 0.0))[~near].all()
    assert 3 < (expected < 0.0).sum() < 27
    clear = surely_clear(robot, q)
    assert (expected[clear] > 0.0).all()
    assert not clear[seen.least < 0.0].any()
    assert clear[expected > 2.2 / samples].all()


@pytest.mark.parametrize("share", [0.9, 0.999])
def test_a_circle_that_closes_touches_itself_when_its_ends_come_near(share: float) -> None:
    """The ends of an arc that turns by t are `2 R sin(t / 2)` apart."""
    turn, radius = 2.0 * math.pi * share, 0.05
    robot = sn.Robot.uniform(1, 1.0, 7.0, radius=radius)
    q = np.array([[[turn, 0.0, 1.0]]])
    gap = 2.0 / turn * math.sin(0.5 * turn) - 2.0 * radius
    assert look(robot, q).least[0] == pytest.approx(gap, abs=FINEST * radius)
    assert surely_clear(robot, q)[0] == (gap > 0.0)
