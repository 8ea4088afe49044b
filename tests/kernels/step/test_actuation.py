"""Limits of tendons and chambers: kept by every way of moving, met exactly by a bound step."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.body.rows import END, HARD, IDLE
from sinuous.kernels.step import actuation, limits, sweeps
from tests.helpers import Floats, columns_of, make_rows


def driven_robot() -> sn.Robot:
    """Tendons through all segments before theirs, chambers along one, and segments without either."""
    return sn.Robot(
        [
            sn.Segment((0.8, 1.2), tendons=sn.Tendons(3, 0.05, displacement=(-0.06, 0.05))),
            sn.Segment((0.8, 1.2), chambers=sn.Chambers(3, 0.1, 0.3, length=(0.75, 1.25))),
            sn.Segment((0.8, 1.2)),
            sn.Segment(1.0, tendons=sn.Tendons(4, 0.05, 0.2, displacement=(-0.08, 0.08))),
            sn.Segment((0.8, 1.2), tendons=sn.Tendons(angles=[0.0, 2.0], radius=0.04, displacement=(-0.1, 0.04))),
        ]
    )


ROBOT = driven_robot()
TABLE = ROBOT.actuation
N = len(ROBOT)


def excess(q: Floats) -> float:
    """By how much a line is outside its limits, from the lengths of the lines themselves."""
    values, limits = ROBOT.to_actuators(q), np.array([each.limits for each in ROBOT.actuators])
    return max(0.0, float(np.maximum(limits[:, 0] - values, values - limits[:, 1]).max()))


def draw(rng: np.random.Generator, size: float) -> Floats:
    return np.concatenate([rng.normal(size=(N, 2)) * size, rng.uniform(0.8, 1.2, (N, 1))], axis=1)


def draw_within(rng: np.random.Generator) -> Floats:
    q = draw(rng, rng.choice([0.1, 1.0]))
    actuation.straighten(ROBOT.limits, TABLE, q, np.empty_like(q))
    assert excess(q) <= 1e-12
    return q


@pytest.mark.parametrize("seed", range(10))
def test_straighten_bends_less_until_all_limits_are_kept(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = draw(rng, rng.choice([0.01, 0.3, 3.0]))
    held = q.copy()
    actuation.straighten(ROBOT.limits, TABLE, held, np.empty_like(q))
    assert excess(held) <= 1e-12
    np.testing.assert_array_equal(held[:, 2], q[:, 2])
    factor = held[0, 0] / q[0, 0]
    np.testing.assert_allclose(held[:, :2], factor * q[:, :2], atol=1e-14)
    if excess(q) <= 0.0:
        np.testing.assert_array_equal(held, q)
    else:
        assert excess(np.concatenate([1.0001 * held[:, :2], q[:, 2:]], axis=1)) > 0.0  # no less than needed


@pytest.mark.parametrize("seed", range(10))
def test_share_is_the_last_place_on_the_way_that_keeps_all_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, aim = draw_within(rng), draw(rng, rng.choice([0.05, 0.5, 5.0]))
    t = actuation.admissible_step(TABLE, q, aim)
    assert 0.0 <= t <= 1.0
    assert excess(q + t * (aim - q)) <= 1e-12
    if t < 1.0:
        assert excess(q + (t + 1e-6) * (aim - q)) > 0.0
    else:
        assert excess(aim) <= 1e-12
    held = aim.copy()
    actuation.hold_back(TABLE, q, held)
    np.testing.assert_allclose(held, q + t * (aim - q), atol=1e-11)
    assert excess(held) <= 1e-12
    assert t < 1.0 or np.array_equal(held, aim)


def reserve(rows: Any, at_tip: int) -> None:
    """Lay out idle rows for all limits, and `at_tip` rows at the tip."""
    at = j = 0
    for k in range(N):
        rows.start[k] = at
        j, at = actuation.add_rows(TABLE, k, j, rows, at)
    assert j == len(TABLE)
    rows.kind[at : at + at_tip] = END
    rows.start[N] = at + at_tip


@pytest.mark.parametrize("seed", range(10))
def test_a_bound_step_moves_up_to_the_limits_and_not_beyond(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = draw_within(rng)
    rows: Any = make_rows(N, len(TABLE) + 3)
    reserve(rows, 3)
    rows.twist[-3:, 3:] = np.eye(3)
    rows.value[-3:] = rng.normal(size=3) * rng.choice([0.01, 0.3, 1.0])
    columns, step = columns_of(q), np.empty((N, 3))
    root, mean, bound = np.empty((N, 9)), np.zeros((N, 3)), np.empty(N, np.int64)
    limits.release(ROBOT.limits, root, mean, bound)
    for _ in range(len(TABLE) + 1):
        sweeps.forward(columns, root, mean, rows, 1e-3, 0)
        sweeps.backward(columns, root, mean, rows, step, 0)
        before = np.count_nonzero(rows.kind == HARD)
        assert excess(q + step) > 0.0 or actuation.bind(TABLE, q, step, rows) == 0
        count = actuation.bind(TABLE, q, step, rows)
        assert np.count_nonzero(rows.kind == HARD) == before + count
        if count == 0:
            break
    assert np.isfinite(step).all()
    # Each limit may give by the softness of a HARD row; `hold_back` sees to the rest.
    assert excess(q + step) <= 1e-5
    actuation.release(rows)
    np.testing.assert_array_equal(rows.kind, [IDLE] * len(TABLE) + [END] * 3)
