"""The step in two sweeps, and self-contacts in it, against the same least squares problem written out densely."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body.contacts import SOFTNESS
from sinuous.kernels.body.rows import END, HARD, IDLE, INNER, SOFT, Rows
from sinuous.kernels.body.self_contacts import MOST_PAIRS, PAIR_VALUE, PAIR_WEIGHTS
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.coupling import couple
from sinuous.kernels.step.states import NORMS, PAIRS, State, Work
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


def coupled_step(
    columns: Floats, root: Floats, mean: Floats, rows: Any, pairs: Floats, mu: float, coupled: bool
) -> Floats:
    n = len(columns)
    nothing = np.zeros((n, 3))
    norms = np.zeros(NORMS + MOST_PAIRS * (1 + 3 * n))
    norms[PAIRS] = len(pairs)
    norms[NORMS : NORMS + pairs.size] = pairs.ravel()
    state = State(nothing, np.zeros((n + 1, 12)), columns, rows, norms)
    whole = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(2, np.int64)
    rest = np.full(SPAN_WIDTH * (n + 1) + 3 * n * (1 + MOST_PAIRS) + MOST_PAIRS * (MOST_PAIRS + 1), np.nan)
    step = np.full((n, 3), np.nan)
    work = Work(root, mean, step, nothing.copy(), *whole, rest)
    sweeps.forward(columns, root, mean, rows, mu, coupled - 1)
    sweeps.backward(columns, root, mean, rows, step, coupled - 1)
    couple(state, work, mu, coupled - 1)
    return step


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("mu", [1e-4, 1e-1, 10.0])
# A HARD row weighs some 1e10 in the dense system, which loses digits by it.
@pytest.mark.parametrize(
    ("hard", "most_pairs", "exact"),
    [(False, 0, 1e-10), (True, 0, 1e-9), (False, MOST_PAIRS, 1e-9), (True, MOST_PAIRS, 3e-8)],
)
def test_rows_and_self_contacts_give_the_dense_step(
    n: int, mu: float, hard: bool, most_pairs: int, exact: float
) -> None:
    """Also where actuators bind (HARD rows), and, with self-contacts, where a limit leaves less to move in."""
    rng = np.random.default_rng(n)
    kinds = (END, INNER, SOFT, HARD, IDLE) if hard else (END, INNER, SOFT, IDLE)
    for q in configurations(n, n, 10):
        columns = columns_of(q)
        rows: Any = random_rows(rng, n, 2 if hard else 4, kinds)
        rows.twist[rows.kind == HARD] = 0.0
        root, mean = rng.normal(size=(n, 3, 3)), 0.3 * rng.normal(size=(n, 3))
        bound = rng.random(n) < 0.4 * (most_pairs > 0)
        root[bound, :, rng.integers(3)] = 0.0
        pairs = rng.normal(size=(rng.integers(min(1, most_pairs), most_pairs + 1), 1 + 3 * n))
        expected = dense_step(columns, root.reshape(n, 9), mean, rows, mu, pairs)
        scale = 1.0 + np.abs(expected).max()
        for coupled in (True,) if hard else (False, True):
            step = coupled_step(columns, root.reshape(n, 9).copy(), mean, rows, pairs, mu, coupled)
            np.testing.assert_allclose(step, expected, atol=exact * scale)
        seen = jacobian(columns, rows)[rows.kind == HARD]
        if most_pairs == 0 and np.linalg.matrix_rank(seen) == len(seen):
            np.testing.assert_allclose(seen @ step.ravel(), rows.value[rows.kind == HARD], atol=1e-6 * scale)
