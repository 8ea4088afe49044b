"""What is said of a voxel in one direction, and how certain it is."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from sinuous.solution.solutions import Solutions
from sinuous.solution.status import Status


class Verdict(IntEnum):
    """What is known of a voxel in a direction; what is proved comes first.

    `OBSTACLE`: without obstacles it was solved, and among them nothing was found; `obstacles` says which one the free
    body would run into. `LIMITS`: limits hold the best found, also without obstacles. Both are no proofs.
    """

    SOLVED = 0
    OUT_OF_REACH = 1
    TARGET_BLOCKED = 2
    BASE_BLOCKED = 3
    OBSTACLE = 4
    LIMITS = 5
    NOT_FOUND = 6

    @property
    def proved(self) -> bool:
        """Whether it is certain."""
        return self <= Verdict.BASE_BLOCKED

    @property
    def sentence(self) -> str:
        """What it means."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.SOLVED: "solved, whole body proved clear",
    Verdict.OUT_OF_REACH: "proved: out of reach",
    Verdict.TARGET_BLOCKED: "proved: the body would overlap an obstacle there",
    Verdict.BASE_BLOCKED: "proved: the body overlaps an obstacle at its base",
    Verdict.OBSTACLE: "an obstacle is in the way of all that was found",
    Verdict.LIMITS: "limits stop all that was found",
    Verdict.NOT_FOUND: "not found within the budget",
}

OF_STATUSES = {
    Status.SOLVED: Verdict.SOLVED,
    Status.OUT_OF_REACH: Verdict.OUT_OF_REACH,
    Status.TARGET_BLOCKED: Verdict.TARGET_BLOCKED,
    Status.BASE_BLOCKED: Verdict.BASE_BLOCKED,
    Status.LIMIT_BOUND: Verdict.LIMITS,
}

Codes = NDArray[np.uint8]


def verdicts_of(found: Solutions) -> Codes:
    """Return verdicts (m,) of solves without obstacles, or of a position among them."""
    return np.array([OF_STATUSES.get(status, Verdict.NOT_FOUND) for status in found.status.tolist()], np.uint8)
