"""Where results go: to standard output, into a file, into a picture."""

from pathlib import Path
from typing import Any, TextIO

import typer

from sinuous.cli.answers.alternatives import Alternatives
from sinuous.cli.options import Options, is_page, numbered
from sinuous.errors import InputError
from sinuous.files.results import json_line, result
from sinuous.motion.motion import Motion
from sinuous.motion.tables import write_csv
from sinuous.solution.explanation import Explanation
from sinuous.solution.solution import Solution

Answer = Solution | Motion | Alternatives


MOST_DRAWN = 8
"""Of several solutions, how many a picture has: the best ones."""


class Output:
    """Writes each answer as soon as it is there, so that an interrupt loses none."""

    def __init__(self, options: Options, files: int) -> None:
        self._options = options
        self._files = files
        self._done = 0
        self._out: TextIO | None = None if options.out is None else _open(options.out)

    @property
    def explains(self) -> bool:
        """Whether answers are to be explained."""
        return self._options.why

    def __enter__(self) -> "Output":
        return self

    def __exit__(self, *_: object) -> None:
        if self._out is not None:
            self._out.close()

    def write(self, file: str, answer: Answer, prepare_seconds: float, why: Explanation | None = None) -> None:
        """Write the answer to one problem file, and why it is so."""
        self._done += 1
        if self._options.json or self._out is not None:  # of a long path, a line is more work than solving it
            line = json_line(result(file, answer.to_dict() | _remedies(why), prepare_seconds))
            if self._out is not None:
                self._out.write(line + "\n")
                self._out.flush()
        text = f"{file}: {str(answer).split(': ', 1)[1]}" if why is None else f"{file}: {why}"
        typer.echo(line if self._options.json else text)
        table = numbered(self._options.csv, self._done, self._files)
        if table is not None:
            _write_table(table, answer, self._options.rate)
        picture = numbered(self._options.plot, self._done, self._files)
        if picture is not None and is_page(picture):
            from sinuous.viewer.show import show  # noqa: PLC0415

            show(*(answer.solutions or [answer.best] if isinstance(answer, Alternatives) else [answer]), path=picture)
        elif picture is not None:
            from sinuous.pictures.report import write_picture  # noqa: PLC0415

            drawn = (answer.solutions[:MOST_DRAWN] or answer.best) if isinstance(answer, Alternatives) else answer
            write_picture(picture, drawn)


def _write_table(file: Path, answer: Answer, rate: float | None) -> None:
    if isinstance(answer, Alternatives):
        write_csv(file, answer.solutions or (answer.best,))
    elif isinstance(answer, Motion):
        answer.to_csv(file, rate)
    else:
        write_csv(file, (answer,))


def _remedies(why: Explanation | None) -> dict[str, Any]:
    return {} if why is None else {"remedies": why.to_dict()["remedies"]}


def _open(out: Path) -> TextIO:
    try:
        return out.open("w", encoding="utf-8", newline="\n")
    except OSError as error:
        raise InputError(
            "--out", f"cannot be written: {error.strerror}", str(out), "a file that can be written"
        ) from None
