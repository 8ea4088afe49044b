"""Arrays cut out of a buffer, against NumPy's `reshape`."""

from typing import Any

import numpy as np
import pytest
from numba.core.errors import TypingError

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array


@entry
def cut_a_column(table: Array) -> Any:
    """What nobody may do: a column is not contiguous."""
    return shaped(table[:, 0], (1, table.shape[0]))[0, 0]


def test_what_is_not_contiguous_is_refused() -> None:
    with pytest.raises(TypingError, match="not contiguous"):
        cut_a_column(np.zeros((3, 2)))
