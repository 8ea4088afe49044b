"""What solve, track and plan keep of their answers, so that the same command goes on after an interruption.

The answers to several files are found in order, some of them waypoint by waypoint; each is an entry. Entries are plain
values, and those of about a second make a chunk of a checkpoint.
"""

import json
import time as clock
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.documents import described
from sinuous.base.errors import InputError
from sinuous.cli.options import Solving, as_typed
from sinuous.motion.job import Job
from sinuous.problem.target import target_table
from sinuous.solver.options import SolveOptions
from sinuous.studies.runs.engine import Checkpoint, hash_of, problem_record

WRITE_SECONDS = 1.0
"""Seconds of work that may be lost when a process is killed."""

MakeEntry = Callable[[], dict[str, Any]]
"""Makes an entry of what was found, when it is to be written."""


class Journal:
    """Keeps what was found of some problems, until all is done.

    Parameters
    ----------
    results : Path
        A file of the answers.
    record : mapping of str to str
        All that the answers depend on.

    Raises
    ------
    InputError
        When what is kept there is of something else, or cannot be read.
    """

    def __init__(self, results: Path, record: Mapping[str, str]) -> None:
        self._checkpoint = Checkpoint(results, record, "this command")
        self._found: dict[int, list[dict[str, Any]]] = {}
        self._problem = -1
        first = self._read() if self._checkpoint.begun else 0
        self._new = first, list[tuple[int, MakeEntry]]()  # number of the next chunk, and what is to be in it
        self._written = clock.perf_counter()

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *_: object) -> None:
        """Write what is not written yet, whatever ends the command."""
        self.write()

    def begin(self) -> list[dict[str, Any]]:
        """Begin with the next problem; return its entries that an earlier command found, in order."""
        self._problem += 1
        return self._found.get(self._problem, [])

    def add(self, make: MakeEntry) -> None:
        """Keep what was found of this problem; from time to time, all is written."""
        self._new[1].append((self._problem, make))
        if clock.perf_counter() - self._written > WRITE_SECONDS:
            self.write()

    def write(self) -> None:
        """Write what is not written yet; when that is interrupted, it may be called again."""
        number, entries = self._new
        if not entries:
            return
        if not self._checkpoint.begun:
            self._open()
        text = json.dumps([{"problem": problem, **make()} for problem, make in entries])
        self._checkpoint.write(number, {"entries": np.array(text.encode())})
        self._new = number + 1, []  # both at once: an interrupt comes before or after it
        self._written = clock.perf_counter()

    def remove(self) -> None:
        """Delete what is kept: all is done."""
        self._new = 0, []
        self._checkpoint.remove()

    def unreadable(self) -> InputError:
        """Return the refusal of entries that make no sense."""
        place = str(self._checkpoint.folder)
        return InputError("--out", "what is kept beside it cannot be read", place, "what this command kept, or none")

    def _open(self) -> None:
        with as_typed("out"):
            self._checkpoint.open()

    def _read(self) -> int:
        """Read all entries; return the number of the next chunk."""
        self._open()
        checkpoint, count = self._checkpoint, 0
        for number in checkpoint.done():
            if number > count:  # one before it is broken: the machine lost its power
                checkpoint.delete(number)
                continue
            try:
                for entry in json.loads(checkpoint.read(number, "entries")["entries"].item()):
                    self._found.setdefault(entry["problem"], []).append(entry)
            except (OSError, zipfile.BadZipFile, KeyError, TypeError, ValueError):
                raise self.unreadable() from None
            count += 1
        return count


def record_of(problems: list[Job], solving: Solving, typed: Mapping[str, object]) -> dict[str, str]:
    """Return all that the answers to some problems depend on; `typed` are options of one command alone."""
    record = {"files": ", ".join(problem.file for problem in problems), **{f"--{k}": str(v) for k, v in typed.items()}}
    for problem in problems:
        options = SolveOptions(**solving.arguments(problem.tolerance, problem.prefer))
        scene = problem.scene.snapshot()
        entries = {
            **problem_record(problem.robot, scene.at(0.0), options),
            "moving": hash_of(
                *(part.tobytes() for one in scene.courses.values() for part in (one.times, *one.poses(one.times)))
            ),
            "path": hash_of(*(target_table(problem.robot, targets).tobytes() for targets in problem.waypoints)),
            "times": _hash(problem.times),
            "start": _hash(problem.start),
            "goal": _hash(problem.goal),
            "rates": json.dumps(described(problem.rates)),
        }
        record |= {f"{problem.file}: {key}": value for key, value in entries.items()}
    return record


def _hash(values: Floats | None) -> str:
    return "none" if values is None else hash_of(values.tobytes())
