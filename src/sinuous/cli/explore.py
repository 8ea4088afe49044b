"""The command explore: a memory is filled ahead."""

from pathlib import Path
from typing import Any

import typer

from sinuous.cli.options import INTERRUPTED, SOLVED, UNSOLVED, Solving, as_typed
from sinuous.cli.reading import setting_of
from sinuous.cli.remembering import remembered
from sinuous.errors import UnfinishedError
from sinuous.exploring.explore import explore
from sinuous.files.results import json_line


def explore_file(file: str, solving: Solving, memory: Path, run: dict[str, Any], *, json: bool) -> int:
    """Explore the place of a file; return the exit code. `run` are arguments of `explore` about the run."""
    solving.arguments()
    try:
        with (
            setting_of(file) as setting,
            remembered(memory, {file: setting.robot}) as kept,
            as_typed("time", *run, *solving.demands),
        ):
            given = solving.arguments(setting.tolerance, setting.prefer)
            own = {"memory": kept, "starts": setting.start, "time": given.pop("time"), "progress": True}
            found = explore(setting.robot, setting.scene, **{**given, **own}, **run)
    except UnfinishedError as error:
        typer.echo(f"sinuous: {error}", err=True)
        return UNSOLVED
    except KeyboardInterrupt:
        typer.echo(f"sinuous: interrupted; rounds that were done are in {memory}, the same command goes on", err=True)
        return INTERRUPTED
    typer.echo(json_line({"file": file, **found.to_dict()}) if json else f"{file}: {found}")
    return SOLVED
