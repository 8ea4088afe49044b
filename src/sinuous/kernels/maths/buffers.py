"""Arrays cut out of a buffer one after the other."""

import numpy as np

from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array


def cut(buffer: Array, rows: int, columns: int) -> tuple[Array, Array]:
    """The beginning of a `buffer` (w,) as an array (rows, columns), and the rest of the buffer."""
    size = rows * columns
    return shaped(buffer[:size], (rows, columns)), buffer[size:]


def cut_whole(buffer: Array, count: int) -> tuple[Array, Array]:
    """The beginning of a `buffer` (w,) as an array (count,) int64, and the rest of the buffer."""
    return buffer[:count].view(np.int64), buffer[count:]
