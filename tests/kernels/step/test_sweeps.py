"""The step in two sweeps against the same least squares problem written out densely."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body.contacts import SOFTNESS
from sinuous.kernels.body.rows import END, HARD, IDLE, INNER, SOFT, Rows
from sinuous.kernels.body.self_contacts import PAIR_VALUE, PAIR_WEIGHTS
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.sweeps import HARD_VARIANCE, SOFT_VARIANCE
from tests.helpers import Floats, columns_of, configurations, make_rows

SIZES = (1, 2, 5, 9)


def random_rows(rng: np.random.Generator, n: int, most: int, kinds: tuple[int, ...]) -> Rows:
    """Rows of all the kinds on every segment; END last in it, as the sweeps want them."""
    counts = rng.integers(0, most + 1, n)
    rows = make_rows(n, int(counts.sum()))
    rows.start[1:] = np.cumsum(counts)
    for k in range(n):
        drawn = rng.choice(kinds, counts[k])
        rows.kind[rows.start[k] : rows.start[k + 1]] = sorted(drawn, key=lambda kind: kind == END)
    rows.twist[:] = rng.normal(size=rows.twist.shape)
    rows.value[:] = rng.normal(size=rows.value.shape)
    rows.inner[:] = rng.normal(size=rows.inner.shape)
    rows.total[:] = rng.normal(size=rows.total.shape)  # whoever is not concerned must not look
    for part in (rows.twist, rows.inner, rows.value):
        part[rows.kind == SOFT] *= SOFTNESS  # as they are written
    return rows


def jacobian(columns: Floats, rows: Rows) -> Floats:
    """One line a row: what it sees of every coordinate."""
    table: Any = rows
    n = len(columns)
    J = np.zeros((len(table.kind), n, 3))
    for k in range(n):
        for i in range(table.start[k], table.start[k + 1]):
            J[i, : k + 1] = columns[: k + 1].reshape(-1, 3, 6) @ table.twist[i]
            if table.kind[i] in (INNER, SOFT, HARD):
                J[i, k] += table.inner[i]
            if table.kind[i] == HARD:
                J[i, : k + 1] += table.total[i]
    return np.asarray(J.reshape(-1, 3 * n))


def dense_step(
    columns: Floats, root: Floats, mean: Floats, rows: Rows, mu: float, pairs: Floats | None = None
) -> Floats:
    """All rows, and self-contacts, at once; HARD and SOFT rows with the variance that the sweeps give them."""
    table: Any = rows
    n = len(columns)
    used = table.kind != IDLE
    J, value = jacobian(columns, rows)[used], table.value[used]
    L = np.zeros((3 * n, 3 * n))
    for k in range(n):
        L[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = root[k].reshape(3, 3)
    # Weights of HARD rows as the sweeps define them: relative to what the row sees in scaled coordinates.
    variance = np.full(len(table.kind), mu)
    variance[table.kind == SOFT] = SOFT_VARIANCE
    for k in range(n):
        for i in range(table.start[k], table.start[k + 1]):
            if table.kind[i] == HARD:
                b = root[k].reshape(3, 3).T @ table.inner[i]
                variance[i] = HARD_VARIANCE * (b @ b + table.total[i] @ table.total[i])
    variance = variance[used]
    if pairs is not None:
        J, value = np.concatenate([J, pairs[:, PAIR_WEIGHTS:]]), np.concatenate([value, pairs[:, PAIR_VALUE]])
        variance = np.concatenate([variance, np.full(len(pairs), mu)])
    weight = 1.0 / np.sqrt(variance)
    system = np.concatenate([weight[:, None] * (J @ L), np.eye(3 * n)])
    z = np.linalg.lstsq(system, np.concatenate([weight * (value - J @ mean.ravel()), np.zeros(3 * n)]))[0]
    return np.asarray((mean.ravel() + L @ z).reshape(n, 3))


def sweep(columns: Floats, root: Floats, mean: Floats, rows: Rows, mu: float, coupled: bool) -> Floats:
    step = np.full((len(columns), 3), np.nan)
    sweeps.forward(columns, root, mean, rows, mu, coupled - 1)
    sweeps.backward(columns, root, mean, rows, step, coupled - 1)
    return step


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("mu", [1e-4, 1e-1, 10.0])
def test_soft_rows_give_the_dense_step(n: int, mu: float) -> None:
    rng = np.random.default_rng(n)
    for q in configurations(n, n, 10):
        columns = columns_of(q)
        rows = random_rows(rng, n, 4, (END, INNER, SOFT, IDLE))
        root, mean = rng.normal(size=(n, 9)), 0.3 * rng.normal(size=(n, 3))
        expected = dense_step(columns, root, mean, rows, mu)
        scale = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(sweep(columns, root, mean, rows, mu, False), expected, atol=1e-10 * scale)
        np.testing.assert_allclose(sweep(columns, root, mean, rows, mu, True), expected, atol=1e-10 * scale)


@pytest.mark.parametrize("n", SIZES)
def test_hard_rows_on_sums_give_the_dense_step(n: int) -> None:
    rng = np.random.default_rng(100 + n)
    for q in configurations(50 + n, n, 10):
        columns = columns_of(q)
        rows: Any = random_rows(rng, n, 2, (END, INNER, HARD, HARD, IDLE))
        rows.twist[rows.kind == HARD] = 0.0
        root, mean = rng.normal(size=(n, 9)), 0.3 * rng.normal(size=(n, 3))
        step = sweep(columns, root, mean, rows, 1e-2, True)
        expected = dense_step(columns, root, mean, rows, 1e-2)
        scale = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(step, expected, atol=1e-9 * scale)
        hard = rows.kind == HARD
        seen = jacobian(columns, rows)[hard] @ step.ravel()
        if np.linalg.matrix_rank(jacobian(columns, rows)[hard]) == hard.sum():
            np.testing.assert_allclose(seen, rows.value[hard], atol=1e-6 * scale)
