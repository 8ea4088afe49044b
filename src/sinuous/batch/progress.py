"""How many rows are done, how many a second, and how long it still takes: a bar for a person, lines for a log."""

import sys
import time
from typing import Any

EVERY = 60.0
"""Seconds between two lines where nobody looks."""


class Progress:
    """Says on standard error how far a batch is."""

    def __init__(self, rows: int, shown: bool) -> None:
        self._rows, self._done = rows, 0
        self._began = self._said = time.monotonic()
        self._bar: Any = None
        self._shown = shown
        if shown and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415
            from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

            told = TextColumn("{task.completed:,} of {task.total:,}"), TextColumn("{task.fields[rate]}")
            console = Console(stderr=True)
            columns = "solving", BarColumn(), *told, TimeRemainingColumn()
            self._bar = Progress(
                *columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False
            )
            self._task = self._bar.add_task("solving", total=rows, rate="")
            self._bar.start()

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def advance(self, count: int) -> None:
        """Count so many rows more."""
        self._done += count
        now = time.monotonic()
        rate = self._done / max(1e-9, now - self._began)
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, rate=f"{rate:,.0f} a second")
        elif self._shown and now - self._said >= EVERY:
            self._said = now
            left = (self._rows - self._done) / rate
            told = f"{self._done:,} of {self._rows:,} rows, {rate:,.0f} a second, {left:,.0f} s left"
            sys.stderr.write(f"sinuous: {told}\n")
