"""Processes that work for this one, and end with it."""

import multiprocessing
import os
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any


def pool_of(count: int, begin: Callable[..., object], *given: Any) -> ProcessPoolExecutor:
    """Return a pool of so many new processes, each of which calls `begin(*given)` first.

    They end when this process does, however it ends: by itself a process of a pool would wait for work for ever.
    """
    spawn = multiprocessing.get_context("spawn")  # threads, as compiled code may have, are not safe to fork
    return ProcessPoolExecutor(count, spawn, _begin, (begin, given))


def _begin(begin: Callable[..., object], given: tuple[Any, ...]) -> None:
    """In a process of a pool: watch the process that it works for."""
    threading.Thread(target=_watch, name="sinuous-watch", daemon=True).start()
    begin(*given)


def _watch() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
