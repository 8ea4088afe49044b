"""The proof between configurations, against dense sampling and by its laws.

How obstacles move in a step, as kernels read it, against poses that SciPy interpolates.
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.certificate.drift import BEGIN, OWN_AXES, TURN, TURNED, VELOCITY, measure_paces
from sinuous.kernels.certificate.query import ANSWER_WIDTH, CLEARANCES, UNTIL, VERDICT, certify_motions
from sinuous.kernels.certificate.self_proof import passed_over
from sinuous.kernels.certificate.sweep import (
    CLEARANCES_WIDTH,
    DRIFT_WIDTH,
    FRACTION,
    LEAST_SEEN,
    PROVED_BOUND,
    SEGMENT,
    WHEN,
    sweep_size,
)
from sinuous.model.robot import robot_group
from sinuous.solver.certificates.steps import Drifts
from tests.helpers import Floats, random_pose
from tests.kernels.certificate.motions import Case, random_case, sampled, sampled_case, shape

ITSELF = CLEARANCES + CLEARANCES_WIDTH
SLACK = 0.1


def prove(
    case: Case,
    slack: float = SLACK,
    seconds: float = 60.0,
    knots: Floats | None = None,
    clear: float = 0.0,
    finest: float = 1e-7,
) -> Floats:
    """Answers (T - 1, 14) about the motion of a case, or about one with other knots (T, n, 3)."""
    path = np.stack([case.q0, case.q1]) if knots is None else knots
    answers = np.full((len(path) - 1, ANSWER_WIDTH), np.nan)
    terms = float(case.robot.mount), slack, finest * case.robot.mean_length, seconds, 0.0
    snapshot = case.scene.snapshot()
    workspace = np.full(sweep_size(len(case.robot), len(snapshot)), np.nan)
    known = np.full((len(path), 2), clear)
    still = np.empty((len(path) - 1, 0, DRIFT_WIDTH))
    certify_motions(robot_group(case.robot), snapshot.group.copy(), path, known, still, terms, workspace, answers)
    return answers


@pytest.mark.parametrize(("slack", "clear"), [(1.0, 0.0), (SLACK, 0.0), (0.5, 1e-6), (0.5, 0.05), (0.5, 1e3)])
def test_the_proof_agrees_with_dense_sampling(slack: float, clear: float) -> None:
    """Whatever is said of the clearances of the ends: these only say how tight bounds have to be.

    Sampled clearances are at least the true ones, so that tightness needs room.
    """
    verdicts = {CLEAR: 0, TOUCHING: 0, UNDECIDED: 0}
    for seed in range(45):
        case = random_case(seed)
        (answer,) = prove(case, slack, clear=clear)
        clearance, gap = sampled_case(seed)
        verdicts[int(answer[VERDICT])] += 1
        if answer[VERDICT] == CLEAR:
            assert min(clearance, gap) > 0.0, seed
            assert answer[CLEARANCES + PROVED_BOUND] <= clearance + 1e-9, seed
            assert answer[ITSELF + PROVED_BOUND] <= gap + 1e-9, seed
            assert answer[UNTIL] == 1.0
            if slack == SLACK and math.isfinite(clearance) and case.robot.mount == 0.0:
                assert answer[CLEARANCES + PROVED_BOUND] >= 0.95 * (1.0 - SLACK) * clearance - 0.03, seed
        else:
            assert answer[UNTIL] < 1.0
            assert min(clearance, gap) < 0.02, seed
    assert verdicts[CLEAR] > 16
    assert verdicts[TOUCHING] > 4
    assert verdicts[UNDECIDED] < 3


def test_an_overlap_is_where_it_is_said_to_be() -> None:
    looked = 0
    for seed in range(75):
        case = random_case(seed)
        (answer,) = prove(case)
        seen = answer[CLEARANCES : CLEARANCES + CLEARANCES_WIDTH]
        if answer[VERDICT] != TOUCHING or seen[LEAST_SEEN] >= 0.0:
            continue
        looked += 1
        k, t = int(seen[SEGMENT]), seen[WHEN]
        q = (1.0 - t) * case.q0 + t * case.q1
        q[k] *= seen[FRACTION]
        place = case.robot.forward(q)[k, :3, 3]
        assert case.scene.distance(place) - case.robot.radii[k] < 1e-9
        assert q[: k + 1, 2].sum() >= case.robot.mount - 1e-9
    assert looked > 5


def test_a_motion_cut_in_two_is_clear_when_both_parts_are() -> None:
    for seed in range(60):
        case = random_case(seed)
        share = np.random.default_rng(seed).uniform(0.1, 0.9)
        middle = (1.0 - share) * case.q0 + share * case.q1
        (whole,), parts = prove(case), prove(case, knots=np.stack([case.q0, middle, case.q1]))
        if UNDECIDED not in (whole[VERDICT], *parts[:, VERDICT]):
            assert (whole[VERDICT] == CLEAR) == bool((parts[:, VERDICT] == CLEAR).all()), seed
        if whole[VERDICT] == CLEAR:
            low = parts[:, CLEARANCES + PROVED_BOUND].min()
            assert low == pytest.approx(whole[CLEARANCES + PROVED_BOUND], rel=2.5 * SLACK) or case.robot.mount > 0.0


def test_gaps_that_are_passed_over_have_the_same_bound_backwards() -> None:
    for seed in range(10):
        case = random_case(seed)
        one, other = (passed_over(case.robot.limits, *ends) for ends in ((case.q0, case.q1), (case.q1, case.q0)))
        assert one == other


def test_it_does_not_matter_where_robot_and_obstacles_stand() -> None:
    rng = np.random.default_rng(3)
    for seed in range(40):
        case = random_case(seed)
        pose = random_pose(rng, 2.0)
        balls = [sn.Sphere(rng.uniform(-3, 3, 3), 0.4) for _ in range(6)]
        moved = [sn.Sphere(pose[:3, :3] @ ball.center + pose[:3, 3], ball.radius) for ball in balls]
        there = case._replace(robot=case.robot.changed(base=pose), scene=sn.Scene(moved))
        (one,), (other,) = prove(case._replace(scene=sn.Scene(balls)), 1.0), prove(there, 1.0)
        assert one[VERDICT] == other[VERDICT]
        assert one[UNTIL] == pytest.approx(other[UNTIL], abs=1e-6)


@pytest.mark.parametrize("ends", [(-0.6, 0.6), (-0.3, 0.8), (-1.9, 0.1)])
@pytest.mark.parametrize("deep", [1e-2, 1e-3, 1e-5])
def test_who_touches_a_wall_only_on_the_way_is_not_clear(ends: tuple[float, float], deep: float) -> None:
    """The tip of an arc that swings past its straight shape is accelerated as much as the bound of that says."""
    robot = sn.Robot.uniform(1, 1.0, 2.0, radius=0.05)
    q0, q1 = (np.array([[bend, 0.0, 1.0]]) for bend in ends)
    for gap in (-deep, deep):
        wall = sn.Scene([sn.HalfSpace((0.0, 0.0, 1.05 + gap), (0.0, 0.0, -1.0))])
        for slack in (1.0, SLACK):
            assert (prove(Case(robot, wall, q0, q1), slack)[0, VERDICT] == CLEAR) == (gap > 0.0)


@pytest.mark.parametrize("seed", [1, 349, 1203, 1287, 2383])
def test_who_runs_through_itself_only_on_the_way_is_not_clear(seed: int) -> None:
    """Of random motions those, among others, that a bound without what moves meanwhile takes for clear."""
    robot, rng = sn.Robot.uniform(5, 1.0, 4.5, radius=0.08), np.random.default_rng(seed)
    case = Case(robot, sn.Scene(), shape(robot, rng), shape(robot, rng))
    assert min(sampled(case._replace(q0=q, q1=q))[1] for q in (case.q0, case.q1)) > 0.0
    assert sampled(case)[1] < -0.01
    assert prove(case, 1.0)[0, VERDICT] != CLEAR


def test_the_part_within_the_mount_may_touch_what_it_stands_in() -> None:
    floor = sn.Scene([sn.HalfSpace((0, 0, 0.25), (0, 0, 1))])
    robot = sn.Robot.uniform(2, (0.5, 1.0), 0.8, radius=0.05, mount=0.32)
    q0, q1 = np.array([[0.1, 0, 0.6], [0.2, 0.1, 0.7]]), np.array([[0.2, 0, 0.9], [-0.3, 0.4, 0.9]])
    assert prove(Case(robot, floor, q0, q1))[0, VERDICT] == CLEAR
    bare = robot.changed(mount=0.0)
    assert prove(Case(bare, floor, q0, q1))[0, VERDICT] == TOUCHING


def test_the_proof_ends_by_its_deadline() -> None:
    case = random_case(0)
    knots = np.stack([case.q0, case.q1] * 200)
    answers = prove(case, seconds=0.0, knots=knots)
    assert (answers[-100:, VERDICT] == UNDECIDED).all()
    assert (answers[-100:, UNTIL] == 0.0).all()


@pytest.mark.parametrize("size", [1e8, 1e12])
def test_no_motion_is_clear_of_huge_obstacles_that_it_overlaps(size: float) -> None:
    """Also of spheres, whose balls are asked first, and of what nobody can reach by a hair.

    Where rounding hides the gap everything is halved until it is `finest`, and what is clear is clear before that.
    """
    robot = sn.Robot.uniform(2, (0.9, 1.1), 0.8, radius=0.05)
    q0, q1 = np.array([[0.0, 0, 0.9]] * 2), np.array([[0.0, 0, 1.1]] * 2)
    for deep in (0.3, 1.0, 3.0):
        at = size + 0.05 - deep * 1e-16 * size
        for obstacle in (
            sn.Sphere((at, 0, 1.0), size),
            sn.Capsule((at, 0, 0.5), (at, 0, 1.5), size),
            sn.Sphere((0, 0, size + 2.25 - deep * 1e-16 * size), size),
        ):
            assert prove(Case(robot, sn.Scene([obstacle]), q0, q1), 1.0, finest=1e-4)[0, VERDICT] != CLEAR
    clear = sn.Sphere((size + 0.05 + 1e-12 * size, 0, 1.0), size)
    assert prove(Case(robot, sn.Scene([clear]), q0, q1), 1.0, finest=1e-4)[0, VERDICT] == CLEAR


BALL = sn.Sphere((0, 0, 0), 0.1)


def test_drifts_lead_from_pose_to_pose() -> None:
    rng = np.random.default_rng(1)
    moving = []
    for count in (1, 2, 3, 7):
        times = np.sort(rng.uniform(0.0, 5.0, count))
        moving.append(sn.Moving(BALL, times, rng.normal(size=(count, 3)), rng.normal(size=(count, 4))))
        moving.append(sn.Moving(BALL, times, rng.normal(size=(count, 3))))
    drifts = Drifts(sn.Scene(moving).snapshot())
    times = drifts.divided(np.sort(np.concatenate([rng.uniform(-1.0, 6.0, 50), [2.0, 2.0]])))
    rows = drifts.rows(times)
    for e, own in enumerate(moving):
        poses = own.pose(times)
        here, way = rows[:, e, BEGIN : BEGIN + 3], rows[:, e, VELOCITY : VELOCITY + 3]
        turned, turn = rows[:, e, TURNED : TURNED + 9].reshape(-1, 3, 3), rows[:, e, TURN : TURN + 3]
        np.testing.assert_allclose(here, poses[:-1, :3, 3], atol=1e-12)
        np.testing.assert_allclose(here + way, poses[1:, :3, 3], atol=1e-12)
        np.testing.assert_allclose(turned, poses[:-1, :3, :3], atol=1e-12)
        after = turned @ Rotation.from_rotvec(turn).as_matrix()
        np.testing.assert_allclose(after, poses[1:, :3, :3], atol=1e-12)
        still = (times[1:] <= own.times[0]) | (times[:-1] >= own.times[-1]) | (times[1:] == times[:-1])
        assert not way[still].any()
        assert not turn[still].any()
        assert len(own.times) == 1 or (np.linalg.norm(way[~still], axis=1) > 0.0).all()


@pytest.mark.parametrize("seed", range(4))
def test_nothing_comes_nearer_to_what_is_in_reach_faster_than_its_pace(seed: int) -> None:
    rng = np.random.default_rng(seed)
    drifts = np.zeros((1, OWN_AXES + 9))
    begin, velocity, turn, base = rng.normal(size=(4, 3))
    for column, vector in ((BEGIN, begin), (VELOCITY, velocity), (TURN, turn)):
        drifts[0, column : column + 3] = vector
    sweep: Any = SimpleNamespace(paces=np.zeros((1, 5)))
    moved: Any = SimpleNamespace(drifts=drifts)
    most, far = measure_paces(moved, tuple(base), 1.5, sweep)
    at = begin + np.linspace(0.0, 1.0, 50)[:, None, None] * velocity
    away = rng.normal(size=(200, 3))
    within = base + 1.5 * away / np.linalg.norm(away, axis=1)[:, None]
    paces = np.linalg.norm(velocity + np.cross(turn, within - at), axis=-1)
    assert 0.3 * most < paces.max() <= most
    assert np.linalg.norm(at, axis=-1).max() <= far
