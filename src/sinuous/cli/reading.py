"""All problem files of a command, read before anything is answered."""

import time as clock
from dataclasses import dataclass

import typer

from sinuous.cli.progress import Waiting
from sinuous.errors import InputError
from sinuous.files.problem_file import ProblemFile, read_problem


@dataclass(frozen=True)
class Read:
    """A problem file, its scene prepared, and the seconds that all of that took."""

    problem: ProblemFile
    seconds: float


def read_all(files: list[str]) -> list[Read]:
    """Read problem files with all that they name, and prepare their scenes.

    Raises
    ------
    InputError
        For the first that is wrong.
    """
    result = []
    with Waiting() as waiting:
        for file in files:
            waiting.begin(file)
            began = clock.perf_counter()
            problem = read_problem(file)
            try:
                problem.scene.prepare(waiting.told)
            except InputError as error:
                raise error.in_file(file) from None
            result.append(Read(problem, clock.perf_counter() - began))
    return result


def say_notes(problems: list[ProblemFile]) -> None:
    """Print what files hold that is not as it should be, each note once, on standard error."""
    for note in dict.fromkeys(f"{problem.file}: {note}" for problem in problems for note in problem.notes):
        typer.echo(f"note: {note}", err=True)
