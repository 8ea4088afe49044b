"""Work that is done in as many processes as there are cores."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_processes(
    work: Callable[[Item], Result], items: Iterable[Item], alone: bool = False, chunk: int = 1
) -> Iterator[Result]:
    """Yield results in the order of the items, made in as many processes as there are cores, or (`alone`) in this one.

    An interrupt is left to the process that gathers.
    """
    if alone:
        yield from map(work, items)
        return
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), spawn, _begin) as pool:
        yield from pool.map(work, items, chunksize=chunk)


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.setdefault("IGL_NUM_THREADS", "1")  # else every process would use all cores
