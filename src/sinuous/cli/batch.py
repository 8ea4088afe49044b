"""The command batch: any number of targets from a table, results into a table."""

from pathlib import Path
from typing import Any

import typer

from sinuous.batch.solve import solve_batch
from sinuous.cli.options import INTERRUPTED, SOLVED, UNSOLVED, BatchSolving, as_typed
from sinuous.cli.reading import setting_of
from sinuous.errors import InputError, UnfinishedError
from sinuous.files.results import json_line
from sinuous.solving.memory import Memory


def batch_file(file: str, targets: Path, out: Path, solving: BatchSolving, run: dict[str, Any], *, json: bool) -> int:
    """Solve all rows of a table; return the exit code. `run` are arguments of `solve_batch` about the run."""
    solving.arguments()
    try:
        with setting_of(file) as setting, as_typed("targets", "out", "memory", *run, *solving.demands):
            given = {**solving.arguments(setting.tolerance, setting.prefer), "initial": setting.start}
            if solving.memory is not None:
                with as_typed("memory"):
                    given["memory"] = Memory.load(solving.memory)
            found = solve_batch(setting.robot, targets, setting.scene, out, **given, **run, progress=True)
    except UnfinishedError as error:
        typer.echo(f"sinuous: {error}", err=True)
        return UNSOLVED
    except KeyboardInterrupt:
        typer.echo("sinuous: interrupted; the chunks that were done are kept, the same command goes on", err=True)
        return INTERRUPTED
    typer.echo(json_line(found.to_dict()) if json else f"{file}: {str(found).split(': ', 1)[1]}")
    shard_done = run["shard"] is not None and not found.failed
    return SOLVED if found.solved or shard_done else UNSOLVED


def read_shard(shard: str | None) -> tuple[int, int] | None:
    """Return the shard that `I/N` names."""
    if shard is None:
        return None
    first, _, count = shard.partition("/")
    if not (first.isdecimal() and count.isdecimal() and 1 <= int(first) <= int(count)):
        raise InputError("--shard", "", shard, "I/N, I from 1 to N")
    return int(first), int(count)
