"""Engines of this machine, threads and processes, and executors that a caller has."""

import hashlib
import os
import pickle
import tempfile
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from sinuous.base.errors import InputError
from sinuous.base.system import pool_of
from sinuous.scene.grids import Field
from sinuous.solver.thread_pool import CancellableThreads
from sinuous.studies.runs.engine import Arrays, Engine, LostError, Work

PER_WORKER = 2
"""Tasks in flight for each worker process: the next one is there when a worker has finished its last."""


class Threads(Engine):
    """Threads of this process, each with a task of its own: compiled code runs without the interpreter's lock."""

    def __init__(self, work: Work, workers: int) -> None:
        super().__init__()
        self._work, self._pool = work, CancellableThreads(workers)
        self.most_in_flight = workers + 1

    def submit(self, task: Arrays) -> "Future[Arrays]":
        """Hand a task to a thread."""
        return self._pool.submit(self._work, task)

    def close(self, now: bool) -> None:
        """End; with `now`, stop the threads wherever they are, also in compiled code."""
        if now:
            self._pool.cancel()
        self._pool.shutdown(wait=True, cancel_futures=True)


class Processes(Engine):
    """Processes of this machine, each with a scene and kernels of its own; a dead one is replaced.

    Tasks and answers travel in files of a temporary folder, and pipes carry their names alone: a process that is
    killed while it writes or reads more than a pipe takes at once would leave the others waiting for the rest forever.
    """

    def __init__(self, work: Work, workers: int) -> None:
        super().__init__()
        self._data, self._workers = pickled(work), workers
        self.most_in_flight = PER_WORKER * workers
        self._folder = tempfile.TemporaryDirectory(prefix="sinuous-", ignore_cleanup_errors=True)
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        pool = pool_of(self._workers, take_work, self._data)
        try:
            pool.submit(os.getpid).result()
        except BrokenExecutor:
            pool.shutdown(wait=False)
            hint = "a script needs its calls under 'if __name__ == \"__main__\":'"
            raise LostError(f"worker processes could not begin ({hint})") from None
        return pool

    def submit(self, task: Arrays) -> "Future[str]":
        """Hand a task to a process."""
        return self._pool.submit(do_file, to_file(task, self._folder.name))

    def read(self, answer: str) -> Arrays:
        """Read the file of an answer."""
        found: Arrays = from_file(answer)
        return found

    def restart(self) -> None:
        """Begin anew with other processes."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        self._pool = self._new_pool()

    def close(self, now: bool) -> None:
        """End; with `now`, kill what still works."""
        processes = list((getattr(self._pool, "_processes", None) or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes if now else ():
            process.kill()
        self._pool.shutdown(wait=True)
        self._folder.cleanup()


def to_file(value: Any, folder: str) -> str:
    """Write a value to a new file in a folder; return its name."""
    handle, name = tempfile.mkstemp(dir=folder)
    with os.fdopen(handle, "wb") as file:
        pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)
    return name


def from_file(name: str) -> Any:
    """Read a value that `to_file` wrote, and delete the file."""
    with Path(name).open("rb") as file:
        value = pickle.load(file)
    Path(name).unlink()
    return value


class GivenExecutor(Engine):
    """An executor of the caller, who keeps it; the work travels with every task, unless it is one of threads."""

    def __init__(self, work: Work, executor: Executor, workers: int) -> None:
        super().__init__()
        self._executor = executor
        self._work = work if isinstance(executor, ThreadPoolExecutor) else None
        self._data = b"" if self._work is not None else pickled(work)
        self._name = hashlib.sha256(self._data).hexdigest()
        self.most_in_flight = PER_WORKER * max(workers, getattr(executor, "_max_workers", workers))

    def submit(self, task: Arrays) -> "Future[Arrays]":
        """Hand a task to the executor."""
        try:
            if self._work is not None:
                return self._executor.submit(self._work, task)
            return self._executor.submit(_do_with, self._name, self._data, task)
        except BrokenExecutor:
            raise
        except RuntimeError as error:
            raise LostError(f"the executor takes no more: {error}") from None

    def close(self, now: bool) -> None:
        """Leave the executor to the caller."""


_work: dict[str, Work] = {}
"""In a worker process: the work that it has, by the hash of what travelled."""


def take_work(data: bytes, name: str = "") -> Work:
    """In a worker process: unpickle the work and load what it needs, once."""
    if name not in _work:
        _work[name] = pickle.loads(data).prepare()
    return _work[name]


def do_file(name: str) -> str:
    """In a worker process: do the task in a file; return the name of a file with the answer, beside it."""
    return to_file(_work[""](from_file(name)), str(Path(name).parent))


def _do_with(name: str, data: bytes, task: Arrays) -> Arrays:
    """In a worker process: do a task with the work that came with it."""
    return take_work(data, name)(task)


def pickled(work: Work) -> bytes:
    """Return the work as it travels to other processes.

    Raises
    ------
    InputError
        When its scene holds what cannot travel.
    """
    try:
        return pickle.dumps(work, pickle.HIGHEST_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        for i, obstacle in enumerate(work.scene.obstacles):
            if isinstance(obstacle, Field):
                wanted = "a function of a module that workers can import too, or the engine threads"
                raise InputError(
                    f"scene[{i}]", f"cannot be sent to another process: {error}", obstacle.function, wanted
                ) from None
        raise
