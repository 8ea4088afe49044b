"""Scratch that all solvers of a process share: taken for the time of a computation, and given back."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from sinuous.base.checks import Floats


class BufferPool:
    """Buffers of numbers that threads take and give back.

    There are at most as many buffers as computations that run at once. After them, a few are kept: no more than `most`,
    none larger than `largest`. So an idle process holds at most `8 * most * largest` bytes.

    Parameters
    ----------
    most : int
        Buffers that are kept.
    largest : int
        Numbers (float64) of the largest one that is kept.
    """

    def __init__(self, most: int, largest: int) -> None:
        self._most, self._largest = most, largest
        self._kept: list[Floats] = []  # no lock, which a fork could leave closed: append and pop are atomic

    @contextmanager
    def borrow(self, size: int) -> Iterator[Floats]:
        """Lend a buffer of at least `size` numbers, with anything in it."""
        buffer = self._take(size) if size <= self._largest else np.empty(size)
        try:
            yield buffer
        finally:
            if len(buffer) <= self._largest and len(self._kept) < self._most:
                self._kept.append(buffer)

    def _take(self, size: int) -> Floats:
        """One that was given back, if it is large enough; a smaller one is replaced."""
        try:
            buffer = self._kept.pop()
        except IndexError:
            return np.empty(size)
        return buffer if len(buffer) >= size else np.empty(size)

    @property
    def kept_bytes(self) -> int:
        """Bytes of all buffers that are kept at the moment."""
        return sum(buffer.nbytes for buffer in list(self._kept))
