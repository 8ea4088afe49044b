"""Processes of a test: whether they live, how they are waited for, and the command line in one of its own."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

from sinuous.cli.app import main

PATIENCE = 300.0
"""Seconds until a process that does nothing fails a test."""


def until(true: Callable[[], bool], seconds: float = PATIENCE) -> bool:
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.05)
    return true()


def alive(number: int) -> bool:
    """Whether there is such a process; one that has ended, and that nobody asked for, does not count."""
    try:
        os.kill(number, 0)
        state = Path(f"/proc/{number}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return False
    return state != "Z"


class Command:
    """The command line in a process of its own, forked from one that has loaded what it needs.

    Parameters
    ----------
    typed : sequence of str
        What follows `sinuous`.
    folder : Path
        Where it runs; there is what it says, too.
    before : callable, optional
        A function of a module that changes something within the process first.
    """

    def __init__(self, typed: list[str], folder: Path, before: Callable[[], None] | None = None) -> None:
        self._said = folder / "stderr.txt"
        arguments = typed, folder, self._said, before
        self._process = multiprocessing.get_context("spawn").Process(target=_run, args=arguments)
        self._process.start()

    @property
    def code(self) -> int | None:
        """The exit code, negative after a signal; `None` while it runs."""
        return self._process.exitcode

    def send(self, end: signal.Signals) -> None:
        """Send it a signal."""
        os.kill(self._process.pid or 0, end)

    def said(self) -> str:
        """Wait for its end, and return what it wrote on standard error."""
        self._process.join(PATIENCE)
        assert self.code is not None
        return self._said.read_text(encoding="utf-8")


def _run(typed: list[str], folder: Path, said: Path, before: Callable[[], None] | None) -> None:
    os.chdir(folder)
    for number, name in ((1, os.devnull), (2, str(said))):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT), number)
    if before is not None:
        before()
    sys.exit(main(typed))
