"""A bar on standard error that counts solves, for a person who waits."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

LONG = 10
"""Solves from which on a bar is worth showing."""


class ProgressBar:
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

    def __enter__(self) -> "ProgressBar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def advance(self, count: int = 1) -> None:
        """Count so many solves more; from any thread."""
        if self._progress is not None:
            self._progress.advance(self._task, count)

    @contextmanager
    def hidden(self) -> Iterator[None]:
        """Take the bar away while something else is printed."""
        if self._progress is None:
            yield
            return
        self._progress.stop()
        yield
        self._progress.start()
