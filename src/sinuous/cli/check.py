"""The command check: what problem files contain, and whether their starts are answers."""

from dataclasses import asdict
from typing import Any

import typer

from sinuous.cli.reading import read_all
from sinuous.files.problem_file import ProblemFile
from sinuous.files.results import json_line
from sinuous.solution.verification import Verification, verify


def check_files(files: list[str], *, json: bool) -> int:
    """Read all files, then say of each what it contains; return 1 when a start does not meet its target, else 0."""
    good = True
    for problem in [read.problem for read in read_all(files)]:
        start = None if problem.start is None else verify(problem.problem(), problem.start)
        good = good and (start is None or start.ok)
        typer.echo(json_line(_contents(problem, start)) if json else _description(problem, start))
    return 0 if good else 1


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
        f"outside its limits by {start.excess:.3g}, clearance {start.clearance:.3g}, from itself "
        f"{start.self_clearance:.3g}{_where(start)} (sampled)"
    )


def _where(start: Verification) -> str:
    """Where a body runs through itself."""
    if start.self_segments is None or start.self_clearance >= 0.0:
        return ""
    return f" between segments {start.self_segments[0]} and {start.self_segments[1]}"
