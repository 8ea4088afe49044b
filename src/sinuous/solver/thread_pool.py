"""Threads whose work can be cancelled, also in compiled code, which runs without the interpreter's lock.

A thread is cancelled by an exception that is raised in it: `kernels.clock` ends compiled code for it within 50 ms, and
the search around that code, which is Python, ends too. A flag that the clock read would end the compiled code alone.
"""

import ctypes
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait
from threading import Lock, get_ident
from time import perf_counter
from typing import Any, TypeVar

Job = TypeVar("Job")

ALONE = 2e-4
"""Seconds for which the caller works alone: beginning a thread takes half as long."""


class CancelledThreadError(BaseException):
    """Raised in a thread whose work is not wanted any more."""


class CancellableThreads(ThreadPoolExecutor):
    """A pool of threads; an exception in the block of its `with` statement cancels what they do."""

    def __init__(self, workers: int) -> None:
        super().__init__(workers)
        self._lock, self._busy = Lock(), set[int]()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Have a function called in a thread."""
        return super().submit(self._call, fn, *args, **kwargs)

    def _call(self, fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        """Call a function in a thread that may be cancelled as long as its number is in `_busy`."""
        with self._lock:
            self._busy.add(get_ident())
        try:
            return fn(*args, **kwargs)
        finally:
            with self._lock:
                self._busy.discard(get_ident())

    def cancel(self) -> None:
        """Begin nothing more, and stop the threads wherever they are."""
        self.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            for thread in self._busy:
                error = ctypes.py_object(CancelledThreadError)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), error)

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is not None:
            self.cancel()
        self.shutdown(wait=True)


def share_jobs(work: Callable[[Job], object], jobs: Iterable[Job], workers: int, alone: float = ALONE) -> None:
    """Do jobs in the caller's thread and, where some are left after so many seconds, in others beside it.

    What one of them raises ends the work, and is raised here.

    Parameters
    ----------
    work : callable
        Does a job.
    jobs : iterable
    workers : int
        Most threads, that of the caller among them.
    alone : float
        Seconds.
    """
    left, end = deque(jobs), perf_counter() + alone

    def take_jobs() -> None:
        while True:
            try:
                job = left.popleft()
            except IndexError:
                return
            try:
                work(job)
            except BaseException:
                left.clear()
                raise

    while left and (workers == 1 or perf_counter() < end):
        work(left.popleft())
    helpers = min(workers - 1, len(left) - 1)
    if helpers < 1:
        take_jobs()
        return
    with CancellableThreads(helpers) as pool:
        futures = [pool.submit(take_jobs) for _ in range(helpers)]
        take_jobs()
        for future in wait(futures, return_when=FIRST_EXCEPTION).done:
            future.result()
