"""Kernels that processes of their own compile."""

import math

from sinuous.kernels.compile import entry, kernel


@kernel
def square(x: float) -> float:
    return x * x


@kernel
def norm(x: float, y: float) -> float:
    return math.sqrt(max(square(x) + square(y), 0.0))


@entry
def twice_the_norm(x: float, y: float) -> float:
    return 2.0 * norm(x, y)
