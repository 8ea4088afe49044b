"""Errors of targets as rotation vectors, and the rows that a step reads."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.body.rows import END
from sinuous.kernels.packing import pose_row
from sinuous.kernels.step import targets
from sinuous.problem.target import Target
from tests.helpers import (
    Floats,
    columns_of,
    complex_columns,
    configurations,
    expm_chain,
    frames_of,
    make_rows,
    mat,
    random_pose,
    random_rotation,
    skew,
    vec,
)

TURNS = (0.0, 1e-200, 1e-12, 1e-9, 1e-5, 1e-3, 1.0, 2.5, math.pi - 1e-3, math.pi - 1e-5, math.pi - 1e-9, math.pi)
turns = st.one_of(st.sampled_from(TURNS), st.floats(0.0, math.pi))
axes = st.one_of(
    st.sampled_from(
        [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 0.0), (-1.0, 1.0, -1.0), (1.0, 1e-9, 0.0)]
    ),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: math.hypot(*a) > 1e-3),
)
units = axes.map(lambda a: np.array(a) / np.linalg.norm(a))


def assert_logarithm(angle: float, axis: Floats) -> None:
    rotation = expm(skew(angle * axis))
    got = np.array(targets.rotation_vector(mat(rotation)))
    assert np.linalg.norm(got) == pytest.approx(angle, abs=1e-14, rel=1e-9)
    # Only its root is known of a matrix close to a half turn: the axis to half of the digits.
    tolerance = 1e-8 if angle > math.pi - 1e-3 else 1e-11
    np.testing.assert_allclose(expm(skew(got)), rotation, atol=tolerance)


@given(turns, units)
def test_rotation_vector_undoes_the_exponential(angle: float, axis: Floats) -> None:
    assert_logarithm(angle, axis)


@given(turns, units, units)
def test_direction_vector_is_the_shortest_turn(angle: float, tangent: Floats, other: Floats) -> None:
    side = np.cross(tangent, other)
    if np.linalg.norm(side) < 1e-6:
        side = np.cross(tangent, [1.0, 0.0, 0.0] if abs(tangent[0]) < 0.9 else [0.0, 1.0, 0.0])
    goal = expm(skew(angle * side / np.linalg.norm(side))) @ tangent
    got = np.array(targets.direction_vector(vec(tangent), vec(goal)))
    assert np.linalg.norm(got) == pytest.approx(angle, abs=1e-14, rel=1e-7)
    assert abs(got @ tangent) < 1e-7
    np.testing.assert_allclose(expm(skew(got)) @ tangent, goal, atol=1e-8 if angle > math.pi - 1e-3 else 1e-13)


class Case:
    """A robot with base and tool at some configuration."""

    def __init__(self, seed: int, n: int = 4) -> None:
        self.rng = np.random.default_rng(seed)
        self.q = configurations(seed, n, 1)[0]
        self.base, self.tool = random_pose(self.rng), random_pose(self.rng, 0.2)
        self.frames = frames_of(self.q, self.base)
        self.columns = columns_of(self.q, self.base)
        self.origin = vec(self.base[:3, 3])

    def end(self, k: int, q: Any = None) -> Any:
        poses = expm_chain(self.q if q is None else q, self.base)
        return poses[k + 1] @ self.tool if k == len(self.q) - 1 else poses[k + 1]

    def rows(self, target: Target, unit: float) -> tuple[Any, int, float, float]:
        rows = make_rows(len(self.q), 6)
        return rows, *targets.add_rows(
            target.table.copy(), 0, self.frames, pose_row(self.tool), self.origin, unit, rows, 0
        )

    def seen(self, rows: Any, k: int) -> Floats:
        """What the rows see of every coordinate."""
        reach = np.where(np.arange(len(self.q))[:, None, None] <= k, self.columns.reshape(-1, 3, 6), 0.0)
        return np.asarray(np.einsum("ia,kca->ikc", rows.twist, reach).reshape(len(rows.twist), -1))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("segment", [1, 3, None])
def test_position_rows_are_the_derivative_of_the_miss(seed: int, segment: int | None) -> None:
    case, unit = Case(seed), 2.5
    k = len(case.q) - 1 if segment is None else segment - 1
    goal = case.rng.normal(size=3)
    rows, count, off, turn = case.rows(Target(goal, segment=segment), unit)
    place = case.end(k)[:3, 3]
    assert (count, turn) == (3, 0.0)
    assert off == pytest.approx(np.linalg.norm(goal - place))
    np.testing.assert_array_equal(rows.kind[:3], END)
    np.testing.assert_allclose(rows.value[:3], (goal - place) / unit, atol=1e-12)
    derivative = complex_columns(lambda x: case.end(k, x)[:3, 3], case.q)
    np.testing.assert_allclose(case.seen(rows, k)[:3], derivative / unit, atol=1e-11)


@pytest.mark.parametrize("seed", range(6))
def test_rotation_rows_turn_the_tool_to_its_goal(seed: int) -> None:
    case = Case(seed)
    k = len(case.q) - 1
    goal = random_rotation(case.rng)
    rows, count, off, turn = case.rows(Target(rotation=goal), 1.0)
    assert (count, off) == (3, 0.0)
    assert turn == pytest.approx(np.linalg.norm(rows.value[:3]))
    np.testing.assert_allclose(expm(skew(rows.value[:3])) @ case.end(k)[:3, :3], goal, atol=1e-7)
    rates = complex_columns(lambda x: case.end(k, x)[:3, :3], case.q)
    spins = np.einsum("abi,cb->aci", rates, case.end(k)[:3, :3])
    np.testing.assert_allclose(case.seen(rows, k)[:3], np.stack([spins[2, 1], spins[0, 2], spins[1, 0]]), atol=1e-11)


@pytest.mark.parametrize("seed", range(6))
def test_direction_rows_see_the_turn_of_the_tangent_alone(seed: int) -> None:
    case = Case(seed)
    k = 1
    tangent = case.end(k)[:3, 2]
    goal = random_rotation(case.rng)[0]
    rows, count, off, turn = case.rows(Target(direction=goal, segment=k + 1), 1.0)
    assert (count, off) == (2, 0.0)
    assert turn == pytest.approx(math.acos(tangent @ goal))
    axes = rows.twist[:2, :3]
    np.testing.assert_allclose(axes @ axes.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(axes @ tangent, 0.0, atol=1e-12)
    # The values are the turn that is missing, in these two axes.
    np.testing.assert_allclose(expm(skew(rows.value[:2] @ axes)) @ tangent, goal, atol=1e-12)
    rates = complex_columns(lambda x: case.end(k, x)[:3, 2], case.q)
    np.testing.assert_allclose(case.seen(rows, k)[:2], axes @ np.cross(tangent, rates, axisb=0).T, atol=1e-11)
