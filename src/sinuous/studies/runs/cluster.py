"""Dask distributed (the extra `cluster`): workers on this machine, or on any number of others."""

import logging
import pickle
from concurrent.futures import Future
from typing import Any
from uuid import uuid4

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.studies.runs.engine import Arrays, Engine, LostError, Work
from sinuous.studies.runs.engines import PER_WORKER, pickled

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
