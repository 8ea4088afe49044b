"""What is asked of the operating system: processes that end with this one, and directories for what is kept."""

import multiprocessing
import os
import sys
import tempfile
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
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


def places(name: str) -> list[Path]:
    """Directories of this name to try, best first: in the user's cache, or where temporary files are.

    `SINUOUS_CACHE`, if it is set, names the one directory that all of it goes into.
    """
    own = os.environ.get("SINUOUS_CACHE")
    if own:
        return [Path(own).expanduser() / name]
    user = os.getuid() if hasattr(os, "getuid") else 0
    return [_of_user() / "sinuous" / name, Path(tempfile.gettempdir()) / f"sinuous-{user}" / name]


def writable(directory: Path) -> bool:
    """Make a directory, and tell whether files can be made in it, by this user and nobody else."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            return is_private(directory)
    except OSError:
        return False


def is_private(directory: Path) -> bool:
    """Tell whether nobody but this user, and the system, may write into a directory: others could plant files."""
    if not hasattr(os, "getuid"):
        return True
    found = directory.stat()
    return found.st_uid in {os.getuid(), 0} and not found.st_mode & 0o002


def _of_user() -> Path:
    """The platform's directory for caches of this user."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    named = os.environ.get("XDG_CACHE_HOME")
    if named:
        return Path(named)
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
