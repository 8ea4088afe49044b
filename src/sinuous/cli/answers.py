"""What the commands solve, track and plan answer, and where that goes: standard output, a file, a table, a picture."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import typer

from sinuous.answer.explanation import Explanation
from sinuous.answer.route_class import RouteClass
from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.documents import written
from sinuous.base.errors import SuspiciousInput
from sinuous.base.words import counted
from sinuous.cli.options import MotionOutput, Output, is_page, numbered
from sinuous.cli.reading import say_notes
from sinuous.files.results import json_line, result
from sinuous.motion.knots import read_outcome, write_outcome
from sinuous.motion.motion import Motion
from sinuous.motion.tables import write_csv
from sinuous.problem.target import Targets
from sinuous.solver.solver import Solver

MOST_DRAWN = 8
"""Of several solutions, how many a picture has: the best ones."""


@dataclass(frozen=True)
class Alternatives:
    """What `solve --all` found.

    Attributes
    ----------
    solutions : tuple of Solution
        Distinct, all solved, best first; perhaps none.
    best : Solution
        The first of them; where there is none, what a plain solve says of the target.
    seconds : float
        Of the whole search.
    """

    solutions: tuple[Solution, ...]
    best: Solution
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether there is a solution."""
        return self.best.solved

    def to_dict(self) -> dict[str, Any]:
        """Return what they have in common, and each, as plain values in the order of the file format."""
        best = self.best.to_dict()
        common = {key: best[key] for key in ("status", "base", "worst", "reason")}
        asked = {key: best[key] for key in ("method", "seed")}
        each = [solution.to_dict() for solution in self.solutions]
        return {**common, "seconds": self.seconds, **asked, "solutions": each}

    def __str__(self) -> str:
        if not self.solutions:
            return str(self.best)
        count = f"{counted(len(self.solutions), 'distinct solution')}, best first"
        classes = {each.route_class.number: each.route_class for each in self.solutions if each.route_class is not None}
        rows = [["", *(["class"] if classes else []), "bend", "length", "clearance", "position", "angle", "start"]]
        rows += [[str(i), *_class(each, classes), *_cells(each)] for i, each in enumerate(self.solutions, 1)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
        words = [f"  {route_class}" for _, route_class in sorted(classes.items())]
        return "\n".join([f"Alternatives: {self.best.status} ({count})", *lines, *words])


def _class(solution: Solution, classes: dict[int, RouteClass]) -> list[str]:
    """Number of the class of a solution, where there are classes."""
    own = solution.route_class
    return [] if not classes else ["-" if own is None else str(own.number)]


def _cells(solution: Solution) -> list[str]:
    """All bends (rad) and lengths together, proved clearance, errors, and the kind of start."""
    numbers = (
        float(np.hypot(solution.q[:, 0], solution.q[:, 1]).sum()),
        float(solution.q[:, 2].sum()),
        solution.clearance,
        solution.position_error,
        solution.angle_error,
    )
    return [*("-" if number is None else f"{number:.3g}" for number in numbers), solution.start]


Answer = Solution | Motion | Alternatives


class AnswerWriter:
    """Writes each answer as soon as it is there, so that an interrupt loses none.

    Parameters
    ----------
    output : Output
        Where answers go.
    files : int
        How many problem files there are.
    """

    def __init__(self, output: Output, files: int) -> None:
        self._output, self._files = output, files
        self._done = 0
        self._out: TextIO | None = None
        if output.out is not None:
            with written(output.out, "--out"):
                self._out = output.out.open("w", encoding="utf-8", newline="\n")

    def __enter__(self) -> "AnswerWriter":
        return self

    def __exit__(self, *_: object) -> None:
        if self._out is not None:
            self._out.close()

    def write(self, file: str, answer: Answer, prepare_seconds: float, why: bool) -> None:
        """Write the answer to a problem file, and with `why` what explains it; an interrupt leaves the answer."""
        try:
            explanation = answer.explain() if why and isinstance(answer, Solution) else None
        except KeyboardInterrupt:
            self._write(file, answer, prepare_seconds, None)
            raise
        self._write(file, answer, prepare_seconds, explanation)

    def _write(self, file: str, answer: Answer, prepare_seconds: float, why: Explanation | None) -> None:
        self._done += 1
        if self._output.json or self._out is not None:  # of a long path, a line is more work than solving it
            remedies = {} if why is None else {"remedies": why.to_dict()["remedies"]}
            line = json_line(result(file, answer.to_dict() | remedies, prepare_seconds))
            if self._out is not None:
                self._out.write(line + "\n")
                self._out.flush()
        text = f"{file}: {str(answer).split(': ', 1)[1]}" if why is None else f"{file}: {why}"
        typer.echo(line if self._output.json else text)
        table = numbered(self._output.csv, self._done, self._files)
        if table is not None:
            self._write_table(table, answer)
        picture = numbered(self._output.plot, self._done, self._files)
        if picture is not None:
            _draw(picture, answer)

    def _write_table(self, file: Path, answer: Answer) -> None:
        if isinstance(answer, Alternatives):
            write_csv(file, answer.solutions or (answer.best,))
        elif isinstance(answer, Motion):
            _write_rows(file, answer, self._output.rate if isinstance(self._output, MotionOutput) else None)
        else:
            write_csv(file, (answer,))


def _write_rows(file: Path, motion: Motion, rate: float | None) -> None:
    """Write a motion as a table; that lines between its rows are not proved is a note, on standard error."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", SuspiciousInput)
        motion.to_csv(file, rate)
    say_notes({str(file): tuple(str(each.message) for each in said)})


def _draw(file: Path, answer: Answer) -> None:
    if is_page(file):
        from sinuous.view.page.show import show  # noqa: PLC0415

        show(*(answer.solutions or [answer.best] if isinstance(answer, Alternatives) else [answer]), path=file)
    else:
        from sinuous.view.pictures.reports import write_picture  # noqa: PLC0415

        drawn = (answer.solutions[:MOST_DRAWN] or answer.best) if isinstance(answer, Alternatives) else answer
        write_picture(file, drawn)


def write_solution(solution: Solution) -> dict[str, Any]:
    """Return what a journal keeps of a solution: plain values, numbers to the last digit."""
    own = solution.route_class
    outcome, route_class = write_outcome(solution._outcome), None if own is None else own.to_dict()
    return {"outcome": outcome, "seconds": solution.seconds, "route_class": route_class}


def read_solution(solver: Solver, targets: Targets, start: Floats | None, values: dict[str, Any]) -> Solution:
    """Return the solution that `write_solution` wrote, as `solver` found it from `start`.

    Raises
    ------
    KeyError, TypeError, ValueError
        When `values` are something else.
    """
    outcome = read_outcome(values["outcome"], len(solver.robot))
    own = values["route_class"]
    route_class = None if own is None else RouteClass.from_dict(own)
    return solver._restore_solution(targets, outcome, values["seconds"], start, route_class)
