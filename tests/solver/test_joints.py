"""Robots with joints before the segments, judged by the kinematics of the benchmarks."""

import json
import math
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.kinematics import body_places, moving, tip_poses
from benchmarks.judges.self_collision import look
from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import CLEARANCES, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, PROVED_BOUND
from sinuous.kernels.chain.rates import MOTION_RATES_WIDTH, measure_rates
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute
from sinuous.solver.certificates.steps import Prover
from tests.helpers import kernel_problem, present

PANDA = [
    (0.0, 0.333, 0.0, (-2.8973, 2.8973)),
    (0.0, 0.0, -0.5 * math.pi, (-1.7628, 1.7628)),
    (0.0, 0.316, 0.5 * math.pi, (-2.8973, 2.8973)),
    (0.0825, 0.0, 0.5 * math.pi, (-3.0718, -0.0698)),
    (-0.0825, 0.384, -0.5 * math.pi, (-2.8973, 2.8973)),
    (0.0, 0.0, 0.5 * math.pi, (-0.0175, 3.7525)),
    (0.088, 0.0, 0.5 * math.pi, (-2.8973, 2.8973)),
]
"""Of each joint a and d (m), alpha (rad) of modified Denavit-Hartenberg parameters, and limits (rad)."""

CAPSULES = [
    [((0.0, 0.0, -0.19), (0.0, 0.0, 0.0), 0.07)],
    [((0.0, 0.0, -0.06), (0.0, 0.0, 0.06), 0.07)],
    [((0.0, 0.0, -0.15), (0.0, 0.0, 0.0), 0.065)],
    [((0.0, 0.0, -0.05), (0.0, 0.0, 0.05), 0.065)],
    [((0.0, 0.0, -0.29), (0.0, 0.0, -0.14), 0.065)],
    [((0.0, 0.0, -0.08), (0.0, 0.0, 0.01), 0.06)],
    [((0.0, 0.0, 0.02), (0.0, 0.0, 0.08), 0.06)],
]


def rng_of(name: str) -> np.random.Generator:
    return np.random.default_rng(zlib.crc32(name.encode()))


