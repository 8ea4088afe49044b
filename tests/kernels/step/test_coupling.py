"""Self-contacts in the step, against the same least squares problem written out densely."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body.rows import END, HARD, IDLE, INNER, SOFT
from sinuous.kernels.body.self_contacts import MOST_PAIRS, PAIR_VALUE, self_contacts
from sinuous.kernels.body.self_pairs import SPAN_WIDTH, Shape
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.coupling import couple
from sinuous.kernels.step.states import NORMS, PAIRS, State, Work
from tests.helpers import Floats, columns_of, configurations, frames_of
from tests.kernels.body.test_self_proof import curled, sampled, table_of
from tests.kernels.step.test_sweeps import SIZES, dense_step, random_rows


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
@pytest.mark.parametrize("mu", [1e-4, 1e-1])
@pytest.mark.parametrize("hard", [False, True])
def test_self_contacts_give_the_dense_step(n: int, mu: float, hard: bool) -> None:
    """Also where actuators bind (HARD rows), and where a limit leaves a segment less to move in."""
    rng = np.random.default_rng(n)
    kinds = (END, INNER, SOFT, HARD, IDLE) if hard else (END, INNER, SOFT, IDLE)
    for q in configurations(n, n, 12):
        columns = columns_of(q)
        rows: Any = random_rows(rng, n, 2 if hard else 4, kinds)
        rows.twist[rows.kind == HARD] = 0.0
        root, mean = rng.normal(size=(n, 3, 3)), 0.3 * rng.normal(size=(n, 3))
        bound = rng.random(n) < 0.4
        root[bound, :, rng.integers(3)] = 0.0
        pairs = rng.normal(size=(rng.integers(1, MOST_PAIRS + 1), 1 + 3 * n))
        expected = dense_step(columns, root.reshape(n, 9), mean, rows, mu, pairs)
        step = coupled_step(columns, root.reshape(n, 9).copy(), mean, rows, pairs, mu, hard)
        # A HARD row weighs some 1e10 in the dense system, which loses digits by it.
        exact = 3e-8 if hard else 1e-9
        np.testing.assert_allclose(step, expected, atol=exact * (1.0 + np.abs(expected).max()))


def found(q: Floats, radii: Floats, margin: float, unit: float = 1.0, base: Floats | None = None) -> Any:
    pairs = np.zeros((MOST_PAIRS, 1 + 3 * len(q)))
    shape = Shape(table_of(radii), q, frames_of(q, base), np.full((len(q) + 1, SPAN_WIDTH), np.nan))
    count, low = self_contacts(shape, columns_of(q, base), margin, unit, pairs)
    return pairs[:count], low


@pytest.mark.parametrize("several", [False, True])
def test_contacts_ask_for_what_is_missing(several: bool) -> None:
    """The least gap that sampling sees is what the strongest asks for; and its bound is one."""
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(80):
        if seen > 15:
            break
        radii = rng.uniform(0.05, 0.2, 5) if several else np.full(5, 0.15)
        q = curled(rng, radii, 2.4)
        pairs, low = found(q, radii, 0.02, unit=2.0)
        least, spacing = sampled(q, radii)
        if len(pairs) == 0:
            assert low == math.inf
            assert least > 0.02 - 1e-12
            continue
        seen += 1
        asked = 2.0 * pairs[:, PAIR_VALUE].max()
        assert low <= least + 1e-12
        # A tenth of the gap and a quarter of the margin may be missing.
        assert asked >= 0.02 - least - 0.1 * abs(least) - 0.25 * 0.02 - 2.0 * spacing
        assert asked <= 0.02 - least + 2.0 * spacing
    assert seen > 15
