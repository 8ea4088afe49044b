"""Locks between processes, so that what one compiles the others wait for instead of compiling it, too.

A lock is a byte of one file, chosen by what is locked. The operating system frees it when its process ends, however it
ends. Kernels are compiled from callers to callees, so whoever waits for a lock holds those of callers alone, and nobody
waits in a circle. Where files cannot be locked, nobody waits.
"""

import contextlib
import hashlib
import os
import time
from collections.abc import Iterator
from pathlib import Path

PATIENCE = 300.0
"""Seconds after which nobody waits any longer: who holds the lock may have been stopped."""

_prefix = ""
"""What the names of this process's locks begin with."""

PAUSE = 0.02
"""Seconds between two looks."""

_files: dict[tuple[int, Path], int] = {}
"""Open files by process and path. They stay open: closing one would free all locks that the process has in it."""


def use_own_locks(prefix: str) -> None:
    """Let the locks of this process be others than those of other processes.

    Processes of low priority do so (`helpers`), so that none waits for one that does not come to its turn.
    """
    global _prefix  # noqa: PLW0603
    _prefix = prefix


@contextlib.contextmanager
def locked(file: Path, name: str) -> Iterator[None]:
    """Hold the lock of this name, once whoever holds it now is done."""
    place = int.from_bytes(hashlib.sha256(f"{_prefix}{name}".encode()).digest()[:7], "little")
    handle, held, end = _opened(file), False, time.monotonic() + PATIENCE
    while handle is not None and not held and time.monotonic() < end:
        try:
            _take(handle, place)
            held = True
        except (BlockingIOError, PermissionError):
            time.sleep(PAUSE)
        except OSError:  # nothing can be locked there
            break
    try:
        yield
    finally:
        if handle is not None and held:
            with contextlib.suppress(OSError):
                _free(handle, place)


def _opened(file: Path) -> int | None:
    key = os.getpid(), file
    if key not in _files:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            _files[key] = os.open(file, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o600)
        except OSError:
            return None
    return _files[key]


try:
    import fcntl

    def _take(handle: int, place: int) -> None:
        fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)

    def _free(handle: int, place: int) -> None:
        fcntl.lockf(handle, fcntl.LOCK_UN, 1, place)

except ImportError:  # Windows
    import msvcrt

    def _take(handle: int, place: int) -> None:
        os.lseek(handle, place, os.SEEK_SET)
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]

    def _free(handle: int, place: int) -> None:
        os.lseek(handle, place, os.SEEK_SET)
        msvcrt.locking(handle, msvcrt.LK_UNLCK, 1)  # type: ignore[attr-defined]
