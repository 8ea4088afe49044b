"""The row of one place of the body is the derivative of that place."""

from typing import Any

import numpy as np

from sinuous.kernels.body.rows import INNER, SOFT, put_body_row
from tests.cases import with_each
from tests.helpers import Floats, complex_columns, expm_chain, make_rows, vec
from tests.kernels.body.test_body import seen
from tests.kernels.step.test_targets import Case


@with_each("kind", [INNER, SOFT])
@with_each("seed", range(6))
def test_a_row_is_the_derivative_of_its_place(seed: int, kind: int) -> None:
    case = Case(seed)
    k, s, unit = int(case.rng.integers(len(case.q))), float(case.rng.uniform(0.05, 1.0)), 1.7
    axis, pull = case.rng.normal(size=3), case.rng.normal(size=3)

    def place(x: Floats) -> Any:
        return expm_chain(np.concatenate([x[:k], x[k : k + 1] * s]), case.base)[-1][:3, 3]

    rows: Any = make_rows(len(case.q), 1)
    value = float(axis @ pull / unit)
    at = put_body_row(rows, 0, case.q, case.frames, (k, s, vec(place(case.q))), vec(axis / unit), kind, value)
    assert at == 1
    assert (rows.value[0], rows.kind[0]) == (value, kind)
    np.testing.assert_allclose(seen(case, rows, 0, k).ravel(), axis @ complex_columns(place, case.q) / unit, atol=1e-10)
