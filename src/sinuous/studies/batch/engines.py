"""Engines: what solves chunks. Threads, processes, or any executor; Dask has a module of its own."""

import hashlib
import os
import pickle
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from threading import Lock, get_ident
from typing import Any, Self

from sinuous.base.errors import InputError
from sinuous.base.processes import pool_of
from sinuous.scene.grids import Field
from sinuous.solver.thread_pool import dismiss
from sinuous.studies.batch.tables.layout import Block
from sinuous.studies.batch.work import Chunk, ChunkSolver

PER_WORKER = 2
"""Tasks in flight for each worker process: the next one is there when a worker has finished its last."""


class LostError(Exception):
    """The engine is gone, and no chunk can be solved any more; its text says what happened."""


class Engine(ABC):
    """Solves chunks elsewhere.

    Attributes
    ----------
    most_in_flight : int
        Most chunks that are handed out at the same time, so that no worker waits.
    gone : str
        What has happened when chunks are cancelled that were not cancelled here.
    """

    most_in_flight: int
    gone = "the workers are gone"

    @abstractmethod
    def submit(self, chunk: Chunk) -> "Future[Block]":
        """Hand a chunk to a worker.

        Raises
        ------
        LostError, BrokenExecutor
        """

    def restart(self) -> None:
        """Begin anew after workers died; chunks in flight are forgotten.

        Raises
        ------
        LostError
            When this engine cannot.
        """
        raise LostError("the executor broke: a worker died")

    @abstractmethod
    def close(self, now: bool) -> None:
        """End; with `now`, do not wait for chunks in flight."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """End; what was interrupted, or went wrong, ends now."""
        self.close(now=kind is not None)


class Threads(Engine):
    """Threads of this process, each with a chunk of its own: compiled code runs without the interpreter's lock."""

    def __init__(self, work: Callable[[Chunk], Block], workers: int) -> None:
        self._work = work
        self._pool = ThreadPoolExecutor(workers)
        self._lock, self._busy = Lock(), set[int]()
        self.most_in_flight = workers + 1

    def submit(self, chunk: Chunk) -> "Future[Block]":
        """Hand a chunk to a thread."""
        return self._pool.submit(self._do, chunk)

    def _do(self, chunk: Chunk) -> Block:
        """Solve a chunk, in a thread that may be dismissed meanwhile."""
        with self._lock:
            self._busy.add(get_ident())
        try:
            return self._work(chunk)
        finally:
            with self._lock:
                self._busy.discard(get_ident())

    def close(self, now: bool) -> None:
        """End; with `now`, stop the threads wherever they are, also in compiled code."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        if now:
            with self._lock:
                dismiss(self._busy)
        self._pool.shutdown(wait=True)


class Processes(Engine):
    """Processes of this machine, each with a scene and kernels of its own; a dead one is replaced.

    Chunks and answers travel in files of a temporary folder, and pipes carry their names alone: a process that is
    killed while it writes or reads more than a pipe takes at once would leave the others waiting for the rest forever.
    """

    def __init__(self, work: ChunkSolver, workers: int) -> None:
        self._data, self._workers = pickled(work), workers
        self.most_in_flight = PER_WORKER * workers
        self._folder = tempfile.TemporaryDirectory(prefix="sinuous-", ignore_cleanup_errors=True)
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        pool = pool_of(self._workers, _take_work, self._data)
        try:
            pool.submit(os.getpid).result()
        except BrokenExecutor:
            pool.shutdown(wait=False)
            hint = "a script needs its calls under 'if __name__ == \"__main__\":'"
            raise LostError(f"worker processes could not begin ({hint})") from None
        return pool

    def submit(self, chunk: Chunk) -> "Future[Block]":
        """Hand a chunk to a process."""
        answer: Future[Block] = Future()
        name = to_file(chunk, self._folder.name)
        self._pool.submit(solve_file, name).add_done_callback(partial(_pass_on, answer))
        return answer

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


def _pass_on(answer: "Future[Block]", named: "Future[str]") -> None:
    """Let an answer be what is in the file that is named, or what went wrong."""
    if named.cancelled():
        answer.cancel()
        answer.set_running_or_notify_cancel()
        return
    try:
        answer.set_result(from_file(named.result()))
    except Exception as error:  # whatever happened in the worker belongs to the chunk
        answer.set_exception(error)


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
    """An executor of the caller, who keeps it; the work travels with every chunk, unless it is one of threads."""

    def __init__(self, work: ChunkSolver, executor: Executor, workers: int) -> None:
        self._executor = executor
        self._work = work if isinstance(executor, ThreadPoolExecutor) else None
        self._data = b"" if self._work is not None else pickled(work)
        self._name = hashlib.sha256(self._data).hexdigest()
        self.most_in_flight = PER_WORKER * max(workers, getattr(executor, "_max_workers", workers))

    def submit(self, chunk: Chunk) -> "Future[Block]":
        """Hand a chunk to the executor."""
        try:
            if self._work is not None:
                return self._executor.submit(self._work, chunk)
            return self._executor.submit(_solve_with, self._name, self._data, chunk)
        except BrokenExecutor:
            raise
        except RuntimeError as error:
            raise LostError(f"the executor takes no more: {error}") from None

    def close(self, now: bool) -> None:
        """Leave the executor to the caller."""


_work: dict[str, ChunkSolver] = {}
"""In a worker process: the work that it has, by the hash of what travelled."""


def _take_work(data: bytes, name: str = "") -> ChunkSolver:
    """In a worker process: unpickle the work and load what it needs, once."""
    if name not in _work:
        _work[name] = pickle.loads(data).prepare()
    return _work[name]


def solve_file(name: str) -> str:
    """In a worker process: solve the chunk in a file; return the name of a file with the answer, beside it."""
    return to_file(_work[""](from_file(name)), str(Path(name).parent))


def _solve_with(name: str, data: bytes, chunk: Chunk) -> Block:
    """In a worker process: solve a chunk with the work that came with it."""
    return _take_work(data, name)(chunk)


def pickled(work: ChunkSolver) -> bytes:
    """Return the work as it travels to other processes.

    Raises
    ------
    InputError
        When the scene holds what cannot travel.
    """
    try:
        return pickle.dumps(work, pickle.HIGHEST_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        for i, obstacle in enumerate(work.scene.obstacles):
            if isinstance(obstacle, Field):
                wanted = "a function of a module that workers can import too, or the engine threads"
                raise InputError(f"scene[{i}]", f"cannot travel: {error}", obstacle.function, wanted) from None
        raise
