"""Work that is done in as many processes as there are cores."""

import math
import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing.queues import SimpleQueue
from typing import TypeVar

from sinuous.base.errors import SuspiciousInput
from sinuous.base.system import pool_of
from sinuous.scene import sampling

Item = TypeVar("Item")
Result = TypeVar("Result")


def ignore_suspicions() -> None:
    """Keep warnings of suspicious input to ourselves: random problems are odd on purpose."""
    warnings.simplefilter("ignore", SuspiciousInput)


def in_processes(
    work: Callable[[Item], Result], items: Iterable[Item], alone: bool = False, chunk: int = 1
) -> Iterator[Result]:
    """Yield results in the order of the items, made in as many processes as there are cores, or (`alone`) in this one.

    Every process keeps to a core of its own, where the system lets it. An interrupt is left to the process that
    gathers.
    """
    if alone:
        yield from map(work, items)
        return
    try:
        yield from _pool().map(work, items, chunksize=chunk)
    except (KeyboardInterrupt, GeneratorExit):
        _stop()
        raise


@cache
def _pool() -> ProcessPoolExecutor:
    """Return the processes, which stay until the end: each loads the kernels once."""
    cores = _cores()
    waiting = multiprocessing.get_context("spawn").SimpleQueue()
    for core in cores:
        waiting.put(core)
    return pool_of(len(cores), _begin, waiting)


def _stop() -> None:
    """Let the processes finish what they are at, and end.

    A second interrupt is not heard meanwhile: it would leave processes behind that wait for work for ever.
    """
    pool = _pool()
    _pool.cache_clear()
    heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        pool.shutdown(cancel_futures=True)
    finally:
        signal.signal(signal.SIGINT, heard)


def _cores() -> list[int]:
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def _begin(cores: "SimpleQueue[int]") -> None:
    """Take a core, on which threads that libraries start stay too, and be quiet.

    Samples of places are not kept on disk: nobody asks for them again, and what other scenes have there would go.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ignore_suspicions()
    sampling.WORTH_KEEPING = math.inf
    core = cores.get()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    os.environ.setdefault("IGL_NUM_THREADS", "1")  # else every process would use all cores
