"""The command check: what problem files contain, and whether their starts are answers."""

from dataclasses import asdict
from typing import Any

import typer

from sinuous.cli.reading import read_all
from sinuous.errors import InputError
from sinuous.files.problem_file import ProblemFile
from sinuous.files.results import json_line
from sinuous.solution.verification import Verification, verify

GOOD, NO_ANSWER, BAD_INPUT = 0, 1, 2


def check_files(files: list[str], *, json: bool) -> int:
    """Say of each file what it contains, or what is wrong with it.

    Returns
    -------
    int
        2 when a file is wrong, else 1 when a start does not meet its target, else 0.
    """
    code = GOOD
    for file in files:
        try:
            (read,) = read_all([file])
        except InputError as error:  # the others may be good; what one needs may merely be missing here
            typer.echo(" ".join(str(error).split()), err=True)
            code = BAD_INPUT
            continue
        problem = read.problem
        start = None if problem.start is None else verify(problem.problem(), problem.start)
        if start is not None and not start.ok:
            code = max(code, NO_ANSWER)
        typer.echo(json_line(_contents(problem, start)) if json else _description(problem, start))
    return code


def _contents(problem: ProblemFile, start: Verification | None) -> dict[str, Any]:
    lengths = [segment.length for segment in problem.robot.segments]
    return {
        "file": problem.file,
        "segments": len(lengths),
        "length": [sum(low for low, _ in lengths), sum(high for _, high in lengths)],
        "obstacles": len(problem.scene),
        "waypoints": len(problem.waypoints),
        "notes": problem.notes,
        "start": None if start is None else asdict(start),
    }


def _description(problem: ProblemFile, start: Verification | None) -> str:
    contents = _contents(problem, start)
    low, high = contents["length"]
    counted = [_counted(contents[f"{noun}s"], noun) for noun in ("segment", "obstacle", "waypoint")]
    line = f"{problem.file}: {counted[0]}, length {low:g} to {high:g}; {counted[1]}; {counted[2]}"
    notes = [f"note: {note}" for note in problem.notes]
    return "\n  ".join([line, *notes, *([] if start is None else [f"start {_verdict(start)}"])])


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _verdict(start: Verification) -> str:
    verdict = "meets its target" if start.ok else "is no answer"
    return (
        f"{verdict}: position error {start.position_error:.3g}, angle error {start.angle_error:.3g}, "
        f"outside its limits by {start.excess:.3g}, clearance {start.clearance:.3g} (sampled)"
    )
