"""The time by which budgets are counted: that of work, as it takes in machine code.

Compiling is no work, and kernels that run as Python take a thousand times as long as they will: so budgets that were
counted on the wall would find less, the first time, than they find ever after. Kernels count looks (`kernels.clock`),
and each is worth what it takes in machine code. Every thread has a time of its own.
"""

import gc
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from threading import get_ident
from time import perf_counter

LOOK = 5e-9
"""Seconds of a look, compiled (see `kernels.clock`)."""

PAUSE = 0.05
"""Seconds between two questions whether an interpreted call is to be abandoned."""


@dataclass(slots=True)
class _Call:
    """An interpreted call that is under way.

    Attributes
    ----------
    since : float
        When it began, by the time of work.
    end : callable
        Says whether it is to be abandoned.
    looks : int
        Until now.
    asked : float
        When `end` was asked last, by `time.perf_counter`.
    """

    since: float
    end: Callable[[], bool]
    looks: int = 0
    asked: float = -math.inf


class AbandonedError(BaseException):
    """Raised within an interpreted call that is to be made again in another way."""


_calls: dict[int, _Call] = {}
"""Interpreted calls that are under way, by thread: nearly always none."""

_left_out: ContextVar[float] = ContextVar("left_out", default=0.0)
"""Seconds of this thread, until now, that were no work: a solve reads it twice; a `threading.local` takes longer."""


def _call() -> _Call | None:
    """The interpreted call of this thread."""
    return _calls.get(get_ident()) if _calls else None


def work_time() -> float:
    """Seconds of work; differences count, within one thread."""
    if not _calls or (call := _call()) is None:
        return perf_counter() - _left_out.get()
    if (now := perf_counter()) > call.asked + PAUSE:
        call.asked = now
        if call.end():
            raise AbandonedError
    return call.since + LOOK * call.looks


def interpreting() -> bool:
    """Say whether an interpreted call is under way in this thread."""
    return _call() is not None


def looked(looks: int) -> None:
    """Count looks of the interpreted call that is under way."""
    if (call := _call()) is not None:
        call.looks += looks


@contextmanager
def counting_looks(end: Callable[[], bool] = lambda: False) -> Iterator[None]:
    """Let time be what looks are worth: kernels are interpreted within.

    Raises
    ------
    AbandonedError
        Where it is asked for the time after `end` has said so.
    """
    if interpreting():  # an entry that an entry calls
        yield
        return
    call = _calls[get_ident()] = _Call(work_time(), end)
    try:
        yield
    except AbandonedError:
        call.looks = 0  # it is done again
        raise
    finally:
        del _calls[get_ident()]
        _left_out.set(perf_counter() - call.since - LOOK * call.looks)


@contextmanager
def no_work() -> Iterator[None]:
    """Let the time stand still: something is compiled or waited for."""
    began = work_time()
    try:
        yield
    finally:
        if not interpreting():
            _left_out.set(perf_counter() - began)


@contextmanager
def gc_paused() -> Iterator[None]:
    """Do not look for garbage within: again and again going through all that was made takes a fifth of the time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()
