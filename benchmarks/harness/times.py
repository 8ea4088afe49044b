"""Summaries of times: the middle, the tail, and how they grow."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Times:
    """Seconds of many runs, in short.

    Attributes
    ----------
    count : int
    median, p95, p99, worst : float
    """

    count: int
    median: float
    p95: float
    p99: float
    worst: float

    @classmethod
    def of(cls, seconds: ArrayLike) -> "Times":
        """Summarise at least one run."""
        values = np.asarray(seconds, np.float64)
        median, p95, p99 = np.percentile(values, [50, 95, 99]).tolist()
        return cls(len(values), median, p95, p99, float(values.max()))

    @classmethod
    def of_plain(cls, plain: dict[str, Any]) -> "Times":
        """Return what a journal holds; NaN where JSON has null."""
        numbers = (math.nan if plain[key] is None else float(plain[key]) for key in ("median", "p95", "p99", "worst"))
        return cls(plain["count"], *numbers)


def exponent(sizes: Sequence[int], seconds: Sequence[float]) -> float:
    """Slope of the straight line through log(seconds) against log(sizes), by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
