"""Arrays cut out of a buffer, against NumPy's `reshape`."""

from typing import Any

import numpy as np
import pytest
from numba.core.errors import TypingError

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array, copy
from tests.cases import with_each


@entry
def cut_two(buffer: Array, at: int, m: int, n: int, seen: Array, wanted: Array) -> Any:
    """Number the places of a table (m, n) that begins at `at`; copy what NumPy's table holds, too."""
    table = shaped(buffer[at : at + m * n], (m, n))
    for i in range(m):
        for j in range(n):
            table[i, j] = 100 * i + j
    copy(table, seen)
    copy(buffer[at : at + m * n].reshape((m, n)), wanted)
    return table.shape


@entry
def cut_three(buffer: Array, n: int, seen: Array, wanted: Array) -> None:
    """The same of three axes, the last of them known to the compiler, and of whole numbers."""
    table = shaped(buffer.view(np.int64), (2, n, 3))
    for i in range(2):
        for j in range(n):
            for k in range(3):
                table[i, j, k] = 100 * i + 10 * j + k
    copy(table[1], seen)
    copy(buffer.view(np.int64).reshape((2, n, 3))[1], wanted)


@entry
def cut_a_column(table: Array) -> Any:
    """What nobody may do: a column is not contiguous."""
    return shaped(table[:, 0], (1, table.shape[0]))[0, 0]


@with_each(("m", "n"), [(1, 1), (2, 5), (5, 2), (0, 3), (3, 0)])
def test_a_table_is_where_numpy_has_it(m: int, n: int) -> None:
    seen, wanted, buffer = np.zeros((m, n)), np.ones((m, n)), np.full(20, -1.0)
    assert cut_two(buffer, 4, m, n, seen, wanted) == (m, n)
    assert np.array_equal(seen, wanted)
    numbers = [100 * i + j for i in range(m) for j in range(n)]
    assert buffer.tolist() == [-1.0] * 4 + numbers + [-1.0] * (16 - m * n)


def test_three_axes_and_whole_numbers() -> None:
    seen, wanted, buffer = np.zeros((4, 3), np.int64), np.ones((4, 3), np.int64), np.zeros(24)
    cut_three(buffer, 4, seen, wanted)
    assert seen.tolist() == wanted.tolist() == [[100 + 10 * j + k for k in range(3)] for j in range(4)]
    assert np.all(np.diff(buffer.view(np.int64)) > 0)


def test_what_is_not_contiguous_is_refused() -> None:
    with pytest.raises(TypingError, match="not contiguous"):
        cut_a_column(np.zeros((3, 2)))
