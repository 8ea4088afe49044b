"""The chain laid into a way."""

from itertools import pairwise
from typing import Any

import numba
import numpy as np
import pytest
from scipy.spatial import cKDTree

from sinuous.kernels.compile import OPTIONS
from sinuous.kernels.fitting import fit as following
from sinuous.kernels.maths.vectors import copy
from sinuous.kernels.step.states import carve, make_problem, pick, workspace_size
from sinuous.methods.newton import KernelTables
from sinuous.problem.target import Target, target_table
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, complex_columns, expm_chain, make_rows, vec
from tests.kernels.body.test_body import seen
from tests.kernels.step.test_targets import Case

POINTS = 300


@numba.njit(**OPTIONS)
def laid(limits, actuation, poses, table, store, settings, targets, buffer, way, gap, out):  # type: ignore[no-untyped-def]
    problem = make_problem(limits, actuation, poses, table, store, settings, targets)
    states, work = carve(buffer, problem)
    at = following.lay(problem, states, work, way, way.shape[0], gap)
    copy(pick(states, at).q, out)


def tables(robot: Robot, target: Target) -> tuple[Any, ...]:
    far = Scene([Sphere((0.0, 0.0, 1e4), 1.0)])  # workspace for rows along the body comes with obstacles
    problem = KernelTables(robot, far, Tolerance().for_robot(robot)).now()
    targets = target_table(robot, (target,)).copy()
    buffer = np.empty(workspace_size(len(robot), len(robot.actuation), 1, 1))
    return *problem, targets, buffer


def lay(robot: Robot, way: Floats) -> Floats:
    gap = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum()) / (len(way) - 1)
    out = np.empty((len(robot), 3))
    laid(*tables(robot, Target(way[-1])), way.copy(), gap, out)
    return out


def own_way(robot: Robot, q: Floats) -> Floats:
    """The backbone itself, as evenly spaced points."""
    dense = robot.backbone(q, 400)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], POINTS)
    return np.stack([np.interp(at, along, dense[:, axis]) for axis in range(3)], axis=-1)


def shape(seed: int, n: int, spread: float) -> Floats:
    rng = np.random.default_rng(seed)
    angle, bend = rng.uniform(-np.pi, np.pi, n), rng.uniform(0.2, 1.8, n)
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), 1.0 + spread * rng.uniform(-1, 1, n)], axis=-1)


@pytest.mark.parametrize("n", [1, 3, 8, 20])
@pytest.mark.parametrize("spread", [0.0, 0.15])
def test_a_chain_finds_into_its_own_backbone(n: int, spread: float) -> None:
    robot = Robot.uniform(n, length=(0.8, 1.2) if spread else 1.0, max_bend=2.4)
    q = shape(n, n, spread)
    found = lay(robot, own_way(robot, q))
    off, _ = cKDTree(robot.backbone(q, 2000)).query(robot.backbone(found, 20))
    assert np.max(off) < (0.01 if spread == 0.0 else 0.05)
    assert np.linalg.norm(robot.tip(found)[:3, 3] - robot.tip(q)[:3, 3]) < 0.03
    assert robot.excess(found) <= 1e-12


def test_limits_are_kept_where_the_way_bends_too_much() -> None:
    q = shape(3, 4, 0.0)
    robot = Robot.uniform(4, length=1.0, max_bend=0.5)
    assert robot.excess(lay(robot, own_way(Robot.uniform(4, length=1.0), q))) <= 1e-12


def test_a_straight_stage_takes_the_length_that_the_way_has() -> None:
    robot = Robot([Segment((0.0, 3.0), 0.0), *[Segment(1.0, 2.4)] * 3])
    q = np.vstack([[0.0, 0.0, 1.7], shape(5, 3, 0.0)])
    found = lay(robot, own_way(robot, q))
    assert found[0, 2] == pytest.approx(1.7, abs=0.05)


def test_the_point_of_a_way_is_interpolated() -> None:
    way = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    for along, point in ((-1.0, (0, 0, 0)), (0.25, (0.25, 0, 0)), (1.5, (1, 0.5, 0)), (9.0, (1, 1, 0))):
        assert following.point_at(way, 3, 1.0, along) == pytest.approx(point)


@pytest.mark.parametrize("seed", range(4))
def test_the_closest_place_is_closest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    way = np.cumsum(rng.normal(size=(12, 3)), axis=0)
    dense = np.concatenate([np.linspace(a, b, 400) for a, b in pairwise(way)])
    for p in rng.normal(size=(20, 3)) * 3.0:
        foot, tangent = following.closest_on(way, 12, 1.0, tuple(p), 5.0, 100.0)
        assert np.linalg.norm(p - foot) <= np.linalg.norm(dense - p, axis=1).min() + 1e-12
        assert np.linalg.norm(tangent) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(6))
def test_rows_are_the_derivative_of_the_place_that_they_draw(seed: int) -> None:
    case = Case(seed)
    k, s, unit = int(case.rng.integers(len(case.q))), float(case.rng.uniform(0.05, 1.0)), 1.7
    axis, pull = case.rng.normal(size=3), case.rng.normal(size=3)

    def place(x: Floats) -> Any:
        return expm_chain(np.concatenate([x[:k], x[k : k + 1] * s]), case.base)[-1][:3, 3]

    rows: Any = make_rows(len(case.q), 1)
    at = following.draw(rows, case.q, case.frames, k, s, case.origin, vec(place(case.q)), vec(axis), vec(pull), unit, 0)
    assert at == 1
    assert rows.value[0] == pytest.approx(axis @ pull / unit)
    np.testing.assert_allclose(seen(case, rows, 0, k).ravel(), axis @ complex_columns(place, case.q) / unit, atol=1e-10)
