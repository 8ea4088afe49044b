import math

import numpy as np
import pytest

from sinuous.methods.opti_path import path as paths
from sinuous.methods.opti_path import starts as path_starts
from sinuous.methods.opti_path.path import Aim, Path
from sinuous.model.robot import Robot
from tests.helpers import Floats, frames_of, random_unit, vec
from tests.methods.opti_path.test_gradient_costs import setting
from tests.methods.opti_path.test_path import make_path

N = 5
ROBOT = Robot.uniform(N, (45, 70), 2.4)
LIMITS = ROBOT.limits.copy()


def aim(position: Floats, direction: Floats | None = None) -> Aim:
    towards = np.array([0.0, 0.0, 1.0]) if direction is None else direction
    return Aim(vec(position), vec(towards), direction is not None, 57.5)


def fresh(points: Floats | None = None) -> Path:
    return make_path(np.zeros((N + 1, 3)) if points is None else points, robot=ROBOT)


def goals(seed: int, count: int) -> list[Floats]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(100.0, 260.0) * random_unit(rng) for _ in range(count)]


def test_the_single_arc_is_cut_into_equal_pieces() -> None:
    for goal in goals(0, 40):
        path = fresh()
        length = path_starts.single(LIMITS, setting(bow=0.0), aim(goal), path)
        paths.trace(path)
        np.testing.assert_array_equal(path.points[-1], goal)
        np.testing.assert_allclose(path.arcs[:, 14], length / N, rtol=1e-6)
        np.testing.assert_allclose(path.arcs[:, 11], path.arcs[0, 11], atol=1e-6)


def test_pieces_share_the_arc_by_their_mean_lengths() -> None:
    robot = Robot([*Robot.uniform(2, (10, 30), 2.0).segments, *Robot.uniform(1, (50, 70), 2.0).segments])
    path = make_path(np.zeros((4, 3)), robot=robot)
    length = path_starts.single(robot.limits.copy(), setting(), aim(np.array([40.0, 20.0, 70.0])), path)
    paths.trace(path)
    np.testing.assert_allclose(path.arcs[:, 14], np.array([0.2, 0.2, 0.6]) * length, rtol=1e-9)


def test_only_a_goal_straight_ahead_is_bowed() -> None:
    ahead, aside = np.array([0.0, 0.0, 200.0]), np.array([30.0, 0.0, 200.0])
    for goal, bow, bent in ((ahead, 0.02, True), (ahead, 0.0, False), (aside, 0.02, False)):
        path, plain = fresh(), fresh()
        path_starts.single(LIMITS, setting(bow=bow), aim(goal), path)
        path_starts.single(LIMITS, setting(bow=0.0), aim(goal), plain)
        lift = np.linalg.norm(path.points - plain.points, axis=-1)
        assert lift.max() == pytest.approx(0.02 * 57.5 * math.sin(0.4 * math.pi) if bent else 0.0, abs=1e-9)


def test_a_goal_straight_behind_has_a_far_too_long_arc() -> None:
    path = fresh()
    length = path_starts.single(LIMITS, setting(), aim(np.array([0.0, 0.0, -100.0])), path)
    assert length > 1e6
    assert np.isfinite(path.points).all()


def test_a_given_shape_is_carried_to_the_goal() -> None:
    rng = np.random.default_rng(2)
    q = np.column_stack([rng.uniform(-1.0, 1.0, (N, 2)), rng.uniform(45.0, 70.0, N)])
    frames = frames_of(q)
    goal = frames[-1, 9:] + [5.0, -3.0, 2.0]
    for blend in (0.0, 1.0, 2.0):
        path = fresh()
        path_starts.carried(frames, setting(blend=blend), aim(goal), path)
        share = (np.arange(N + 1) / N) ** blend if blend else np.eye(N + 1)[-1]
        np.testing.assert_allclose(path.points - frames[:, 9:], share[:, None] * [5.0, -3.0, 2.0], atol=1e-12)


def test_a_swung_curve_has_the_length_of_the_robot() -> None:
    down = np.array([0.0, 0.0, -1.0])
    for goal in [*goals(3, 10), np.array([0.0, 0.0, -60.0])]:
        for direction in (None, down):
            for angle in (0.0, 2.0):
                path = fresh()
                path_starts.swung(LIMITS, aim(goal, direction), path, angle)
                chords = np.linalg.norm(np.diff(path.points, axis=0), axis=-1)
                np.testing.assert_array_equal(path.points[-1], goal)
                # A tangent that is asked for can take more than the robot has, however little the curve swings.
                assert 0.7 * 287.5 < chords.sum() <= 287.5 * (1.001 if direction is None else 1.5)
                assert chords.min() > 20.0


def test_bows_go_to_all_sides() -> None:
    plain = fresh()
    path_starts.single(LIMITS, setting(), aim(np.array([30.0, 0.0, 200.0])), plain)
    seen = []
    for which in range(2 * path_starts.BOWS):
        path = fresh()
        path_starts.single(LIMITS, setting(), aim(np.array([30.0, 0.0, 200.0])), path)
        path_starts.bow(aim(np.zeros(3)), path, which)
        lift = path.points - plain.points
        np.testing.assert_allclose(lift[[0, -1]], 0.0, atol=1e-12)
        np.testing.assert_allclose(lift[:, 2], 0.0, atol=1e-9)
        seen.append(lift[2])
    gaps = [np.linalg.norm(a - b) for i, a in enumerate(seen) for b in seen[:i]]
    assert min(gaps) > 5.0
