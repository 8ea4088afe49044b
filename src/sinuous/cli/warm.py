"""The command warm: compile everything now, so that nobody waits for it later."""

import sys
import time as clock
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import typer

from sinuous.errors import InputError
from sinuous.kernels.compile import Piece, told_to
from sinuous.methods.registry import METHODS
from sinuous.solving.warm import Step, steps

DONE, INTERRUPTED = 0, 130


def warm_up(methods: Sequence[str]) -> int:
    """Compile what these methods need, by default all; return the exit code.

    Raises
    ------
    InputError
        When there is no such method.
    """
    for name in methods:
        if name not in METHODS:
            raise InputError("--method", "", name, "one of " + ", ".join(METHODS))
    listed = steps(methods or METHODS)
    began = clock.perf_counter()
    try:
        with _shown(len(listed)) as shown, told_to(shown.compiling):
            for step in listed:
                shown.begin(step)
                step.use()
                shown.done += 1
    except KeyboardInterrupt:
        typer.echo(f"sinuous: interrupted after {shown.done} of {len(listed)}; what is compiled stays so", err=True)
        return INTERRUPTED
    seconds = clock.perf_counter() - began
    typer.echo(f"everything is compiled, in {seconds:.0f} s" if shown.compiled else "everything was compiled before")
    return DONE


class _Lines:
    """Says in lines what is compiled, where nobody looks at a bar."""

    def __init__(self, total: int) -> None:
        self.total, self.done, self.compiled = total, 0, 0

    def begin(self, step: Step) -> None:
        """Go on to a step: whether anything is to be compiled for it is not known yet."""

    def compiling(self, piece: Piece) -> None:
        """Say what is about to be compiled."""
        self.compiled += 1
        self.show(f"compiling {piece.what} (about {piece.seconds} s)")

    def show(self, text: str) -> None:
        """Say something of the step under way."""
        typer.echo(f"sinuous: {self.done + 1} of {self.total}: {text}", err=True)


class _Bar(_Lines):
    """Shows what is compiled, how many are done, and for how long."""

    def __init__(self, total: int, progress: Any) -> None:
        super().__init__(total)
        self._progress = progress
        self._task = progress.add_task("", total=total)

    def begin(self, step: Step) -> None:
        """Show what is looked at."""
        self.show(f"loading {step.what}")

    def show(self, text: str) -> None:
        """Show the bar with this text."""
        self._progress.update(self._task, completed=self.done, description=text)


@contextmanager
def _shown(total: int) -> Iterator[_Lines]:
    if not sys.stderr.isatty():
        yield _Lines(total)
        return
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import (  # noqa: PLC0415
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False) as progress:
        yield _Bar(total, progress)
