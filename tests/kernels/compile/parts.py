"""Kernels that processes of their own compile."""

import math

from sinuous.kernels.compile import apart, entry, kernel, shared


@kernel
def square(x: float) -> float:
    return x * x


@kernel
def norm(x: float, y: float) -> float:
    return math.sqrt(max(square(x) + square(y), 0.0))


@entry
def twice_the_norm(x: float, y: float) -> float:
    return 2.0 * norm(x, y)


@shared
def longest(x: float, y: float) -> float:
    return max(norm(x, y), square(x))


@entry
def thrice_the_longest(x: float, y: float) -> float:
    return 3.0 * longest(x, y)


@entry
def longest_and_norm(x: float, y: float) -> float:
    return longest(x, y) + norm(x, y)


@apart
def shortest(x: float, y: float) -> float:
    return min(abs(x), abs(y))


@entry
def twice_the_shortest(x: float, y: float) -> float:
    return 2.0 * shortest(x, y)
