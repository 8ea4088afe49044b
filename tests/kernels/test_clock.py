"""The clock: when time is read, what is over stays over, and signals that arrive in compiled code."""

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from sinuous.base.progress import gc_paused
from sinuous.kernels import clock as clocks
from sinuous.kernels.clock import CLOCK_SIZE, STRIDE, WORK
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from tests.kernels.workspace import NEVER, make_clock


@entry
def work(clock: Array, seconds: float, rounds: int) -> int:
    """Spend looks until the time is over; returns how many rounds that took, at most so many."""
    clocks.begin(clock)
    clocks.allow(clock, seconds)
    done = 0
    while done < rounds and not clocks.spend(clock, 1):
        done += 1
    return done


@entry
def read(clock: Array) -> float:
    return clocks.now(clock)


def count(clock: Array, units: float, each: int) -> int:
    clocks.begin(clock)
    clocks.allow_work(clock, units)
    done = 0
    while not clocks.spend(clock, each):
        done += 1
    return done


def test_work_that_is_allowed_ends_after_so_many_units_whatever_the_time() -> None:
    for units, each in ((10 * STRIDE, 1), (10 * STRIDE, STRIDE), (12_345, 7)):
        clock = make_clock(0)
        assert abs(count(clock, units, each) * each - units) <= STRIDE + each
        assert clocks.late(clock)
        assert clocks.work_left(clock) == 0.0
        assert count(make_clock(NEVER), units, each) == count(clock, units, each)
    clocks.allow_work(clock, 1e300)
    assert not clocks.spend(clock, STRIDE)
    clocks.allow_work(clock, 100.0)
    clocks.spend(clock, 30)
    assert clocks.work_left(clock) == 70.0
    clocks.allow(clock, 1e3)
    assert clocks.work_left(clock) == 0.0


def test_a_fresh_workspace_may_hold_anything() -> None:
    """No time is over, and nobody has interrupted, because of what stood there before."""
    for stands in (0, -1, 2**62, -(2**62)):
        assert work(np.full(CLOCK_SIZE, stands), 1e3, 3 * STRIDE) == 3 * STRIDE


class RefusedError(Exception):
    """What a handler raises."""


@pytest.fixture
def handler() -> Iterator[Callable[[Callable[[], None]], None]]:
    """Set what is done when a signal arrives, for one test."""
    before = signal.getsignal(signal.SIGINT)

    def put(act: Callable[[], None]) -> None:
        signal.signal(signal.SIGINT, lambda *_: act())

    yield put
    signal.signal(signal.SIGINT, before)


def signal_soon() -> None:
    threading.Timer(0.02, lambda: os.kill(os.getpid(), signal.SIGINT)).start()


posix = pytest.mark.skipif(sys.platform == "win32", reason="there a process cannot send itself this signal")


@posix
@pytest.mark.parametrize("kind", [KeyboardInterrupt, RefusedError])
def test_an_exception_of_a_handler_ends_the_work(
    handler: Callable[[Callable[[], None]], None], kind: type[BaseException]
) -> None:
    def refuse() -> None:
        raise kind

    handler(refuse)
    clock = make_clock()
    signal_soon()
    with pytest.raises(kind):
        work(clock, 1e3, 10**15)
    assert clock[WORK] == STRIDE


@posix
def test_a_handler_that_raises_nothing_ends_nothing(handler: Callable[[Callable[[], None]], None]) -> None:
    heard: list[int] = []
    handler(lambda: heard.append(1))
    signal_soon()
    while not heard:  # on a busy machine, soon may be late
        assert work(make_clock(), 0.2, 10**15) > STRIDE
    assert heard == [1]


@pytest.mark.parametrize("late", [0.0, 0.1])
def test_an_exception_that_another_thread_raises_here_ends_the_work(late: float) -> None:
    """Before the call or within it; of a thread that signals do not reach."""
    ended: list[BaseException] = []

    def body() -> None:
        try:
            begun.set()
            work(make_clock(), 60.0, 10**15)
        except RefusedError as error:
            ended.append(error)

    begun = threading.Event()
    thread = threading.Thread(target=body, daemon=True)
    with gc_paused():  # a callback of the collector would swallow the exception
        thread.start()
        begun.wait()
        time.sleep(late)
        number = ctypes.c_ulong(thread.ident or 0)
        assert ctypes.pythonapi.PyThreadState_SetAsyncExc(number, ctypes.py_object(RefusedError)) == 1
        thread.join(50.0)
    assert not thread.is_alive()
    assert len(ended) == 1
