"""The step in two sweeps against the same least squares problem written out densely."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body.contacts import SOFTNESS
from sinuous.kernels.body.rows import END, HARD, IDLE, INNER, SOFT, Rows
from sinuous.kernels.body.self_contacts import VALUE, WEIGHTS
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.sweeps import HARD_SHARE, SOFT_VARIANCE
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
                variance[i] = HARD_SHARE * (b @ b + table.total[i] @ table.total[i])
    variance = variance[used]
    if pairs is not None:
        J, value = np.concatenate([J, pairs[:, WEIGHTS:]]), np.concatenate([value, pairs[:, VALUE]])
        variance = np.concatenate([variance, np.full(len(pairs), mu)])
    weight = 1.0 / np.sqrt(variance)
    system = np.concatenate([weight[:, None] * (J @ L), np.eye(3 * n)])
    z = np.linalg.lstsq(system, np.concatenate([weight * (value - J @ mean.ravel()), np.zeros(3 * n)]))[0]
    return np.asarray((mean.ravel() + L @ z).reshape(n, 3))


def sweep(columns: Floats, root: Floats, mean: Floats, rows: Rows, mu: float, coupled: bool) -> Floats:
    step = np.full((len(columns), 3), np.nan)
    sweeps.forward(columns, root, mean, rows, mu, coupled)
    sweeps.backward(columns, root, mean, rows, step, coupled)
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


def test_hard_rows_within_one_segment_need_no_sums() -> None:
    rng = np.random.default_rng(7)
    n = 4
    for q in configurations(7, n, 10):
        columns = columns_of(q)
        rows: Any = random_rows(rng, n, 2, (END, HARD))
        hard = rows.kind == HARD
        rows.twist[hard], rows.total[hard] = 0.0, 0.0
        root, mean = np.tile(np.eye(3).ravel(), (n, 1)), np.zeros((n, 3))
        step = sweep(columns, root, mean, rows, 1e-2, False)
        np.testing.assert_allclose(jacobian(columns, rows)[hard] @ step.ravel(), rows.value[hard], atol=1e-6)


def test_hard_rows_may_say_the_same_twice() -> None:
    n = 3
    columns = columns_of(configurations(8, n, 1)[0])
    rows: Any = make_rows(n, 3)
    rows.start[n:], rows.kind[:] = 3, HARD
    rows.total[:], rows.value[:] = [1.0, 2.0, 0.0], 0.3
    rows.total[2], rows.value[2] = [-1.0, -2.0, 0.0], -0.3
    root, mean = np.tile(np.eye(3).ravel(), (n, 1)), np.zeros((n, 3))
    step = sweep(columns, root, mean, rows, 1e-2, True)
    np.testing.assert_allclose(step, np.tile([0.02, 0.04, 0.0], (n, 1)), atol=1e-8)


def test_without_damping_rows_are_met_by_the_least_motion() -> None:
    rng = np.random.default_rng(3)
    n = 5
    for _ in range(10):
        q = np.concatenate([rng.normal(size=(n, 2)), rng.uniform(0.5, 1.5, (n, 1))], axis=1)
        columns = columns_of(q)
        rows: Any = make_rows(n, 6)
        rows.start[n] = 6
        rows.kind[:] = END
        rows.twist[:], rows.value[:] = np.eye(6), 0.1 * rng.normal(size=6)
        root, mean = np.tile(np.eye(3).ravel(), (n, 1)), np.zeros((n, 3))
        step = sweep(columns, root, mean, rows, 1e-14, False)
        J = jacobian(columns, rows)
        np.testing.assert_allclose(J @ step.ravel(), rows.value, atol=1e-9)
        np.testing.assert_allclose(step.ravel(), np.linalg.pinv(J) @ rows.value, atol=1e-7)


def test_what_the_root_leaves_out_does_not_move() -> None:
    rng = np.random.default_rng(4)
    n = 3
    columns = columns_of(configurations(4, n, 1)[0])
    rows = random_rows(rng, n, 4, (END, INNER))
    root, mean = np.zeros((n, 9)), rng.normal(size=(n, 3))
    root[1] = np.diag([0.0, 2.0, 0.0]).ravel()
    step = sweep(columns, root, mean, rows, 1e-3, False)
    np.testing.assert_array_equal(step[[0, 2]], mean[[0, 2]])
    np.testing.assert_array_equal(step[1, [0, 2]], mean[1, [0, 2]])
    assert step[1, 1] != mean[1, 1]


def test_without_rows_the_step_is_its_mean() -> None:
    mean = np.arange(6.0).reshape(2, 3)
    columns = columns_of(configurations(5, 2, 1)[0])
    np.testing.assert_array_equal(sweep(columns, np.ones((2, 9)), mean, make_rows(2, 0), 1.0, True), mean)
