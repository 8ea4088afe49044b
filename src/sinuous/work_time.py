"""The time by which budgets are counted: that of work, as it takes in machine code.

Compiling is no work, and kernels that run as Python take a thousand times as long as they will: so budgets that were
counted on the wall would find less, the first time, than they find ever after. Kernels count looks (`kernels.clock`),
and each is worth what it takes in machine code. Every thread has a time of its own.
"""

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
    """

    left_out = 0.0
    since: float | None = None
    looks = 0


_thread = _Thread()


def work_time() -> float:
    """Seconds of work; differences count, within one thread."""
    if _thread.since is not None:
        return _thread.since + LOOK * _thread.looks
    return perf_counter() - _thread.left_out


def interpreting() -> bool:
    """Say whether an interpreted call is under way in this thread."""
    return _thread.since is not None


def looked(looks: int) -> None:
    """Count looks of the interpreted call that is under way."""
    _thread.looks += looks


@contextmanager
def counting_looks() -> Iterator[None]:
    """Let time be what looks are worth: kernels are interpreted within."""
    if _thread.since is not None:  # an entry that an entry calls
        yield
        return
    _thread.since, _thread.looks = work_time(), 0
    try:
        yield
    finally:
        end, _thread.since = work_time(), None
        _thread.left_out = perf_counter() - end


@contextmanager
def no_work() -> Iterator[None]:
    """Let the time stand still: something is compiled or waited for."""
    began = work_time()
    try:
        yield
    finally:
        if _thread.since is None:
            _thread.left_out = perf_counter() - began
