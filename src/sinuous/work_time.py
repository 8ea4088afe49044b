"""The time by which budgets are counted: that of work, as it takes in machine code.

Compiling is no work, and kernels that run as Python take a thousand times as long as they will: so budgets that were
counted on the wall would find less, the first time, than they find ever after. Kernels count looks (`kernels.clock`),
and each is worth what it takes in machine code. Every thread has a time of its own.
"""

import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

LOOK = 5e-9
"""Seconds of a look, compiled (see `kernels.clock`)."""


class _Thread(threading.local):
    """Time of one thread.

    Attributes
    ----------
    left_out : float
        Seconds until now that were no work.
    since : float or None
        When the interpreted call that is under way began, by the time of work; `None` where there is none.
    looks : int
        Of that call, until now.
    until : float
        When it has taken too long, by `time.perf_counter`.
    """

    left_out = 0.0
    since: float | None = None
    looks = 0
    until = math.inf


class TooLongError(BaseException):
    """Raised within an interpreted call that takes longer than it may."""


_thread = _Thread()


def work_time() -> float:
    """Seconds of work; differences count, within one thread."""
    if _thread.since is None:
        return perf_counter() - _thread.left_out
    if perf_counter() > _thread.until:
        raise TooLongError
    return _thread.since + LOOK * _thread.looks


def interpreting() -> bool:
    """Say whether an interpreted call is under way in this thread."""
    return _thread.since is not None


def looked(looks: int) -> None:
    """Count looks of the interpreted call that is under way."""
    _thread.looks += looks


@contextmanager
def counting_looks(most: float = math.inf) -> Iterator[None]:
    """Let time be what looks are worth: kernels are interpreted within.

    Raises
    ------
    TooLongError
        Where it is asked for the time after so many seconds on the wall.
    """
    if _thread.since is not None:  # an entry that an entry calls
        yield
        return
    began = work_time()
    _thread.since, _thread.looks, _thread.until = began, 0, perf_counter() + most
    try:
        yield
    except TooLongError:
        _thread.looks = 0  # it is done again
        raise
    finally:
        _thread.since, _thread.left_out = None, perf_counter() - began - LOOK * _thread.looks


@contextmanager
def no_work() -> Iterator[None]:
    """Let the time stand still: something is compiled or waited for."""
    began = work_time()
    try:
        yield
    finally:
        if _thread.since is None:
            _thread.left_out = perf_counter() - began
