"""The proof of motions among obstacles that move, against dense sampling in time by independent distances."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.body.proof import CLEAR, TOUCHING
from sinuous.kernels.certificate.query import CLEARANCES, UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import LEAST_SEEN, PROVED_BOUND, WHEN
from sinuous.measures.obstacles import measure
from sinuous.solver.certificates.steps import Prover
from tests.helpers import Floats, present, random_rotation, refused
from tests.kernels.certificate.motions import random_case, sampled_bodies, shape
from tests.scene.shapes import cube

TIMES, PLACES = 41, 16


class Moved(NamedTuple):
    """A robot among obstacles that move, and its motion: knots (2, n, 3) and their times (2,)."""

    robot: sn.Robot
    scene: sn.Scene
    knots: Floats
    times: Floats


def obstacle(rng: np.random.Generator) -> sn.Sphere | sn.Mesh | sn.Grid | sn.PointCloud | sn.Box | sn.Capsule:
    """Anything small, described about the origin or beside it."""
    center, kind = rng.uniform(-0.3, 0.3, 3), rng.integers(6)
    if kind == 0:
        return sn.Box(center, rng.uniform(0.1, 0.8, 3), random_rotation(rng))
    if kind == 1:
        return sn.Capsule(center, center + rng.uniform(-0.5, 0.5, 3), 0.1)
    if kind == 2:
        vertices, faces = cube()
        return sn.Mesh(0.3 * np.asarray(vertices) + center, faces)
    if kind == 3:
        return sn.PointCloud(rng.uniform(-0.4, 0.4, (30, 3)), 0.05)
    if kind == 4:
        return sn.Grid(rng.random((3, 3, 3)) > 0.5, center, 0.15)
    return sn.Sphere(center, float(rng.uniform(0.05, 0.5)))


@cache
def moving_case(seed: int) -> Moved:
    """Some of the obstacles move, some turn, some stand still; and sometimes a room around all of it turns."""
    case, rng = random_case(seed), np.random.default_rng(seed + 1000)
    length, obstacles = case.robot.mean_length, list[sn.Moving]()
    for _ in range(int(rng.integers(1, 5))):
        count = int(rng.integers(1, 4))
        times = np.sort(rng.uniform(-0.2, 1.2, count))
        places = rng.uniform(-1.0, 1.0, (count, 3)) * length
        turns = rng.normal(size=(count, 4)) if rng.random() < 0.6 else None
        obstacles.append(sn.Moving(obstacle(rng), times, places, turns))
    if rng.random() < 0.2:
        room = sn.Box((0, 0, 0), np.full(3, 3.0 * length), inside=True)
        obstacles.append(sn.Moving(room, [0, 1], rng.normal(size=(2, 3)), rng.normal(size=(2, 4))))
    begin = float(rng.uniform(0.0, 0.4))
    times = np.array([begin, begin + float(rng.choice([0.02, 0.2, 0.6]))])
    knots = np.stack([case.q0, case.q1 if rng.random() < 0.8 else case.q0])
    return Moved(case.robot, sn.Scene([case.scene, *obstacles]), knots, times)


def clearances_at(case: Moved, shares: Floats) -> Floats:
    """Least clearance (m,) over many places of the body at shares (m,), by distances that share no code.

    An obstacle that moves stays where it is described, and the places are moved the other way.
    """
    part = shares[:, None, None]
    q = (1.0 - part) * case.knots[0] + part * case.knots[1]
    places, thick, free = sampled_bodies(case.robot, q, PLACES)
    when = (1.0 - shares) * case.times[0] + shares * case.times[1]
    least = np.full(free.shape, math.inf)
    for one in case.scene.obstacles:
        seen, still = places, one
        if isinstance(one, sn.Moving):
            seen, still = seen_from(one.pose(when), places), one.obstacle
        least = np.minimum(least, measure(still, seen.reshape(-1, 3)).reshape(free.shape) - thick)
    return np.asarray(np.where(free, least, math.inf).min(axis=1))


def seen_from(poses: Floats, places: Floats) -> Floats:
    """Places (m, k, 3) in the frames of poses (m, 4, 4)."""
    return np.asarray((places - poses[:, None, :3, 3]) @ poses[:, :3, :3])


def sampled(case: Moved, until: float = 1.0) -> float:
    return float(clearances_at(case, np.linspace(0.0, until, TIMES)).min())


@cache
def least_of(seed: int) -> float:
    return sampled(moving_case(seed))


@cache
def prover_of(seed: int) -> Prover:
    case = moving_case(seed)
    return Prover(case.robot.changed(self_collision="allow"), case.scene.snapshot())


def prove(seed: int, slack: float, seconds: float = 20.0) -> Floats:
    case = moving_case(seed)
    answer: Floats = prover_of(seed).prove(case.knots, slack, seconds, case.times)[0]
    return answer


@pytest.mark.parametrize("slack", [1.0, 0.1])
def test_the_proof_agrees_with_dense_sampling_in_time(slack: float) -> None:
    clear = touching = undecided = 0
    for seed in range(18):
        case = moving_case(seed)
        answer, least = prove(seed, slack), least_of(seed)
        if answer[VERDICT] == CLEAR:
            clear += 1
            assert least > 0.0, seed
            assert answer[CLEARANCES + PROVED_BOUND] <= least + 1e-9, seed
            if slack < 1.0 and answer[CLEARANCES + LEAST_SEEN] < math.inf:  # as tight as was asked for
                assert answer[CLEARANCES + PROVED_BOUND] >= 0.89 * answer[CLEARANCES + LEAST_SEEN] - 1e-5, seed
                assert clearances_at(case, answer[[CLEARANCES + WHEN]])[0] <= answer[CLEARANCES + LEAST_SEEN] + 0.05, (
                    seed
                )
            continue
        touching += answer[VERDICT] == TOUCHING
        undecided += answer[VERDICT] != TOUCHING
        assert answer[UNTIL] < 1.0
        assert least < 0.02, seed
        if answer[UNTIL] > 0.0:
            assert sampled(case, 0.999 * float(answer[UNTIL])) > 0.0, seed
    assert clear > 8
    assert touching > 5
    assert undecided < 3


def test_an_overlap_is_when_and_where_it_is_said_to_be() -> None:
    looked = 0
    for seed in range(50):
        if looked > 10:
            break
        case = moving_case(seed)
        seen = prove(seed, 0.1)[CLEARANCES:]
        if not seen[LEAST_SEEN] < 0.0:
            continue
        looked += 1
        assert clearances_at(case, seen[[WHEN]])[0] < 0.05 * case.robot.mean_length / len(case.robot), seed
    assert looked > 10


def test_the_time_of_a_motion_decides() -> None:
    robot = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05)
    ball = sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2], [(2, 0, 1), (0, 0, 1), (-2, 0, 1)])
    knots = np.array([[[0.0, 0.0, 1.0]] * 2] * 2)
    assert sn.Motion(robot, knots, [ball], times=[0.0, 0.8]).solved
    assert not sn.Motion(robot, knots, [ball], times=[0.0, 0.9]).solved
    assert not sn.Motion(robot, knots, [ball], times=[0.0, 5.0]).solved
    assert sn.Motion(robot, knots, [ball], times=[1.2, 5.0]).solved
    near = sn.Motion(robot, knots, [ball], times=[-3.0, 0.5]).clearance
    assert 0.9 * 0.65 <= present(near) <= 0.65


def test_what_moves_along_is_proved_in_the_frame_that_moves_along() -> None:
    """The base turned instead of the obstacle gives the same clearance."""
    rng = np.random.default_rng(3)
    robot, mesh = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05), sn.Mesh(*cube())
    for _ in range(5):
        place = sn.pose(rng.normal(size=3) * 2.0, rotation=random_rotation(rng))
        q = np.stack([shape(robot, rng), shape(robot, rng)])
        moving = sn.Motion(robot, q, [sn.Moving(mesh, [0.0], poses=[place])])
        turned = robot.changed(base=np.linalg.inv(place) @ robot.base)
        still = sn.Motion(turned, q, [mesh])
        assert moving.status == still.status
        if moving.solved:
            assert moving.clearance == pytest.approx(still.clearance, rel=0.12)


def test_times_are_needed() -> None:
    robot = sn.Robot.uniform(2, (0.8, 1.2))
    scene = sn.Scene([sn.Moving(sn.Sphere((9, 0, 0), 1.0), [0], [(0, 0, 0)])]).snapshot()
    refused("times", lambda: Prover(robot, scene).prove(np.zeros((2, 2, 3))))
