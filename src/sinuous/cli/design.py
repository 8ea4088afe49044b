"""The command design: a robot for a set of tasks."""

import warnings
from pathlib import Path
from typing import Any, NamedTuple

import typer

from sinuous.cli.options import INTERRUPTED, SOLVED, UNSOLVED, Solving, as_typed, check_writable
from sinuous.cli.reading import say_notes
from sinuous.designing.find import design
from sinuous.designing.reading import read_design
from sinuous.errors import InputError, SuspiciousInput
from sinuous.files.documents import parse
from sinuous.files.results import json_line


class Wishes(NamedTuple):
    """What was typed beside the file.

    Attributes
    ----------
    minimise : str or None
        Names, with commas between them.
    vary : tuple of str
        `FIELD=LOW:HIGH` or `FIELD=VALUE,VALUE`.
    robots : int or None
    budget : float or None
        Seconds.
    workers : int or None
    """

    minimise: str | None
    vary: tuple[str, ...]
    robots: int | None
    budget: float | None
    workers: int | None


def design_file(
    file: str,
    solving: Solving,
    wishes: Wishes,
    out: Path | None,
    csv: Path | None,
    plot: Path | None,
    *,
    json: bool,
) -> int:
    """Find a robot for the tasks of a file; return the exit code."""
    for option, target in (("--out", out), ("--csv", csv), ("--plot", plot)):
        if target is not None:
            check_writable(option, target, [file])
    if plot is not None:
        from sinuous.pictures.files import check_picture  # noqa: PLC0415

        check_picture("--plot", plot)
    asked = read_design(file)
    say_notes({file: asked.setting.notes})
    vary = {**asked.vary, **dict(map(read_field, wishes.vary))}
    minimise = asked.minimise if wishes.minimise is None else wishes.minimise.split(",")
    own: dict[str, Any] = {"robots": wishes.robots, "budget": wishes.budget}
    given = {key: value for key, value in own.items() if value is not None}
    kept = None if out is None else out.with_name(out.name + ".csv")
    try:
        with warnings.catch_warnings(), as_typed("robots", "budget", "workers", *solving.demands):
            warnings.simplefilter("ignore", SuspiciousInput)
            options = solving.arguments(asked.setting.tolerance, asked.setting.prefer)
            found = design(
                asked.setting.robot,
                asked.tasks,
                asked.setting.scene,
                vary=vary,
                minimise=minimise or (),
                workers=wishes.workers,
                out=kept if csv is None else csv,
                progress=True,
                **given,
                **options,
            )
    except KeyboardInterrupt:
        text = (
            "nothing is written" if out is None and csv is None else "what was judged is kept, the same command goes on"
        )
        typer.echo(f"sinuous: interrupted; {text}", err=True)
        return INTERRUPTED
    if csv is None and kept is not None:
        kept.unlink(missing_ok=True)
    if out is not None and found.solved:
        found.robot.save(out)
    if plot is not None and found.solved:
        from sinuous.pictures.design import plot_design  # noqa: PLC0415

        plot_design(found, plot)
    typer.echo(json_line({"file": file, **found.to_dict()}) if json else f"{file}: {str(found).partition(': ')[2]}")
    return SOLVED if found.solved else UNSOLVED


def read_field(text: str) -> tuple[str, Any]:
    """Read `FIELD=LOW:HIGH` or `FIELD=VALUE,VALUE`.

    Raises
    ------
    InputError
        That names the option.
    """
    field, equals, said = text.partition("=")
    if not equals or not field or not said:
        raise InputError("--vary", "", text, "FIELD=LOW:HIGH or FIELD=VALUE,VALUE")
    low, colon, high = said.partition(":")
    try:
        if colon:
            return field, (float(low), float(high))
        return field, [parse(part, Path("--vary")) for part in said.split(",")]
    except ValueError:
        raise InputError("--vary", "", text, "FIELD=LOW:HIGH or FIELD=VALUE,VALUE") from None
