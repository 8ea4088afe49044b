"""How fast places of the body move: bounds against differences."""

import math

import numpy as np
import pytest

from sinuous.kernels.chain.rates import MOTION_RATES_WIDTH, acceleration_bound, measure_rates
from sinuous.kernels.packing import plain_rows
from tests.helpers import Floats, frames_of

STEP = 1e-3


def way(rng: np.random.Generator, n: int) -> tuple[Floats, Floats]:
    """Two configurations (n, 3) with bends up to a whole turn and lengths down to 0."""
    shapes = rng.uniform(-math.pi, math.pi, (2, n, 3))
    shapes[..., 2] = rng.uniform(0.0, 1.5, (2, n)) * (rng.random((2, n)) < 0.9)
    return shapes[0], shapes[1]


def place(q0: Floats, q1: Floats, t: float, k: int, s: float) -> Floats:
    """Where the fraction `s` of segment `k` is at time t."""
    q = ((1.0 - t) * q0 + t * q1)[: k + 1].copy()
    q[k] *= s
    return np.asarray(frames_of(q)[-1, 9:], np.float64)


@pytest.mark.parametrize("seed", range(6))
def test_no_place_bows_more_than_its_bound_nor_travels_farther(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    q0, q1 = way(rng, n)
    rates = np.empty((n, MOTION_RATES_WIDTH))
    travel = measure_rates(plain_rows(len(q0)), q0, q1, rates)
    for _ in range(40):
        k, s, t = int(rng.integers(n)), float(rng.random()), float(rng.uniform(STEP, 1.0 - STEP))
        before, here, after = (place(q0, q1, t + d, k, s) for d in (-STEP, 0.0, STEP))
        bound = acceleration_bound(rates, k, max(q0[k, 2], q1[k, 2]), s)
        assert np.linalg.norm(before - 2.0 * here + after) / STEP**2 <= bound * (1.0 + 1e-2) + 1e-6
        assert np.linalg.norm(after - before) <= 2.0 * STEP * travel * (1.0 + 1e-6) + 1e-12
