"""The step of few rows against the same least squares problem by another way: by all coordinates, not by rows."""

import numpy as np
import pytest

from sinuous.kernels.body.rows import END, INNER, SOFT
from sinuous.kernels.packing import plain_rows
from sinuous.kernels.step.dense import JACOBIAN_WIDTH, MOST_SEGMENTS, are_few, dense_step, fill_constraint_jacobian
from sinuous.kernels.tables import LENGTH_SCALE, RIGID
from tests.helpers import columns_of, configurations
from tests.kernels.step.test_sweeps import dense_step as expected_step
from tests.kernels.step.test_sweeps import random_rows


@pytest.mark.parametrize("n", [1, 2, 5, MOST_SEGMENTS])
@pytest.mark.parametrize("mu", [1e-4, 1e-1, 10.0])
@pytest.mark.parametrize(("bound", "joint"), [(False, ""), (True, ""), (True, "revolute"), (True, "prismatic")])
def test_few_rows_give_the_step(n: int, mu: float, bound: bool, joint: str) -> None:
    """Of segments, or with a joint as the first row, which moves in one coordinate."""
    rng, limits = np.random.default_rng(n), plain_rows(n).copy()
    limits[0, [RIGID, LENGTH_SCALE]] = joint != "", joint != "revolute"
    met = 0
    for q in configurations(n, n, 16):
        columns = columns_of(q)
        rows = random_rows(rng, n, max(1, 8 // n), (END, INNER, SOFT))
        if not are_few(rows, n):
            continue
        if joint:
            columns[0, slice(6, None) if joint == "revolute" else slice(12)] = 0.0
            rows.inner[: rows.start[1]] = 0.0
        root = rng.normal(size=(n, 9)) if bound else np.zeros((n, 9))
        root[:, ::4] = rng.uniform(0.5, 2.0, (n, 3))
        mean = 0.3 * rng.normal(size=(n, 3)) * rng.integers(0, 2, (n, 1))
        expected = expected_step(columns, root, mean, rows, mu)
        sights = np.full((n, JACOBIAN_WIDTH), np.nan)
        step = np.full((n, 3), np.nan)
        fill_constraint_jacobian(limits, columns, rows, sights)
        for _ in range(2):  # what rows see stays for the next time
            dense_step(sights, root, mean, rows, mu, step)
            np.testing.assert_allclose(step, expected, atol=1e-9 * (1.0 + np.abs(expected).max()))
        met += 1
    assert met >= 5
