"""Threads of this process: compiled code runs without the interpreter's lock."""

import ctypes
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import Lock, get_ident

from sinuous.batch.engines.engine import Engine
from sinuous.batch.tables.blocks import Block
from sinuous.batch.work import Task
from sinuous.solving.crew import DismissedError


class Threads(Engine):
    """A thread a core; each solves a chunk of its own."""

    def __init__(self, work: Callable[[Task], Block], workers: int) -> None:
        self._work = work
        self._pool = ThreadPoolExecutor(workers)
        self._lock, self._busy = Lock(), set[int]()
        self.hands = workers + 1

    def submit(self, task: Task) -> "Future[Block]":
        """Give a chunk out."""
        return self._pool.submit(self._do, task)

    def _do(self, task: Task) -> Block:
        """Solve a chunk, in a thread that may be dismissed meanwhile."""
        with self._lock:
            self._busy.add(get_ident())
        try:
            return self._work(task)
        finally:
            with self._lock:
                self._busy.discard(get_ident())

    def close(self, now: bool) -> None:
        """End; `now` stops the threads wherever they are, also in compiled code."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        if now:
            with self._lock:
                for thread in self._busy:
                    told = ctypes.c_ulong(thread), ctypes.py_object(DismissedError)
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(*told)
        self._pool.shutdown(wait=True)
