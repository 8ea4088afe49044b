"""One place again: `python -m benchmarks.clutter.replay FAMILY NUMBER [--picture FILE]`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.clutter.trials import Task, examine
from benchmarks.harness.command import command
from benchmarks.harness.quiet import ignore_suspicions
from benchmarks.places import FAMILIES
from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.cli.options import check_writable


def run(
    family: Annotated[str, typer.Argument(metavar="FAMILY", help="Like 'pipe 1.3'.")],
    number: Annotated[int, typer.Argument(metavar="NUMBER", help="The seed that a run says.")],
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw it, too: place.png.")] = None,
) -> None:
    """Make one place again, solve it and judge the answer; the exit code is 1 when it is not solved."""
    if family not in FAMILIES:
        raise InputError("FAMILY", "", family, "one of " + ", ".join(FAMILIES))
    checks.integer("NUMBER", number, 0, 2**31 - 1)
    if picture is not None:
        check_writable("--picture", picture)
    ignore_suspicions()
    ours = examine(Task(family, number)).ours
    verdict = "right" if ours.right else "WRONG" if ours.false else "not right"
    won = f" by {ours.start}" if ours.solved else ""
    typer.echo(f"{family}, {number}: {ours.status}{won} in {1e3 * ours.seconds:.3g} ms; the judge finds it {verdict}")
    if picture is not None:
        from benchmarks.clutter.gallery import draw  # noqa: PLC0415

        draw(picture, {family: number})
    raise typer.Exit(0 if ours.solved else 1)


main = command(run, "benchmarks.clutter.replay")


if __name__ == "__main__":
    sys.exit(main())
