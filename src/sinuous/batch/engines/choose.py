"""Which engine is meant."""

from concurrent.futures import Executor
from typing import Any

from sinuous.batch.engines.cluster import LOCAL, Dask
from sinuous.batch.engines.engine import Engine
from sinuous.batch.engines.processes import Given, Processes
from sinuous.batch.engines.threads import Threads
from sinuous.batch.work import Work
from sinuous.errors import InputError

EXPECTED = "threads, processes, dask, the address of a Dask scheduler, a client of one, or an executor"


def begin(engine: Any, work: Work, workers: int) -> Engine:
    """Make an engine ready.

    Raises
    ------
    InputError
        When nothing is called so, a package is missing, or no scheduler answers.
    LostError
        When its workers cannot begin.
    """
    work.prepare()  # compiled once, before several workers ask for it
    if engine == "threads":
        return Threads(work, workers)
    if engine == "processes":
        return Processes(work, workers)
    if engine == "dask":
        return Dask(work, LOCAL, workers)
    if isinstance(engine, str) and "://" in engine:
        return Dask(work, engine, workers)
    if type(engine).__module__.partition(".")[0] == "distributed":
        return Dask(work, engine, workers)
    if isinstance(engine, Executor):
        return Given(work, engine, workers)
    raise InputError("engine", "", engine, EXPECTED)
