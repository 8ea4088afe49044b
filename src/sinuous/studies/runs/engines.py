"""Engines: threads and processes of this machine, executors that a caller has, and workers of Dask distributed.

Dask (the extra `cluster`) has workers on this machine, or on any number of others.
"""

import hashlib
import logging
import os
import pickle
import tempfile
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any
from uuid import uuid4

from sinuous.base import checks
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


LOCAL = "local"
"""In the place of an address: workers on this machine."""

ANSWER_SECONDS = 20.0
"""Seconds that a scheduler has to answer."""

CLOSING_SECONDS = 2.0
"""Seconds that a cluster has to close when it must end now."""

REASON_LENGTH = 120
"""Letters of what Dask says that are repeated."""

NO_PAGE: dict[str, Any] = {"dashboard_address": ":0", "scheduler_kwargs": {"dashboard": False}}
"""What makes a `LocalCluster` of ours serve no page. An address it must have: without one it asks for port 8787, and
warns where another cluster of this machine has it."""

LOGGERS = "distributed", "tornado", "asyncio"
"""Packages that would log on many lines that a connection ended."""


def distributed() -> Any:
    """Return the package.

    Raises
    ------
    InputError
        When it is not installed.
    """
    return checks.needed("distributed", "cluster", "dask", "dask")


def _do(name: str, task: Arrays) -> Arrays:
    """In a worker: do a task with the work that it has."""
    work: Work = distributed().get_worker().plugins[name].work
    return work(task)


def _plugin(data: bytes, name: str) -> Any:
    """Return a plugin that brings the work once to every worker, also to those that join later, and loads kernels."""

    class Bring(distributed().WorkerPlugin):  # type: ignore[misc]
        """See `_plugin`."""

        def __init__(self) -> None:
            self.name, self.data = name, data
            self.work: Work | None = None

        def setup(self, worker: Any) -> None:
            """Unpickle the work."""
            self.work = pickle.loads(self.data).prepare()
            self.data = b""

    return Bring()


class Dask(Engine):
    """The workers of a scheduler.

    Parameters
    ----------
    work : Work
    where : str or Client
        Address of a scheduler, `local`, or a client, which is left to the caller.
    workers : int
        Of those on this machine.
    """

    gone = "the Dask scheduler is gone"

    def __init__(self, work: Work, where: Any, workers: int) -> None:
        super().__init__()
        module = distributed()
        data = pickled(work)
        self._own: list[Any] = []
        self._client = where if not isinstance(where, str) else self._connect(module, where, workers)
        self._name = f"sinuous-{uuid4().hex}"
        try:
            self._client.register_plugin(_plugin(data, self._name), name=self._name)
        except Exception as error:
            self.close(now=True)
            raise LostError(f"the workers could not be prepared: {type(error).__name__}: {error}") from None
        self._pool = self._client.get_executor(pure=False)
        self.most_in_flight = PER_WORKER * max(1, sum(self._client.nthreads().values()))

    def _connect(self, module: Any, where: str, workers: int) -> Any:
        """Begin a client, and perhaps workers; what ends a run is said in one line, and not on many by loggers."""
        for name in list(logging.root.manager.loggerDict):
            if name.partition(".")[0] in LOGGERS:
                logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            if where == LOCAL:
                settings = {"n_workers": workers, "threads_per_worker": 1, "silence_logs": logging.CRITICAL}
                self._own.append(module.LocalCluster(**settings, **NO_PAGE))
            client = module.Client(self._own[0] if self._own else where, timeout=ANSWER_SECONDS)
        except (OSError, ValueError, TypeError) as error:
            why = " ".join(str(error).split())[:REASON_LENGTH]
            raise InputError("dask", why or "no answer", where, "the address of a scheduler that runs") from None
        self._own.insert(0, client)
        return client

    def submit(self, task: Arrays) -> "Future[Arrays]":
        """Hand a task to a worker; a worker that dies is replaced by another one, up to three times."""
        if self._client.status != "running":
            raise LostError(self.gone)
        return self._pool.submit(_do, self._name, task)

    def restart(self) -> None:
        """Refuse: without a scheduler all is lost."""
        raise LostError(self.gone)

    def close(self, now: bool) -> None:
        """End what was begun here; a client that was given stays."""
        if not self._own and not now:
            self._client.unregister_worker_plugin(self._name)
        for each in self._own:
            each.close(timeout=CLOSING_SECONDS if now else ANSWER_SECONDS)
        self._own.clear()


def open_engine(engine: Any, work: Work, workers: int) -> Engine:
    """Make the engine that is meant ready.

    Raises
    ------
    InputError
        When no engine has this name, a package is missing, or no scheduler answers.
    LostError
        When its workers cannot begin.
    """
    work.prepare()  # compiled once, before several workers ask for it
    if engine == "threads":
        return Threads(work, workers)
    if engine == "processes":
        return Processes(work, workers)
    if isinstance(engine, Executor):
        return GivenExecutor(work, engine, workers)
    address = isinstance(engine, str) and (engine == "dask" or "://" in engine)
    if address or type(engine).__module__.partition(".")[0] == "distributed":
        return Dask(work, LOCAL if engine == "dask" else engine, workers)
    wanted = "threads, processes, dask, the address of a Dask scheduler, a client of one, or an executor"
    raise InputError("engine", "", engine, wanted)
