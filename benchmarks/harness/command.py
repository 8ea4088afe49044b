"""Options that several commands have, and what each of these gives."""

from pathlib import Path
from typing import Annotated

import typer

from benchmarks.harness.machine import describe
from sinuous.cli.options import check_writable


def _writable(file: Path | None) -> Path | None:
    if file is not None:
        check_writable("--record", file)
    return file


Record = Annotated[Path | None, typer.Option(metavar="FILE", help="Keep the table there, too.", callback=_writable)]
Alone = Annotated[bool, typer.Option("--alone", help="In this process, instead of one for each core.")]


def give(name: str, facts: dict[str, str], text: str, record: Path | None) -> None:
    """Print a text below what was measured where: machine and versions, then these facts, a line each; and keep it."""
    own = describe()
    shown = {key: own[key] for key in ("date", "processor", "python", "sinuous", "numba")} | facts
    text = "\n".join(f"- {key}: {value}" for key, value in shown.items()) + f"\n\n{text}\n"
    typer.echo(text, nl=False)
    if record is not None:
        record.write_text(f"# {name}\n\n{text}", encoding="utf-8")
