"""Jobs that threads share: each is done once, and what one thread raises stops all of them."""

import threading
import time

import numpy as np
import pytest

from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compiling.helpers import cores
from sinuous.solver.thread_pool import Crew
from tests.cases import with_each
from tests.kernels.test_clock import work


@with_each("workers", [1, 2, 5])
@with_each("alone", [0.0, 1e-3, 60.0])
def test_every_job_is_done_once(workers: int, alone: float) -> None:
    done: list[int] = []
    Crew[int](done.append, workers).share(range(200), alone)
    assert sorted(done) == list(range(200))


def test_there_are_as_many_threads_as_asked_for() -> None:
    """All of them at once: each waits for the others."""
    everybody = threading.Barrier(3)
    Crew[int](lambda _: everybody.wait(60.0), 3).share(range(3), alone=0.0)


def test_the_caller_is_alone_with_what_is_soon_done() -> None:
    threads: set[int] = set()
    Crew[int](lambda _: threads.add(threading.get_ident()), 4).share(range(20), alone=60.0)
    assert threads == {threading.get_ident()}


@pytest.mark.parametrize("bad", [0, 1, 7])
def test_what_a_job_raises_is_raised(bad: int) -> None:
    begun: list[int] = []

    def job(number: int) -> None:
        begun.append(number)
        if number == bad:
            raise ValueError(f"job {number}")
        time.sleep(1e-3)

    with pytest.raises(ValueError, match=f"job {bad}"):
        Crew(job, 2).share(range(10_000), alone=0.0)
    assert len(begun) < 5_000


def test_helpers_stop_in_compiled_code() -> None:
    """When the caller fails, helpers have hours of arithmetic before them."""
    before = threading.active_count()
    begun = threading.Barrier(3)
    own = threading.get_ident()

    def job(_: int) -> None:
        begun.wait(60.0)
        if threading.get_ident() == own:
            raise KeyboardInterrupt
        work(np.zeros(CLOCK_SIZE, np.int64), 1e4, 10**15)

    work(np.zeros(CLOCK_SIZE, np.int64), 0.0, 1)  # compiles it
    with pytest.raises(KeyboardInterrupt):
        Crew(job, 3).share(range(1000), alone=0.0)
    assert threading.active_count() == before


def test_there_is_a_core() -> None:
    assert cores() >= 1
