"""How a solve ended, in a word and in a sentence."""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t


class Status(StrEnum):
    """How a solve ended. Where it says proved, one counterexample is a defect."""

    SOLVED = "solved"
    OUT_OF_REACH = "out_of_reach"
    TARGET_BLOCKED = "target_blocked"
    BASE_BLOCKED = "base_blocked"
    START_BLOCKED = "start_blocked"
    NO_ROUTE = "no_route"
    UNPROVED = "unproved"
    BLOCKED = "blocked"
    LIMIT_BOUND = "limit_bound"
    RATE_BOUND = "rate_bound"
    STALLED = "stalled"
    TIME_LIMIT = "time_limit"

    @property
    def sentence(self) -> str:
        """What the status means."""
        return _SENTENCES[self]


_SENTENCES = {
    Status.SOLVED: "all within tolerance and limits, whole body proved clear of obstacles and of itself",
    Status.OUT_OF_REACH: "proved: no configuration within the limits gets there",
    Status.TARGET_BLOCKED: "proved: the body would overlap an obstacle at the target",
    Status.BASE_BLOCKED: "proved: the body overlaps an obstacle where it leaves its mount",
    Status.START_BLOCKED: "the start overlaps an obstacle or itself, or violates a limit",
    Status.NO_ROUTE: "proved at the stated resolution: no route through free space is both no longer than the robot "
    "and wide enough for its body",
    Status.UNPROVED: "everything met as far as could be seen, clearance not proved",
    Status.BLOCKED: "not solved: the best found overlaps an obstacle or itself",
    Status.LIMIT_BOUND: "not solved: limits stop the best found",
    Status.RATE_BOUND: "not solved: the allowed changes lead no nearer",
    Status.STALLED: "not solved: no progress from any start",
    Status.TIME_LIMIT: "not solved within the time budget",
}

CODES = {
    Status.SOLVED: t.SOLVED,
    Status.UNPROVED: t.UNPROVED,
    Status.TIME_LIMIT: t.LATE,
    Status.OUT_OF_REACH: t.OUT_OF_REACH,
    Status.TARGET_BLOCKED: t.TARGET_BLOCKED,
    Status.BASE_BLOCKED: t.BASE_BLOCKED,
    Status.NO_ROUTE: t.NO_ROUTE,
    Status.RATE_BOUND: t.RATE_BOUND,
}
"""Codes by which kernels say how a search ended; all other statuses are FAILED, for different reasons."""

_OF_CODES = {code: status for status, code in CODES.items()}


def status_of(outcome: t.Outcome) -> Status:
    """Return the status that an outcome stands for."""
    status = _OF_CODES.get(outcome.code)
    if status is not None:
        return status
    if outcome.clearance < 0.0 or outcome.self_clearance < 0.0:
        return Status.BLOCKED
    return Status.LIMIT_BOUND if outcome.bound else Status.STALLED


_STATUSES = np.array(list(Status), object)
_PLACE = {status: place for place, status in enumerate(Status)}
_IN_ORDER = np.array([_PLACE[_OF_CODES.get(code, Status.STALLED)] for code in range(max(_OF_CODES) + 1)], np.uint8)


def statuses_of(records: Floats) -> NDArray[np.object_]:
    """Return the statuses (m,) that records (m, 11 or more) stand for, as `status_of` does for one."""
    return _STATUSES[places_of(records)]


def places_of(records: Floats) -> NDArray[np.uint8]:
    """Return the places (m,) of these statuses among all, in the order of `Status`."""
    codes = records[:, t.CODE].astype(np.int64)
    result: NDArray[np.uint8] = _IN_ORDER[codes]
    failed = codes == t.FAILED
    if failed.any():
        result[failed & (records[:, t.BOUND] != 0.0)] = _PLACE[Status.LIMIT_BOUND]
        crossed = (records[:, t.CLEARANCE] < 0.0) | (records[:, t.SELF_CLEARANCE] < 0.0)
        result[failed & crossed] = _PLACE[Status.BLOCKED]
    return result
