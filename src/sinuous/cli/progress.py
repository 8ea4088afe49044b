"""Progress on standard error, for long work in front of a person."""

import sys
import threading
import time
from typing import Any

PATIENCE, LEAST = 0.5, 0.1
"""Seconds after which a person wants to know what takes so long, and of them the least for reading: starting Python and
importing the library count, too."""


class Waiting:
    """Says what is being read, and how much of it is done; shows nothing when it is quick or when nobody looks."""

    def __init__(self) -> None:
        self._progress: Any = None
        if sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415
            from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn  # noqa: PLC0415

            columns = SpinnerColumn(), TextColumn("{task.description}"), BarColumn()
            self._progress = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False)
            self._task = self._progress.add_task("reading", total=None)
            self._late = threading.Timer(max(LEAST, PATIENCE - time.process_time()), self._progress.start)
            self._late.daemon = True

    def __enter__(self) -> "Waiting":
        if self._progress is not None:
            self._late.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._late.cancel()
            self._late.join()
            self._progress.stop()

    def begin(self, what: str) -> None:
        """Name what is read from now on."""
        if self._progress is not None:
            self._progress.update(self._task, description=f"reading {what}", total=None)

    def told(self, what: str, share: float) -> None:
        """Show the share of `what`, 0 to 1, that is ready."""
        if self._progress is not None:
            self._progress.update(self._task, description=f"preparing {what}", total=1.0, completed=share)
