"""Processes of this machine, and whatever else is an executor of `concurrent.futures`."""

import hashlib
import multiprocessing
import os
import pickle
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path

from sinuous.batch.engines.engine import Engine, LostError, pickled
from sinuous.batch.engines.spool import Spool, take, write
from sinuous.batch.tables.blocks import Block
from sinuous.batch.work import Task, Work

_known: dict[str, Work] = {}
"""Work that came to this process, by the hash of what travelled."""

PER_WORKER = 2


def _begin(data: bytes) -> None:
    """Take the work, once a process, and load what it needs."""
    _known[""] = pickle.loads(data).prepare()


def _ready() -> int:
    return os.getpid()


def _do(name: str) -> str:
    """Solve the chunk in a file; return the name of a file with the answer, beside it."""
    return write(_known[""](take(name)), str(Path(name).parent))


def _do_known(name: str, data: bytes, task: Task) -> Block:
    """Do what came with the chunk; it is unpickled once a process."""
    if name not in _known:
        _known[name] = pickle.loads(data).prepare()
    return _known[name](task)


class Processes(Engine):
    """A process a core, each with scene and kernels of its own; a dead one is replaced."""

    def __init__(self, work: Work, workers: int) -> None:
        self._data, self._workers = pickled(work), workers
        self.hands = PER_WORKER * workers
        self._spool, self._pool = Spool(), self._fresh()

    def _fresh(self) -> ProcessPoolExecutor:
        spawn = multiprocessing.get_context("spawn")  # threads, as compiled code may have, are not safe to fork
        pool = ProcessPoolExecutor(self._workers, spawn, initializer=_begin, initargs=(self._data,))
        try:
            pool.submit(_ready).result()
        except BrokenExecutor:
            pool.shutdown(wait=False)
            told = "a script needs its calls under 'if __name__ == \"__main__\":'"
            raise LostError(f"worker processes could not begin ({told})") from None
        return pool

    def submit(self, task: Task) -> "Future[Block]":
        """Give a chunk out."""
        answer: Future[Block] = Future()
        self._pool.submit(_do, self._spool.put(task)).add_done_callback(partial(_pass_on, answer))
        return answer

    def mend(self) -> None:
        """Begin anew with other processes."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        self._pool = self._fresh()

    def close(self, now: bool) -> None:
        """End; `now` kills what still works."""
        processes = list((getattr(self._pool, "_processes", None) or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes if now else ():
            process.kill()
        self._pool.shutdown(wait=True)
        self._spool.close()


def _pass_on(answer: "Future[Block]", named: "Future[str]") -> None:
    """Let an answer be what is in the file that is named, or what went wrong."""
    if named.cancelled():
        answer.cancel()
        answer.set_running_or_notify_cancel()
        return
    try:
        answer.set_result(take(named.result()))
    except Exception as error:  # whatever happened in the worker belongs to the chunk
        answer.set_exception(error)


class Given(Engine):
    """An executor that the caller made, and keeps; the work travels with every chunk, unless it is one of threads."""

    def __init__(self, work: Work, executor: Executor, workers: int) -> None:
        self._executor = executor
        self._work = work if isinstance(executor, ThreadPoolExecutor) else None
        self._data = b"" if self._work is not None else pickled(work)
        self._name = hashlib.sha256(self._data).hexdigest()
        self.hands = PER_WORKER * max(workers, getattr(executor, "_max_workers", workers))

    def submit(self, task: Task) -> "Future[Block]":
        """Give a chunk out."""
        try:
            if self._work is not None:
                return self._executor.submit(self._work, task)
            return self._executor.submit(_do_known, self._name, self._data, task)
        except BrokenExecutor:
            raise
        except RuntimeError as error:
            raise LostError(f"the executor takes no more: {error}") from None

    def close(self, now: bool) -> None:
        """Leave the executor to the caller."""
