"""All problem files of a command, read before the first is answered; a person who waits sees how far that is."""

import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import typer

from sinuous.base import checks
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.base.progress import ProgressBar
from sinuous.cli.options import INTERRUPTED, as_typed, check_writable
from sinuous.files.documents import json_line
from sinuous.model.robot import Robot
from sinuous.motion.job import Job, read_problem
from sinuous.solver.memory import Memory

PATIENCE = 0.5
"""Seconds of the process, from its start, after which a person wants to know what takes so long."""

LEAST = 0.1
"""Seconds that reading takes at least until it is shown, however long the start of Python took."""


@dataclass(frozen=True)
class ReadProblem:
    """A problem file, its scene prepared, and the seconds that all of that took."""

    problem: Job
    seconds: float


def read_all(files: list[str], demands: Mapping[str, Any] | None = None) -> list[ReadProblem]:
    """Read problem files with all that they name, and prepare their scenes.

    `demands` are clearances that are typed, which replace those of the files.

    Raises
    ------
    InputError
        For the first that is wrong.
    """
    result = []
    with ProgressBar(late=max(LEAST, PATIENCE - time.process_time())) as bar:
        for file in files:
            bar.say(f"reading {file}")
            began = time.perf_counter()
            problem = read_problem(file)
            if demands:
                with as_typed(*demands):
                    problem = problem.demanding(**demands)
            with checks.in_file(file):
                problem.scene.prepare(lambda what, share: bar.say(f"preparing {what}", share))
            result.append(ReadProblem(problem, time.perf_counter() - began))
    return result


def say_notes(notes: dict[str, tuple[str, ...]]) -> None:
    """Print what is not as it should be in each file, each note once, on standard error."""
    for note in dict.fromkeys(f"{file}: {note}" for file, own in notes.items() for note in own):
        typer.echo(f"note: {note}", err=True)


@contextmanager
def setting_of(file: str) -> Iterator[Job]:
    """Read a problem file but for its targets, and say its notes; what else is warned of within are notes, too."""
    setting = read_problem(file, question=False)
    say_notes({file: setting.notes})
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", SuspiciousInput)
        yield setting
    for note in dict.fromkeys(str(each.message) for each in said):
        if note not in setting.notes:
            typer.echo(f"note: {note}", err=True)


@contextmanager
def remembered(file: Path | None, robots: Mapping[str, Robot]) -> Iterator[Memory | None]:
    """Yield the memory in a file, or a new one where it is not there; in the end, write what is kept then.

    Where something is refused within, nothing is written.

    `robots`: the one of each problem file, which all must be the robot of the memory. Without a file there is none.
    """
    if file is None:
        yield None
        return
    with as_typed("memory"):
        memory = Memory.load(file) if file.exists() else Memory(next(iter(robots.values())))
        for robot in robots.values():
            memory.check(robot)
    check_writable("--memory", file, list(robots))
    try:
        yield memory
    finally:
        if not isinstance(sys.exception(), InputError):
            memory.save(file)


@contextmanager
def interruptible(kept: str | Callable[[], str]) -> Iterator[None]:
    """End the command where it is interrupted within, with one line that says what is kept."""
    try:
        yield
    except KeyboardInterrupt:
        told = kept if isinstance(kept, str) else kept()
        typer.echo(f"sinuous: interrupted; {told}", err=True)
        raise typer.Exit(INTERRUPTED) from None


class Summary(Protocol):
    """What a long run comes to."""

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        ...


def say(file: str, found: Summary, *, json: bool) -> None:
    """Print what came of a file: a JSON object, or what is printed of it, with the file instead of its kind."""
    told = str(found).split(": ", 1)[-1]
    typer.echo(json_line({"file": file, **found.to_dict()}) if json else f"{file}: {told}")
