"""Drives of robots under load: the loaded body meets the targets, judged by other code."""

import json
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.cosserat import shoot
from sinuous.base.checks import Floats
from tests.helpers import present, with_each

ROD = sn.Stiffness(bend=0.01, twist=0.008)
GRAVITY = (0.0, 0.0, -9.81)
Q = np.array([[0.5, 0.2, 0.1], [-0.4, 0.6, 0.1], [0.3, 0.3, 0.1]])


def arm(**more: Any) -> sn.Robot:
    own: dict[str, Any] = {
        "stiffness": ROD,
        "mass": 0.05,
        "arcs": 4,
        "gravity": GRAVITY,
        "payload": sn.Payload(0.01),
        **more,
    }
    return sn.Robot([sn.Segment((0.07, 0.13), max_bend=2.0, radius=0.005)] * 3, **own)


@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
def test_the_loaded_body_meets_the_target(kind: str) -> None:
    robot = arm()
    tip = robot.shape(Q).tip
    orientation: Any = {"direction": {"direction": tip[:3, 2]}, "rotation": {"rotation": tip[:3, :3]}}.get(kind, {})
    target: Any = sn.Target(tip[:3, 3], **orientation)
    solution = sn.solve(robot, target)
    assert solution.solved, solution
    assert solution.verify().ok
    assert present(solution.shape).tip[:3, 3] == pytest.approx(tip[:3, 3], abs=3e-5)
    assert np.linalg.norm(robot.tip(solution.q)[:3, 3] - tip[:3, 3]) > 0.01, "nothing bends it"


def test_a_cosserat_rod_in_its_place_is_near_the_target() -> None:
    robot = arm(arcs=6)
    target = sn.Target(robot.shape(Q).tip[:3, 3])
    q = sn.solve(robot, target).raise_for_status().q
    ends = cosserat(robot, q)
    assert np.linalg.norm(ends[-1][:3, 3] - robot.shape(Q).tip[:3, 3]) < 0.005 * robot.mean_length


def cosserat(robot: sn.Robot, q: Floats) -> list[Floats]:
    rests = np.array([[-y / length, x / length, 0.0] for x, y, length in q])
    weights = np.tile(0.05 * np.array(GRAVITY), (len(q), 1))
    loads = np.zeros((len(q), 6))
    loads[-1, :3] = robot.payload[0].mass * np.array(GRAVITY)
    stiffness = np.array([[ROD.bend, ROD.twist, 1e6]] * len(q))
    return shoot(q[:, 2], stiffness, rests, weights, loads, robot.base)


def test_an_elbow_and_a_tip_are_met_at_once() -> None:
    robot = arm(tool=sn.pose((0.0, 0.01, 0.02)))
    shape = robot.shape(Q)
    elbow = sn.Target(shape.poses[0][:3, 3], rotation=shape.poses[0][:3, :3], segment=1)
    solution = sn.solve(robot, [elbow, sn.Target(shape.tip[:3, 3])], initial=Q + 0.05)
    assert solution.solved, solution
    assert solution.verify().ok


def test_the_loaded_body_is_clear_of_obstacles() -> None:
    robot = arm()
    shape = robot.shape(Q)
    free = robot.backbone(Q)[-15]
    near = sn.Sphere(free, 0.012)
    assert not sn.check(robot.changed(gravity=None), Q, [near]).ok, "the body without load is clear of it, too"
    assert sn.check(robot, Q, [near]).ok
    solution = sn.solve(robot, sn.Target(shape.tip[:3, 3]), [near], initial=Q)
    assert solution.solved, solution
    assert 0.0 < present(solution.clearance) <= solution.verify().clearance
    inside = sn.solve(robot, sn.Target(shape.tip[:3, 3]), [sn.Sphere(shape.tip[:3, 3], 0.02)], time=0.1)
    assert not inside.solved
    assert inside.worst is not None
    assert len(inside.to_dict()["loaded"]) == 12


def test_tendons_hold_it_and_their_limits_are_kept() -> None:
    segment = sn.Segment(0.1, max_bend=2.0, radius=0.005, tendons=sn.Tendons(3, 0.004, displacement=(-0.006, 0.006)))
    robot = sn.Robot([segment] * 3, stiffness=ROD, mass=0.05, arcs=4, gravity=GRAVITY)
    target = sn.Target(robot.shape(Q).tip[:3, 3])
    solution = sn.solve(robot, target)
    assert solution.solved, solution
    assert robot.excess(solution.q) == 0.0
    assert solution.verify().ok


def test_limits_of_actuators_are_rows_of_each_correction() -> None:
    """Corrections go along limits: of these targets a fifth was missed by steps that know none."""
    limited = sn.Tendons(3, 0.004, displacement=(-0.0015, 0.0015))
    segment = sn.Segment((0.07, 0.13), max_bend=2.0, radius=0.005, tendons=limited)
    robot = sn.Robot([segment] * 3, stiffness=sn.Stiffness(0.01), mass=0.05, arcs=4, gravity=GRAVITY)
    random, count = np.random.default_rng(2), 0
    while count < 15:
        angles, bend = random.uniform(0.0, 2.0 * np.pi, 3), random.uniform(0.1, 0.37)
        bends = bend * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        q = np.concatenate([bends, np.full((3, 1), 0.1)], axis=1)
        if not robot.violations(q):
            count += 1
            found = sn.solve(robot, sn.Target(robot.shape(q).tip[:3, 3]), max_starts=1, time=20.0)
            assert found.solved
            assert robot.excess(found.q) == 0.0


