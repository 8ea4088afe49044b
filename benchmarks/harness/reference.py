"""A fixed piece of arithmetic that says how fast the machine is just now: times are compared as multiples of it.

It shares nothing with the library, so that no change of the library changes it: Numba's plain compiler, floating-point
operations that wait for each other as those of a solve do, and some square roots, on one core.
"""

from functools import cache
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

STEPS = 20_000
"""Turns of the loop: about half a millisecond."""

REPEATS = 100
"""Of which the median counts."""


class Look(NamedTuple):
    """How fast the machine is, and how busy with other things.

    Attributes
    ----------
    seconds : float
        Of the workload.
    busy : float
        Share of the time in which other processes had the processor, 0 to 1.
    """

    seconds: float
    busy: float


def _turn(matrix: NDArray[np.float64], vector: NDArray[np.float64], steps: int) -> float:
    """Turn a vector again and again, and put it back to length 1."""
    x, y, z = vector
    for _ in range(steps):
        a = matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z
        b = matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z
        c = matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z
        norm = np.sqrt(a * a + b * b + c * c)
        x, y, z = a / norm, b / norm, c / norm
    return float(x + y + z)


@cache
def _compiled() -> Any:
    """What turns, compiled; whoever measures nothing waits for no compiler."""
    import numba  # noqa: PLC0415

    return numba.njit(cache=True)(_turn)


def look() -> Look:
    """Run the workload some times."""
    turn = _compiled()
    matrix, vector = np.array([[0.8, -0.6, 0.1], [0.6, 0.8, -0.1], [0.0, 0.1, 1.0]]), np.array([0.6, 0.0, 0.8])
    turn(matrix, vector, 10)  # compiles, or loads
    spent, worked = [], thread_time()
    for _ in range(REPEATS):
        began = perf_counter()
        turn(matrix, vector, STEPS)
        spent.append(perf_counter() - began)
    worked = thread_time() - worked
    return Look(float(np.median(spent)), max(0.0, 1.0 - worked / sum(spent)))
