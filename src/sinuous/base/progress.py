"""How far a long run is, on standard error: a bar for a person who waits, lines for a log."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

LONG = 10
"""Solves from which on a bar is worth showing."""

LOG_EVERY = 60.0
"""Seconds between two lines where standard error is no terminal."""


class ProgressBar:
    """Counts solves.

    Parameters
    ----------
    total : int
        How many there are; a bar is shown from `LONG` on.
    logged : bool
        Whether to write a line from time to time where standard error is no terminal.
    what : str
        What is done to each.
    """

    def __init__(self, total: int, logged: bool = False, what: str = "solving") -> None:
        self._total, self._done = total, 0
        self._began = self._written = time.monotonic()
        self._lock = Lock()
        self._logged = logged and not sys.stderr.isatty()
        self._bar: Any = None
        if total >= LONG and sys.stderr.isatty():
            from rich.progress import BarColumn, TextColumn, TimeRemainingColumn  # noqa: PLC0415

            counts = TextColumn("{task.completed:,} of {task.total:,}"), TextColumn("{task.fields[rate]}")
            self._bar = rich_progress(what, BarColumn(), *counts, TimeRemainingColumn())
            self._task = self._bar.add_task(what, total=total, rate="")
            self._bar.start()

    def __enter__(self) -> "ProgressBar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def advance(self, count: int = 1) -> None:
        """Count so many solves more; from any thread."""
        if self._bar is None and not self._logged:
            return
        with self._lock:
            self._done += count
            now = time.monotonic()
            rate = self._done / max(1e-9, now - self._began)
            if self._bar is not None:
                self._bar.update(self._task, completed=self._done, rate=f"{rate:,.0f} a second")
            elif now - self._written >= LOG_EVERY:
                self._written = now
                left = (self._total - self._done) / rate
                counts = f"{self._done:,} of {self._total:,} rows, {rate:,.0f} a second, {left:,.0f} s left"
                sys.stderr.write(f"sinuous: {counts}\n")

    @contextmanager
    def hidden(self) -> Iterator[None]:
        """Take the bar away while something else is printed."""
        if self._bar is None:
            yield
            return
        self._bar.stop()
        yield
        self._bar.start()


def rich_progress(*columns: Any) -> Any:
    """Return a `rich` progress display on standard error that disappears in the end.

    Standard output is not redirected: results that are printed there must stay there.
    """
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import Progress  # noqa: PLC0415

    console = Console(stderr=True)
    return Progress(*columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False)
