"""The command reach: a map of the workspace."""

import warnings
from dataclasses import dataclass
from typing import Any

import typer

from sinuous.cli.options import Options, check_writable
from sinuous.errors import InputError
from sinuous.files.results import json_line
from sinuous.files.setting import read_setting
from sinuous.problem.suspicions import SuspiciousInput
from sinuous.workspace.find import reach

DONE, INTERRUPTED = 0, 130

TYPED = ("spacing", "directions", "workers")


@dataclass(frozen=True)
class Map:
    """What was typed about the map.

    Attributes
    ----------
    spacing : float or None
    directions : int
    workers : int or None
    """

    spacing: float | None
    directions: int
    workers: int | None


def reach_file(file: str, asked: Map, options: Options) -> int:
    """Map what the robot of a file reaches; return the exit code."""
    for option, target in (("--out", options.out), ("--plot", options.plot)):
        if target is not None:
            check_writable(option, target, [file])
    if options.out is not None and options.out.suffix.lower() != ".npz":
        raise InputError("--out", "", str(options.out), "a name that ends in .npz")
    if options.plot is not None:
        from sinuous.pictures.workspace import check_map  # noqa: PLC0415

        check_map("--plot", options.plot)
    setting = read_setting(file)
    for note in setting.notes:
        typer.echo(f"note: {file}: {note}", err=True)
    chosen = options.solve_options(setting.tolerance, setting.prefer)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # the notes say it
            found = reach(setting.robot, setting.scene, **_arguments(asked), **chosen)
    except InputError as error:
        if error.key not in TYPED:
            raise
        raise InputError(f"--{error.key}", error.problem, error.value, error.expected) from None
    except KeyboardInterrupt:
        typer.echo("sinuous: interrupted; nothing is written", err=True)
        return INTERRUPTED
    if options.out is not None:
        found.save(options.out)
    if options.plot is not None:
        from sinuous.pictures.workspace import plot_reach  # noqa: PLC0415

        plot_reach(found, options.plot)
    typer.echo(json_line({"file": file, **found.to_dict()}) if options.json else f"{file}: {str(found)[7:]}")
    return DONE


def _arguments(asked: Map) -> dict[str, Any]:
    return {**vars(asked), "progress": True}
