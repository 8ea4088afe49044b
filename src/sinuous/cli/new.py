"""The command new: a commented problem file to start from."""

import shlex
from importlib.resources import files

import typer

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.cli.app import KINDS, New
from sinuous.cli.options import SOLVED, check_writable


def write_new(asked: New) -> int:
    """Write the problem file of a kind, and say what to do with it.

    Raises
    ------
    InputError
        When there is no such kind, or the file cannot be written, or is there already and `force` is not said.
    """
    kind, file = checks.choice("KIND", asked.kind, tuple(KINDS)), asked.file
    if file.suffix.lower() == ".json":
        raise InputError("FILE", "has comments, which JSON has not", str(file), "a name that ends in .yaml")
    if file.exists() and not (asked.force and file.is_file()):
        raise InputError("FILE", "is there already", str(file), "a new file, or --force")
    check_writable("FILE", file)
    text = (files("sinuous.cli") / "templates" / f"{kind}.yaml").read_text(encoding="utf-8")
    typed = shlex.quote(" ".join(str(file).split()))
    file.write_text(text.replace("FILE", typed), encoding="utf-8", newline="\n")
    command = "track" if "\npath:" in text else "solve"
    typer.echo(f"{file}: {KINDS[kind]}; next: sinuous {command} {typed}")
    return SOLVED