def test_what_cannot_be_reached_is_not_solved() -> None:
    far = sn.solve(arm(), sn.Target((0.0, 0.0, 0.5)), time=0.2)
    assert not far.solved
    assert present(far.worst).constraint == "position"
    assert far.binding == ()
    assert f"{far.position_error:.4g}" in str(far.explain(time=0.05)), "the loaded body is what misses the target"


def pulled(most: float, **more: Any) -> sn.Robot:
    """A robot whose tendons may be pulled by so much."""
    tendons = sn.Tendons(3, 0.004, stiffness=400.0, tension=(0.0, most))
    segment = sn.Segment(0.1, max_bend=2.0, radius=0.005, tendons=tendons)
    own: dict[str, Any] = {"stiffness": sn.Stiffness(0.01), "mass": 0.05, "arcs": 4, "gravity": GRAVITY, **more}
    return sn.Robot([segment] * 3, **own)


def test_tensions_under_load_are_within_their_limits() -> None:
    """Of two shapes that meet a target one may need less tension: limits lead to it, from where they are violated."""
    free = pulled(1e3)
    target = sn.Target(free.shape(Q).tip[:3, 3])
    found = sn.solve(free, target, initial=Q)
    assert found.solved
    most = max(present(found.tensions).values())
    alone = max(free.to_actuators(found.q))
    assert most > 0.0
    assert alone > 0.0
    less, more = pulled(0.9 * most), pulled(1.1 * most)
    assert sn.check(more, found.q, None, target).ok
    assert not sn.check(less, found.q, None, target).ok
    held = sn.solve(less, target, initial=Q, time=20.0, max_starts=1)
    assert held.solved, held
    assert held.verify().ok
    assert 0.9**2 * most < max(present(held.tensions).values()) <= 0.9 * most * (1.0 + 1e-9)


@with_each("share", [0.99, 0.95])
def test_a_drive_that_meets_the_target_beyond_a_limit_is_no_solution(share: float) -> None:
    """The first drive is as near to the target as it must be, and needs more tension than there may be."""
    shape = pulled(np.inf).shape(Q)
    robot = pulled(share * float(shape.tensions.max()))
    assert robot.excess(Q) > 0.0
    found = sn.solve(robot, sn.Target(shape.tip[:3, 3]), initial=Q, time=20.0, max_starts=3)
    assert found.solved
    assert found.verify().ok


def test_where_no_body_is_at_rest_that_is_said() -> None:
    with pytest.warns(sn.SuspiciousInput, match="hangs like a thread"):
        found = sn.solve(arm(payload=sn.Payload(1e8)), sn.Target((0.1, 0.05, 0.2)), time=0.05)
    assert not found.solved
    assert found.position_error is None
    assert found.worst is None
    assert found.sentence.endswith("no stable equilibrium under its loads was found")
    json.dumps(found.to_dict(), allow_nan=False)


JOINTS = [
    sn.Revolute((0, 1, 0), (-1.5, 1.5), (0, 0, 0.05), name="tilt", body=[((0, 0, 0), (0, 0, 0.03), 0.02)]),
    sn.Prismatic((0, 0, 1), (0, 0.1), sn.pose((0.01, 0, 0.05), direction=(0.2, 0.1, 1)), name="feed"),
]


@pytest.mark.parametrize("lines", [None, sn.Tendons(3, 0.004), sn.Tendons(3, 0.004, stiffness=900.0, tension=(0, 30))])
def test_on_joints_the_body_hangs_as_it_does_on_the_base_that_they_make(lines: sn.Tendons | None) -> None:
    segments = [sn.Segment(0.1, max_bend=2.0, radius=0.005, tendons=lines, stiffness=sn.Stiffness(0.02), mass=0.05)] * 2
    robot = sn.Robot(segments, joints=JOINTS, arcs=3, gravity=GRAVITY, payload=sn.Payload(0.01))
    q, joints, ends = Q[:2] * [0.5, 0.5, 1.0], np.array([0.7, 0.03]), np.array([0.5, 0.06])
    alone, arcs = robot.arm_at((joints, q))
    shape, other = robot.shape((joints, q)), alone.shape(arcs)
    np.testing.assert_allclose(shape.tip, other.tip, atol=1e-12)
    np.testing.assert_allclose(shape.tensions, other.tensions, atol=1e-9)
    goal = robot.shape((ends, q * [0.8, 1.2, 1.0])).tip
    target = sn.Target(goal[:3, 3], direction=goal[:3, 2])
    balls = [sn.Sphere(goal[:3, 3] + [0.06, 0.05, 0.03], 0.02)]
    solution = sn.solve(robot, target, balls, initial=(joints, q))
    assert solution.solved
    assert solution.verify().ok
    alone, arcs = robot.arm_at(solution.configuration)
    assert np.linalg.norm(alone.shape(arcs).tip[:3, 3] - goal[:3, 3]) <= 1e-4 * robot.mean_length * 1.01
    made = sn.Solver(robot, balls).step((joints, q), (0.02, 0.01, 0.0), 0.1)
    assert made.proved
    moved = robot.shape(made.configuration).tip[:3, 3] - shape.tip[:3, 3]
    np.testing.assert_allclose(moved, [0.002, 0.001, 0.0], atol=1e-4)
    motion = sn.plan(robot, (joints, q), solution, balls)
    assert motion.solved
    assert all(each.ok for each in motion.verify())
