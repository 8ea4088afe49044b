"""The journal of a command that may be interrupted: what it found so far, beside a file of its answers.

The first line says what was asked, every other one what a waypoint added, or a plan that was found. A process that is
killed leaves a line that is not whole, at most; that one is written over.
"""

import json
import time as clock
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from sinuous.batch.checkpoint import check_same
from sinuous.errors import InputError

EVERY = 1.0
"""Seconds of work that may be lost where a process is killed."""

SUFFIX = ".journal"

Added = Callable[[], dict[str, Any]]
"""Makes plain values of what was found, where they are to be written."""


class Journal:
    """Keeps what was found of some problems, until all is done.

    Parameters
    ----------
    beside : Path or None
        A file of the answers. Without one nothing is kept.
    asked : mapping of str to str
        All that the answers depend on.

    Raises
    ------
    InputError
        When the journal that is there is of something else, or cannot be read.
    """

    def __init__(self, beside: Path | None, asked: Mapping[str, str]) -> None:
        self._file = None if beside is None else beside.with_name(beside.name + SUFFIX)
        self._asked = dict(asked)
        self._past: dict[int, list[bytes]] = {}
        self._number, self._end = -1, 0
        self._new: list[tuple[int, Added]] = []
        self._out: BinaryIO | None = None
        self._written = clock.perf_counter()
        if self._file is not None and self._file.exists():
            self._read(self._file)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *_: object) -> None:
        """Write what is not written yet, whatever ends the command."""
        self.write()
        if self._out is not None:
            self._out.close()

    @property
    def keeps(self) -> bool:
        """Whether anything is kept."""
        return self._file is not None

    def begin(self) -> Iterator[dict[str, Any]]:
        """Begin with the next problem, and return what was found of it before, in the order in which it was."""
        self._number += 1
        return map(json.loads, self._past.get(self._number, ()))

    def unreadable(self) -> InputError:
        """Say that what was read makes no sense."""
        problem = "the journal beside it cannot be read"
        return InputError("--out", problem, str(self._file), "one of this command, or none")

    def add(self, added: Added) -> None:
        """Keep what was found of this problem; from time to time, all is written."""
        if self._file is None:
            return
        self._new.append((self._number, added))
        if clock.perf_counter() - self._written > EVERY:
            self.write()

    def write(self) -> None:
        """Write what is not written yet; when that is interrupted, it may be called again."""
        if self._file is None or not self._new:
            return
        lines = [_line({"problem": number, **added()}) for number, added in self._new]
        if self._out is None:
            self._out = self._file.open("r+b" if self._file.exists() else "w+b")
            self._out.truncate(self._end)
        if self._end == 0:
            lines.insert(0, _line(self._asked))
        data = b"".join(lines)
        self._out.seek(self._end)
        self._out.write(data)
        self._out.flush()
        self._end += len(data)
        self._new.clear()
        self._written = clock.perf_counter()

    def remove(self) -> None:
        """Take the journal away: all is done."""
        self._new.clear()
        if self._file is not None:
            self._file.unlink(missing_ok=True)

    def _read(self, file: Path) -> None:
        """Keep the lines that are whole."""
        for number, line in enumerate(file.read_bytes().splitlines(keepends=True)):
            if not line.endswith(b"\n"):
                break
            try:
                values = json.loads(line)
                if number == 0:
                    check_same(values, self._asked, file, "this command")
                else:
                    self._past.setdefault(values["problem"], []).append(line)
            except InputError:
                raise
            except (ValueError, KeyError, TypeError, AttributeError):
                raise self.unreadable() from None
            self._end += len(line)


def _line(values: Mapping[str, Any]) -> bytes:
    return json.dumps(values).encode() + b"\n"
