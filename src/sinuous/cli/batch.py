"""The command batch: any number of targets from a table, results into a table."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from sinuous.batch.batch import Batch
from sinuous.batch.solve import CHUNK, solve_batch
from sinuous.cli.options import Options
from sinuous.errors import InputError, UnfinishedError
from sinuous.files.results import json_line
from sinuous.files.setting import Setting, read_setting
from sinuous.problem.suspicions import SuspiciousInput

SOLVED, UNSOLVED, INTERRUPTED = 0, 1, 130

ENGINES = ("threads", "processes")


@dataclass(frozen=True)
class Run:
    """What was typed about the run.

    Attributes
    ----------
    targets, out : Path
        Tables.
    chunk : int
    engine : str
    dask : str or None
        Address of a scheduler, or `local`.
    workers : int or None
    shard : str or None
        `I/N`.
    warm : bool
    """

    targets: Path
    out: Path
    chunk: int = CHUNK
    engine: str = "threads"
    dask: str | None = None
    workers: int | None = None
    shard: str | None = None
    warm: bool = False

    def arguments(self) -> dict[str, Any]:
        """Return them as `solve_batch` takes them.

        Raises
        ------
        InputError
            That names the option.
        """
        if self.engine not in ENGINES:
            raise InputError("--engine", "", self.engine, "one of " + ", ".join(ENGINES))
        if self.dask is not None and self.engine != "threads":
            raise InputError("--dask", "stands beside --engine", self.dask, "one of --engine, --dask")
        if self.dask is not None and self.dask != "local" and "://" not in self.dask:
            raise InputError("--dask", "", self.dask, "tcp://HOST:PORT of a scheduler, or local")
        engine = self.engine if self.dask is None else "dask" if self.dask == "local" else self.dask
        own = {"chunk": self.chunk, "workers": self.workers, "warm": self.warm, "shard": self._shard()}
        return {**own, "engine": engine, "progress": True}

    def _shard(self) -> tuple[int, int] | None:
        if self.shard is None:
            return None
        first, _, count = self.shard.partition("/")
        if not (first.isdecimal() and count.isdecimal() and 1 <= int(first) <= int(count)):
            raise InputError("--shard", "", self.shard, "I/N, I from 1 to N")
        return int(first), int(count)


def batch_file(file: str, run: Run, options: Options) -> int:
    """Solve all rows of a table; return the exit code."""
    options.check([file])
    arguments = run.arguments()
    setting = read_setting(file)
    for note in setting.notes:
        typer.echo(f"note: {file}: {note}", err=True)
    try:
        found = _solve(setting, run, arguments | options.solve_options(setting.tolerance, setting.prefer))
    except UnfinishedError as error:
        typer.echo(f"sinuous: {error}", err=True)
        return UNSOLVED
    except KeyboardInterrupt:
        typer.echo("sinuous: interrupted; the chunks that were done are kept, the same command goes on", err=True)
        return INTERRUPTED
    typer.echo(json_line(found.to_dict()) if options.json else f"{file}: {str(found).split(': ', 1)[1]}")
    shard_done = run.shard is not None and not found.failed
    return SOLVED if found.solved or shard_done else UNSOLVED


def _solve(setting: Setting, run: Run, arguments: dict[str, Any]) -> Batch:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousInput)  # the notes say it
        try:
            whole = {"initial": setting.start, **arguments}
            return solve_batch(setting.robot, run.targets, setting.scene, run.out, **whole)
        except InputError as error:
            typed = {"chunk": "--chunk", "workers": "--workers", "targets": "--targets", "out": "--out"}
            if error.key not in typed or error.file is not None:
                raise
            raise InputError(typed[error.key], error.problem, error.value, error.expected) from None
