"""Jobs that threads share: each is done once, and what one thread raises stops all of them."""

import threading
import time

import numpy as np
import pytest

from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import cores
from sinuous.solver.thread_pool import share_jobs
from tests.kernels.test_clock import work


@pytest.mark.parametrize("workers", [1, 2, 5])
@pytest.mark.parametrize("alone", [0.0, 1e-3, 60.0])
def test_every_job_is_done_once(workers: int, alone: float) -> None:
    done: list[int] = []
    share_jobs(done.append, range(200), workers, alone)
    assert sorted(done) == list(range(200))


def test_there_are_as_many_threads_as_asked_for() -> None:
    """All of them at once: each waits for the others."""
    everybody = threading.Barrier(3)
    share_jobs(lambda _: everybody.wait(60.0), range(3), 3, alone=0.0)


def test_the_caller_is_alone_with_what_is_soon_done() -> None:
    threads: set[int] = set()
    share_jobs(lambda _: threads.add(threading.get_ident()), range(20), 4, alone=60.0)
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
        share_jobs(job, range(10_000), 2, alone=0.0)
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
        share_jobs(job, range(1000), 3, alone=0.0)
    assert threading.active_count() == before


def test_there_is_a_core() -> None:
    assert cores() >= 1
