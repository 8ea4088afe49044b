"""Motions under load: knots and the way between them are of the loaded body, judged by code that solves nothing."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from tests.helpers import present
from tests.solver.test_loaded_solve import GRAVITY, ROD, Q, arm
from tests.solver.test_loaded_solve import cosserat as rods

SECONDS = 20.0
AWAY = np.array([0.05, 0.0, 0.0])
MOVED = np.array([[0.15, -0.1, 0.004], [0.1, 0.1, -0.004], [-0.1, 0.15, 0.0]])


def path(robot: sn.Robot, end: Floats, count: int = 3) -> list[sn.Target]:
    return [sn.Target(robot.shape(Q + share * (end - Q)).tip[:3, 3]) for share in np.linspace(0.0, 1.0, count)]


def test_a_track_is_proved_and_verified() -> None:
    robot = arm()
    ball = sn.Sphere(robot.shape(Q).tip[:3, 3] + [0.04, 0.0, 0.0], 0.015)
    motion = sn.track(robot, path(robot, Q + MOVED), [ball], start=Q, time=SECONDS)
    assert motion.solved, motion
    assert motion.between == "proved"
    found = motion.verify()
    assert all(each.ok for each in found)
    assert 0.0 < present(motion.clearance) <= min(each.clearance for each in found)
    assert motion.tips[-1][:3, 3] == pytest.approx(motion.solutions[-1].problem.targets[0].position, abs=3e-5)
    assert np.linalg.norm(robot.tip(motion.q[-1])[:3, 3] - motion.tips[-1][:3, 3]) > 0.01, "nothing bends it"


def test_the_loaded_tip_stays_on_the_line_between_waypoints() -> None:
    robot = arm()
    begin, end = (each.position for each in path(robot, Q + 2.0 * MOVED, 2))
    assert begin is not None
    assert end is not None
    motion = sn.track(robot, [sn.Target(begin), sn.Target(end)], start=Q, time=SECONDS, deviation=0.002)
    assert motion.solved
    along = (end - begin) / np.linalg.norm(end - begin)
    worst = 0.0
    for q, other in zip(motion.q[:-1], motion.q[1:], strict=True):
        for share in (0.0, 0.3, 0.5, 0.7):
            away = robot.shape((1.0 - share) * q + share * other).tip[:3, 3] - begin
            worst = max(worst, float(np.linalg.norm(away - along * (away @ along))))
    assert 1e-5 < worst < 0.002
    assert len(motion.q) > 3


def test_a_plan_goes_round_what_only_the_loaded_body_meets() -> None:
    robot = arm()
    end = Q * [-1.0, 1.0, 1.0]
    half = robot.shape(0.5 * (Q + end)).tip[:3, 3]
    ball = sn.Sphere(half, 0.008)
    assert not sn.Motion(robot, [Q, end], [ball]).solved, "the straight way is clear"
    motion = sn.plan(robot, Q, end, [ball], time=SECONDS)
    assert motion.solved, motion
    assert len(motion.q) > 2
    assert all(each.ok for each in motion.verify())


def test_obstacles_that_move_are_met_in_time() -> None:
    robot = arm()
    there = robot.shape(Q).tip[:3, 3] + [0.03, 0.0, 0.0]
    away, back = np.array([0.2, 0.0, 0.0]), np.array([0.03, 0.0, 0.0])
    gone = sn.Moving(sn.Sphere((0.0, 0.0, 0.0), 0.01), [0.0, 1.0], [there, there + away])
    near = sn.Moving(sn.Sphere((0.0, 0.0, 0.0), 0.01), [0.0, 1.0], [there + away, there - back])
    still = np.stack([Q, Q])
    assert sn.Motion(robot, still, [gone]).solved
    assert not sn.Motion(robot, still, [near]).solved


def test_what_nothing_bounds_is_sampled_and_never_called_proved() -> None:
    segment = sn.Segment(0.1, max_bend=2.0, radius=0.005, tendons=sn.Tendons(3, 0.004, straight=True, stiffness=300.0))
    robot = sn.Robot([segment] * 3, stiffness=ROD, mass=0.05, arcs=4, gravity=GRAVITY)
    near = robot.shape(Q).tip[:3, 3]
    motion = sn.Motion(robot, [Q, Q + 0.2 * MOVED * [1, 1, 0]], [sn.Sphere(near + AWAY, 0.01)])
    assert motion.between == "sampled"
    assert motion.status is sn.Status.UNPROVED
    assert motion.steps.samples.tolist() == [17]
    assert not motion.steps.proved.any()
    assert motion.clearance is None or motion.steps.clearance is None
    assert "17 shapes" in str(motion)
    assert motion.verify()[0].ok
    hit = sn.Motion(robot, [Q, Q + 0.2 * MOVED * [1, 1, 0]], [sn.Sphere(near, 0.01)])
    assert hit.between == "unproved"
    assert hit.steps.samples.tolist() == [0]
    assert not hit.verify()[0].ok


def test_a_proof_holds_at_many_shapes_between() -> None:
    """Law: no shape on a step that is proved, itself at rest by the judge, is nearer than the proved clearance."""
    robot, random = arm(), np.random.default_rng(3)
    proved = 0
    for _ in range(6):
        q = Q + np.concatenate([random.uniform(-0.5, 0.5, (3, 2)), np.zeros((3, 1))], axis=1)
        other = q + np.concatenate([random.uniform(-0.2, 0.2, (3, 2)), random.uniform(-0.005, 0.005, (3, 1))], axis=1)
        place = robot.shape(q).backbone(5)[random.integers(20, 60)] + random.normal(0.0, 0.02, 3)
        ball = sn.Sphere(place, 0.005)
        motion = sn.Motion(robot, [q, other], [ball])
        seen = motion.verify()[0]
        if motion.solved:
            proved += 1
            assert seen.ok
            assert motion.steps.clearances[0] <= seen.clearance + 1e-12
        else:
            assert seen.clearance < 0.01, "a wide gap was not proved"
    assert proved >= 2


CURVE = sn.Curve.bezier([(0, 0, 0), (0.12, 0, 0), (0.2, 0, 0.1), (0.2, 0.05, 0.16)])
ALONG: dict[str, Any] = {"base": sn.pose(direction=(1, 0, 0)), "gravity": GRAVITY, "payload": sn.Payload(0.005)}


def staged(**of_segment: Any) -> sn.Robot:
    own: dict[str, Any] = {"stiffness": ROD, "mass": 0.05, "arcs": 4, "max_bend": 2.0, "radius": 0.004, **of_segment}
    return sn.on_stage(sn.Robot([sn.Segment(0.1, **own)] * 3, **ALONG), 0.3)


def test_the_loaded_body_follows_the_leader() -> None:
    robot = staged()
    motion = sn.follow_the_leader(robot, CURVE, tip_deviation=1e-4)
    assert motion.solved, motion
    assert motion.between == "proved"
    longer = sn.Curve(CURVE.points, start=robot.base[:3, 3])
    np.testing.assert_allclose(motion.tips[:, :3, 3], longer.at(motion.times), atol=1e-9)
    found = motion.deviation(longer)
    assert found.tip < 1.2e-4
    assert found.shares["shape"] < 0.02
    assert found.shares["shape_mean"] < 0.003
    free = sn.follow_the_leader(robot.changed(gravity=None, payload=None), CURVE, tip_deviation=1e-4)
    assert sn.Motion(robot, free.q[::10]).deviation(longer).shares["shape"] > 0.1, "nothing bends it"
    for i in (0, len(motion.q) // 2, -1):
        standing = robot.changed(base=robot.base @ sn.pose((0.0, 0.0, motion.q[i, 0, 2])))
        ends = rods(standing, motion.q[i, 1:])
        assert longer.distance(np.array(ends)[:, :3, 3]).max() < 0.01 * robot.mean_length


def test_the_loaded_body_unrolls_clear_of_an_obstacle_and_ends_in_a_solved_shape() -> None:
    segment = sn.Segment((0.02, 0.12), stiffness=ROD, mass=0.05, arcs=4, max_bend=2.0, radius=0.004)
    robot = sn.Robot([segment] * 3, **ALONG)
    ball = sn.Sphere((0.12, 0.045, 0.01), 0.02)
    solution = sn.solve(robot, sn.Target((0.2, 0.05, 0.1), direction=(0.6, 0.2, 0.8)), [ball], time=20.0)
    assert solution.solved, solution
    motion = sn.follow_the_leader(robot, solution, [ball], tip_deviation=1e-3)
    assert motion.solved, motion
    seen = motion.verify()
    assert all(each.ok for each in seen)
    assert present(motion.clearance) <= min(each.clearance for each in seen)
    assert motion.tips[-1][:3, 3] == pytest.approx(solution.tip[:3, 3], abs=1e-6)


@pytest.mark.parametrize("straight", [False, True])
def test_tendons_that_follow_arcs_are_proved_and_straight_ones_sampled(straight: bool) -> None:
    robot = staged(stiffness=sn.Stiffness(0.01), tendons=sn.Tendons(3, 0.004, straight=straight))
    motion = sn.follow_the_leader(robot, CURVE, tip_deviation=1e-3)
    assert motion.between == ("sampled" if straight else "proved")
    assert motion.solved is not straight
    assert motion.q[0, 0, 2] == pytest.approx(0.0, abs=1e-4), "it begins drawn back"
    assert motion.deviation(sn.Curve(CURVE.points, start=robot.base[:3, 3])).shares["shape"] < 0.02


RATES = sn.Rates(bend=1.0, length=1.0, acceleration=sn.Rates(bend=5.0, length=5.0))
ROUND = 0.001
CORNERS = np.stack([Q, Q + MOVED, Q + MOVED + np.array([[0.1, 0.15, 0.0], [0.15, -0.05, 0.0], [0.0, 0.2, 0.003]])])


def places(robot: sn.Robot, q: Floats) -> Floats:
    """Places (T, p, 3) of the loaded body at drives (T, n, 3)."""
    return np.array([robot.shape(each).backbone(5) for each in q])


def off_legs(robot: sn.Robot, q: Floats, rounded: sn.Trajectory) -> tuple[Floats, float]:
    """Drive (n, 3) at which the loaded body is farthest from two legs, near their corner, and how far it is there."""
    shares = np.linspace(0.0, 1.0, 150)[:, None, None]
    legs = places(
        robot, np.concatenate([q[1] + 0.1 * (1.0 - shares) * (q[0] - q[1]), q[1] + 0.1 * shares * (q[2] - q[1])])
    )
    times = np.linspace(0.0, rounded.duration, 5000)
    corner = times[np.abs(rounded.at(times) - q[1]).max(axis=(1, 2)).argmin()]
    passed = rounded.at(corner + np.linspace(-0.02, 0.02, 41))
    off = np.array([np.linalg.norm(legs - each, axis=-1).max(axis=1).min() for each in places(robot, passed)])
    return passed[int(off.argmax())], float(off.max())


def test_rounded_corners_keep_the_loaded_body_near_its_way() -> None:
    """Law: no place leaves the way by more than was allowed, at shapes looked for anew, and as Cosserat rods."""
    robot = arm()
    motion = sn.Motion(
        robot, CORNERS, [sn.Sphere(robot.shape(CORNERS[1]).tip[:3, 3] + np.array([0.0, 0.04, 0.0]), 0.01)]
    )
    assert motion.solved
    stopping, rounded = motion.timed(RATES), motion.timed(RATES, blend=ROUND)
    assert (stopping.stops, rounded.stops) == (1, 0)
    assert rounded.duration < 0.98 * stopping.duration
    middle, off = off_legs(robot, CORNERS, rounded)
    assert 0.1 * ROUND < off <= ROUND
    apart = np.array(rods(robot, middle)) - np.array(rods(robot, CORNERS[1]))
    assert 0.1 * ROUND < np.linalg.norm(apart[:, :3, 3], axis=1).max() <= 1.05 * ROUND
