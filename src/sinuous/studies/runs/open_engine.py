"""The engine that is meant by a name, an address, a client of Dask or an executor."""

from concurrent.futures import Executor
from typing import Any

from sinuous.base.errors import InputError
from sinuous.studies.runs.cluster import LOCAL, Dask
from sinuous.studies.runs.engine import Engine, Work
from sinuous.studies.runs.engines import GivenExecutor, Processes, Threads


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
