"""The command reach: a map of the workspace."""

from pathlib import Path
from typing import Any

import typer

from sinuous.cli.options import INTERRUPTED, SOLVED, Solving, as_typed, check_writable
from sinuous.cli.reading import setting_of
from sinuous.errors import InputError
from sinuous.files.results import json_line
from sinuous.workspace.find import reach


def reach_file(
    file: str, solving: Solving, grid: dict[str, Any], out: Path | None, plot: Path | None, *, json: bool
) -> int:
    """Map what the robot of a file reaches; return the exit code. `grid` are arguments of `reach` about the grid."""
    for option, target in (("--out", out), ("--plot", plot)):
        if target is not None:
            check_writable(option, target, [file])
    if out is not None and out.suffix.lower() != ".npz":
        raise InputError("--out", "", str(out), "a name that ends in .npz")
    if plot is not None:
        from sinuous.pictures.workspace import check_map  # noqa: PLC0415

        check_map("--plot", plot)
    try:
        with setting_of(file) as setting, as_typed("out", *grid, *solving.demands):
            given = solving.arguments(setting.tolerance, setting.prefer)
            found = reach(setting.robot, setting.scene, **grid, out=out, progress=True, **given)
    except KeyboardInterrupt:
        kept = "nothing is written" if out is None else "what was found is kept, the same command goes on"
        typer.echo(f"sinuous: interrupted; {kept}", err=True)
        return INTERRUPTED
    if plot is not None:
        from sinuous.pictures.workspace import plot_reach  # noqa: PLC0415

        plot_reach(found, plot)
    typer.echo(json_line({"file": file, **found.to_dict()}) if json else f"{file}: {str(found).split(': ', 1)[1]}")
    return SOLVED
