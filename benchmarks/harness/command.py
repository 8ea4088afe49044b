"""Command lines of one function each: `main = command(run, "benchmarks.rooms")`."""

from collections.abc import Callable, Sequence

import typer

from sinuous.cli.app import execute


def command(run: Callable[..., None], module: str) -> Callable[..., int]:
    """Return what runs a function as a command, with the arguments of the process or others, and returns its exit code.

    Parameters
    ----------
    run : callable
        Whose parameters are options and arguments, and whose docstring is the help.
    module : str
        Its module, as `python -m` takes it.
    """
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command()(run)

    def main(arguments: Sequence[str] | None = None) -> int:
        return execute(typer.main.get_command(app), f"python -m {module}", arguments)

    return main
