"""Progress on standard error, for long work in front of a person."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

LONG = 10
"""Solves from which on a bar is worth showing."""

PATIENCE, LEAST = 0.5, 0.1
"""Seconds after which a person wants to know what takes so long, and of them the least for reading: starting Python and
importing the library count, too."""


class Bar:
    """Counts solves; shows nothing when there are few or when nobody looks."""

    def __init__(self, total: int) -> None:
        self._progress: Any = None
        if total >= LONG and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn  # noqa: PLC0415

            # Without redirection: results on standard output must stay there.
            self._progress = Progress(
                "solving",
                BarColumn(),
                MofNCompleteColumn(),
                TimeRemainingColumn(),
                console=Console(stderr=True),
                transient=True,
                redirect_stdout=False,
                redirect_stderr=False,
            )
            self._task = self._progress.add_task("solving", total=total)
            self._progress.start()

    def __enter__(self) -> "Bar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def advance(self) -> None:
        """Count one solve."""
        if self._progress is not None:
            self._progress.advance(self._task)

    @contextmanager
    def hidden(self) -> Iterator[None]:
        """Take the bar away while something else is printed."""
        if self._progress is None:
            yield
            return
        self._progress.stop()
        yield
        self._progress.start()


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