def drawn(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """A random configuration within all limits."""
    arcs = [(*rng.uniform(-1.0, 1.0, 2), rng.uniform(*segment.length)) for segment in robot.segments]
    values = [rng.uniform(*joint.limits) for joint in moving(robot.joints)]
    return robot.with_joints(np.array(arcs).reshape(-1, 3), values)


def tip_of(robot: sn.Robot, q: Floats) -> Floats:
    return tip_poses(robot, q[None])[0]


def self_gap_of(robot: sn.Robot, q: Floats) -> float:
    return float(look(robot, q[None]).least[0])


def clearance_of(robot: sn.Robot, q: Floats, scene: sn.Scene) -> float:
    return float(least_clearance(robot, scene, q[None])[0])


def panda(bodies: bool) -> sn.Robot:
    joints: list[Joint] = []
    for i, (a, d, alpha, limits) in enumerate(PANDA):
        c, s = math.cos(alpha), math.sin(alpha)
        origin = [[1.0, 0.0, 0.0, a], [0.0, c, -s, -d * s], [0.0, s, c, d * c], [0.0, 0.0, 0.0, 1.0]]
        joints.append(Revolute((0.0, 0.0, 1.0), limits, origin, body=CAPSULES[i] if bodies else ()))
    return sn.Robot(joints=[*joints, Fixed((0.0, 0.0, 0.107))])


def bronchoscope() -> sn.Robot:
    """Roll and feed, then three segments; the joints carry a shaft."""
    segments = [sn.Segment((18.0, 22.0), 1.8, radius=2.0)] * 3
    roll = Revolute((0.0, 0.0, 1.0), (-3.0, 3.0), name="roll")
    feed = Prismatic((0.0, 0.0, 1.0), (-20.0, 60.0), name="feed", body=[((0.0, 0.0, -40.0), (0.0, 0.0, -6.0), 3.0)])
    return sn.Robot(segments, joints=[roll, feed])


def six_axes() -> sn.Robot:
    """Six axes that are no special ones, and three segments."""
    rng = rng_of("six axes")
    joints: list[Joint] = []
    for i in range(6):
        origin = sn.pose(np.array((0.0, 0.0, 0.2)) + rng.uniform(-0.1, 0.1, 3), direction=rng.normal(size=3))
        kind: type[Revolute | Prismatic] = Prismatic if i == 2 else Revolute
        joints.append(kind(rng.normal(size=3), (-0.1, 0.3) if i == 2 else (-2.0, 2.5), origin))
    return sn.Robot([sn.Segment((0.08, 0.12), 2.0)] * 3, joints=joints)


ROBOTS: dict[str, Callable[..., sn.Robot]] = {"panda": panda, "bronchoscope": bronchoscope, "six axes": six_axes}


def made(name: str) -> sn.Robot:
    return panda(bodies=False) if name == "panda" else ROBOTS[name]()


@pytest.mark.parametrize("name", ROBOTS)
def test_jacobians_are_differences_of_poses(name: str) -> None:
    robot, rng = made(name), rng_of(name)
    q, h = drawn(robot, rng), 1e-6
    joints, arcs = robot.split(q)
    jacobian, values = robot.jacobian(arcs, joints=joints), np.concatenate([joints, arcs.ravel()])
    np.testing.assert_array_equal(jacobian, robot.jacobian(q))
    for i, column in enumerate(jacobian.T):
        ends = []
        for step in (h, -h):
            moved = values + step * (np.arange(len(values)) == i)
            ends.append(robot.tip(moved[len(joints) :].reshape(-1, 3), moved[: len(joints)])[:3, 3])
        np.testing.assert_allclose(column[3:], (ends[0] - ends[1]) / (2.0 * h), atol=1e-6 * max(1.0, robot.longest))


@pytest.mark.parametrize("name", ROBOTS)
def test_poses_that_are_reached_are_found(name: str) -> None:
    robot, rng = made(name), rng_of(name)
    solver = sn.Solver(robot)
    for _ in range(12):
        goal = tip_of(robot, drawn(robot, rng))
        found = solver.solve(sn.Target(goal[:3, 3], rotation=goal[:3, :3]))
        assert found.solved, found
        assert robot.excess(found.configuration) <= 1e-9
        there = tip_of(robot, found.configuration)
        assert np.linalg.norm(there[:3, 3] - goal[:3, 3]) <= 1.01e-3 * robot.mean_length
        assert found.verify().ok


def test_what_is_beyond_all_links_is_proved_out_of_reach() -> None:
    robot = panda(bodies=False)
    assert sn.solve(robot, sn.Target((0.0, 0.0, 5.0))).status is sn.Status.OUT_OF_REACH
    straight_up = 0.333 + 0.316 + 0.384 + 0.107
    assert straight_up < robot.longest < straight_up + 4.0 * 0.0825 + 0.2


def test_bodies_among_obstacles_are_proved_clear_and_no_claim_is_false() -> None:
    robot, rng = panda(bodies=True), rng_of("bodies")
    solved = 0
    for _ in range(10):
        goal = tip_of(robot, drawn(robot, rng))
        centers = rng.uniform((-0.7, -0.7, 0.1), (0.7, 0.7, 1.0), (12, 3))
        centers = centers[np.linalg.norm(centers[:, :2], axis=1) > 0.25]
        scene = sn.Scene([sn.Sphere(center, 0.06) for center in centers])
        found = sn.solve(robot, sn.Target(goal[:3, 3], rotation=goal[:3, :3]), scene, time=1.0)
        if found.solved:
            solved += 1
            assert 0.0 < present(found.clearance) <= clearance_of(robot, found.configuration, scene) + 1e-3
            assert 0.0 < present(found.self_clearance) <= self_gap_of(robot, found.configuration) + 1e-2
            assert found.verify().ok
    assert solved >= 3


def with_bodies(name: str) -> sn.Robot:
    """The Panda with bodies, or four links whose bodies lie off their axes, a slide among them, and a segment."""
    if name == "panda":
        return panda(bodies=True)
    body = [((0.05, 0.0, 0.1), (0.0, 0.1, 0.5), 0.04), ((0.0, -0.2, 0.4), (0.0, -0.2, 0.4), 0.03)]
    joints = [
        Revolute((0.0, 0.0, 1.0), (-3.0, 3.0), body=body),
        Prismatic((0.6, 0.0, 0.8), (-0.1, 0.3), (0.0, 0.1, 0.5), body=body),
        Revolute((1.0, 0.0, 0.0), (-2.5, 2.5), (0.1, 0.0, 0.3), body=body),
        Revolute((0.0, 1.0, 0.0), (-2.5, 2.5), (0.0, 0.0, 0.4), body=body[1:]),
    ]
    return sn.Robot([sn.Segment((0.3, 0.5), 2.0, radius=0.03)], joints=joints)


@pytest.mark.parametrize("name", ["panda", "bodies"])
def test_motions_that_are_proved_clear_are_so_and_by_as_much(name: str) -> None:
    robot, rng, proved = with_bodies(name), rng_of(f"motions {name}"), 0
    centers = rng.uniform((-0.9, -0.9, 0.0), (0.9, 0.9, 1.2), (6, 3))
    scene = sn.Scene([sn.Sphere(center, 0.05) for center in centers])
    prover = Prover(robot, scene.snapshot())
    for _ in range(12):
        p = drawn(robot, rng)
        ends = np.stack([p, p + 0.3 * rng.uniform() * (drawn(robot, rng) - p)])
        answer = prover.prove(ends, slack=0.1)[0]
        if answer[VERDICT] != CLEAR:
            continue
        proved += 1
        for t in np.linspace(0.0, 1.0, 9):
            q = (1.0 - t) * ends[0] + t * ends[1]
            assert clearance_of(robot, q, scene) >= answer[CLEARANCES + PROVED_BOUND] - 1e-9
            assert self_gap_of(robot, q) >= answer[CLEARANCES + CLEARANCES_WIDTH + PROVED_BOUND] - 1e-9
    assert proved >= 3


def test_no_place_of_a_link_travels_farther_than_its_bound() -> None:
    """Of a long link, the last one of two, beyond which nothing is."""
    first = Revolute((0.0, 0.0, 1.0), (-3.0, 3.0))
    body = [((0.0, 0.0, 0.0), (0.0, 2.0, 0.5), 0.1)]
    robot = sn.Robot(joints=[first, Revolute((1.0, 0.0, 0.0), (-3.0, 3.0), sn.pose((0.0, 0.0, 1.0)), body=body)])
    rng = rng_of("travel")
    limits = kernel_problem(robot, sn.Target((0.0, 1.0, 1.0))).limits
    for _ in range(5):
        one, other = drawn(robot, rng), drawn(robot, rng)
        bound = measure_rates(limits, one, other, np.zeros((len(one), MOTION_RATES_WIDTH)))
        way = body_places(robot, one + np.linspace(0.0, 1.0, 40)[:, None, None] * (other - one), 40)[-1][1]
        travelled = np.linalg.norm(np.diff(way, axis=0), axis=-1).sum(axis=0).max()
        assert 0.0 < travelled <= bound


def test_a_plan_moves_all_links_past_obstacles() -> None:
    robot, rng = panda(bodies=True), rng_of("plan")
    centers = np.array([(0.4, 0.0, 0.5), (0.45, 0.2, 0.3), (-0.3, 0.4, 0.6)])
    scene = sn.Scene([sn.Sphere(center, 0.05) for center in centers])
    ends: list[Floats] = []
    while len(ends) < 2:
        q = drawn(robot, rng)
        if clearance_of(robot, q, scene) > 0.02 and self_gap_of(robot, q) > 0.02:
            ends.append(q)
    motion = sn.plan(robot, ends[0], ends[1], scene, time=5.0)
    assert motion.solved, motion
    for one, other in zip(motion.configuration[:-1], motion.configuration[1:], strict=True):
        for share in np.linspace(0.0, 1.0, 9):
            q = (1.0 - share) * one + share * other
            assert clearance_of(robot, q, scene) > -1e-9
            assert self_gap_of(robot, q) > -1e-9
    assert motion.verify().ok


def test_links_that_overlap_are_not_solved_and_touching_ones_may_be_allowed() -> None:
    """The third link folds back onto the first."""
    body = [((0.0, 0.0, 0.05), (0.0, 0.0, 0.95), 0.08)]

    def arm(*touches: str) -> sn.Robot:
        first = Revolute((1.0, 0.0, 0.0), (-0.1, 0.1), name="a", body=body)
        knuckle = [((0.0, 0.0, 0.0), (0.0, 0.0, 0.05), 0.02)]
        second = Revolute((1.0, 0.0, 0.0), (1.5, 1.65), (0.0, 0.0, 1.0), name="b", body=knuckle)
        third = Revolute((1.0, 0.0, 0.0), (1.5, 3.0), (0.0, 0.0, 0.1), name="c", body=body, touches=touches)
        return sn.Robot(joints=[first, second, third])

    goal = tip_of(arm(), arm().with_joints(None, (0.0, 1.57, 1.57)))
    target = sn.Target(goal[:3, 3], rotation=goal[:3, :3])
    held = sn.solve(arm(), target)
    assert not held.solved
    assert held.verify().self_clearance is not None
    assert sn.solve(arm("a"), target).solved


def test_limits_of_tendons_hold_behind_joints() -> None:
    segments = [sn.Segment(20.0, 1.8, radius=2.0, tendons=sn.Tendons(3, 1.5, displacement=(-1.5, 1.5)))] * 3
    robot = sn.Robot(segments, joints=[Revolute((0.0, 0.0, 1.0), (-3.0, 3.0)), Prismatic((0.0, 0.0, 1.0), (0.0, 60.0))])
    rng, solver = rng_of("limits"), sn.Solver(robot)
    for _ in range(10):
        q = drawn(robot, rng)
        q[-3:, :2] *= 0.3
        if robot.excess(q) > 0.0:
            continue
        goal = tip_of(robot, q)
        found = solver.solve(sn.Target(goal[:3, 3], direction=goal[:3, 2]))
        assert found.solved, found
        assert np.abs(robot.to_actuators(found.configuration)).max() <= 1.5 + 1e-9


def test_answers_have_joints_beside_segments(tmp_path: Path) -> None:
    robot = bronchoscope()
    goal = tip_of(robot, robot.with_joints([[0.0, 0.0, 20.0]] * 3, (0.4, 20.0)))
    found = sn.solve(robot, sn.Target(goal[:3, 3], direction=goal[:3, 2]))
    assert found.solved
    assert found.q.shape == (3, 3)
    assert found.joints.shape == (2,)
    np.testing.assert_allclose(robot.tip(found.q, found.joints), found.tip, atol=1e-12)
    pair = (found.joints, found.q)
    assert sn.solve(robot, sn.Target(goal[:3, 3]), initial=pair).solved
    read = sn.Solution.from_dict(json.loads(json.dumps(found.to_dict())), found.problem)
    np.testing.assert_array_equal(read.configuration, found.configuration)
    motion = sn.plan(robot, pair, (found.joints + np.array((0.3, 5.0)), found.q))
    assert motion.solved
    assert motion.joints.shape == (len(motion.times), 2)
    assert motion.q.shape == (len(motion.times), 3, 3)
    motion.to_csv(tmp_path / "motion.csv")
    header = (tmp_path / "motion.csv").read_text().splitlines()[0].split(",")
    assert header[:5] == ["time", "roll", "feed", "s1.bend_x", "s1.bend_y"]
    motion.save(tmp_path / "motion.json")
    again = sn.load(tmp_path / "motion.json")
    np.testing.assert_array_equal(again.configuration, motion.configuration)
    step = sn.Solver(robot).step(pair, (1.0, 0.0, 0.0), 0.1)
    assert step.joints.shape == (2,)
    assert step.q.shape == (3, 3)
    many = sn.Solver(robot).solve_many([goal[:3, 3], goal[:3, 3]], initial=pair)
    assert many.joints.shape == (2, 2)
    assert many.q.shape == (2, 3, 3)


def test_what_holds_back_has_the_name_of_its_joint_or_link() -> None:
    reach = sn.Target((0.0, 0.0, 140.0))
    held = sn.solve(bronchoscope(), reach, time=0.3)
    assert "joint 'feed': at its limit of 60" in str(held.explain(0.5))
    assert any(each.change == "limits of joint 'feed'" for each in held.explain(1.0).remedies)
    shaft = sn.Box((0.0, 0.0, -8.0), (4.0, 4.0, 4.0))
    start = [0.1, 0.0], [[0.1, 0.0, 20.0]] * 3
    blocked = sn.Motion(bronchoscope(), [start, ([0.2, 5.0], start[1])], [shaft])
    assert str(blocked.worst).startswith("step 1, at time 0.25: link 'feed' lacks")
    assert present(blocked.worst).segment == "feed"
    found = blocked.verify()[-1]
    assert found.segment == "feed"
    assert present(found.place).segment == "feed"
    said = sn.plan(bronchoscope(), ([9.0, 0.0], start[1]), start).worst
    assert str(said).startswith("joint 'roll' is 6 beyond its limit")


def test_targets_of_segments_count_segments() -> None:
    robot = bronchoscope()
    joints, q = [0.3, 10.0], np.array([[0.3, 0.1, 20.0], [0.2, -0.4, 19.0], [0.1, 0.2, 21.0]])
    targets = [sn.Target(robot.forward(q, joints)[k - 4, :3, 3], segment=k) for k in (1, 2)]
    for found in (sn.solve(robot, targets), sn.solve(robot, [targets[0], targets[1].changed(segment="s2")])):
        assert found.solved
        assert found.verify().ok
        for k in (1, 2):
            goal = targets[k - 1].position
            miss = robot.forward(found.q, found.joints)[k - 4, :3, 3] - present(goal)
            assert np.linalg.norm(miss) <= 1e-4 * robot.mean_length * 1.001
    many = sn.Solver(robot).solve_many([targets] * 2)
    assert many.solved.all()
    step = sn.Solver(robot).step((joints, q), target=targets, dt=0.1)
    np.testing.assert_allclose(step.configuration, robot.with_joints(q, joints), atol=1e-9)
