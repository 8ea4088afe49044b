"""Jobs that threads share: compiled code runs without the interpreter's lock, so each has a core to itself."""

import ctypes
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from threading import Lock, Thread, get_ident
from time import perf_counter
from typing import Generic, TypeVar

Job = TypeVar("Job")

SOON = 2e-4
"""Seconds for which the caller works alone: beginning a thread takes half as long."""


class DismissedError(BaseException):
    """Raised in a helper that need not go on."""


def dismiss(threads: Iterable[int]) -> None:
    """Raise `DismissedError` in threads of these numbers, wherever they are, also in compiled code."""
    for thread in threads:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(DismissedError))


class Crew(Generic[Job]):
    """The caller's thread and helpers, who take one job after the other until none is left.

    What one of them raises ends the work: no further job is begun, helpers are told to stop, wherever they are, also in
    compiled code (see `kernels.clock`), and the caller raises it. So does an interrupt, which the caller alone hears.

    Parameters
    ----------
    work : callable
        Does a job.
    workers : int
        Most threads, that of the caller among them.
    """

    def __init__(self, work: Callable[[Job], object], workers: int) -> None:
        self._work, self._workers = work, workers
        self._jobs: deque[Job] = deque()
        self._busy: set[int] = set()
        self._lock = Lock()
        self._raised: list[BaseException] = []

    def share(self, jobs: Iterable[Job], alone: float = SOON) -> None:
        """Do jobs: the caller begins, and helpers join when some are left after so many seconds."""
        self._jobs.extend(jobs)
        end = perf_counter() + alone
        while self._jobs and (self._workers == 1 or perf_counter() < end):
            self._work(self._jobs.popleft())
        threads = [Thread(target=self._help, daemon=True) for _ in range(min(self._workers - 1, len(self._jobs) - 1))]
        try:
            for thread in threads:
                thread.start()
            self._toil()
            for thread in threads:
                thread.join()
        except BaseException:
            self._dismiss()
            for thread in threads:
                if thread.ident is not None:
                    thread.join()
            raise
        if self._raised:
            raise self._raised[0]

    def _toil(self) -> None:
        while True:
            try:
                job = self._jobs.popleft()
            except IndexError:
                return
            self._work(job)

    def _help(self) -> None:
        """Toil in a thread of its own; to be dismissed as long as its number is in `_busy`."""
        with suppress(DismissedError):
            with self._lock:
                self._busy.add(get_ident())
            try:
                self._toil()
            except DismissedError:
                raise
            except BaseException as error:
                self._raised.append(error)
                self._jobs.clear()
            with self._lock:
                self._busy.discard(get_ident())

    def _dismiss(self) -> None:
        """Leave no job, and stop the helpers at what they are doing."""
        self._jobs.clear()
        with self._lock:
            dismiss(self._busy)
            self._busy.clear()
