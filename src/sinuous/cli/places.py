"""The commands about a robot among its obstacles, whatever the targets of its file: batch, explore, reach, train."""

from pathlib import Path
from time import perf_counter
from typing import Any

import typer

from sinuous.batch.solve import solve_batch
from sinuous.cli.options import SOLVED, UNSOLVED, BatchSolving, Solving, as_typed, check_outputs
from sinuous.cli.reading import interruptible, remembered, say, setting_of
from sinuous.errors import InputError
from sinuous.exploring.explore import explore
from sinuous.methods.learned.training import train
from sinuous.solving.memory import Memory
from sinuous.workspace.find import reach


def batch_file(file: str, targets: Path, out: Path, solving: BatchSolving, run: dict[str, Any], *, json: bool) -> int:
    """Solve all rows of a table; return the exit code. `run` are arguments of `solve_batch` about the run."""
    solving.arguments()
    with (
        interruptible("the chunks that were done are kept, the same command goes on"),
        setting_of(file) as setting,
        as_typed("targets", "out", "memory", *run, *solving.demands),
    ):
        given = {**solving.arguments(setting.tolerance, setting.prefer), "initial": setting.start}
        if solving.memory is not None:
            given["memory"] = Memory.load(solving.memory)
        found = solve_batch(setting.robot, targets, setting.scene, out, **given, **run, progress=True)
    say(file, found, json=json)
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


def explore_file(file: str, solving: Solving, memory: Path, run: dict[str, Any], *, json: bool) -> int:
    """Explore the place of a file; return the exit code. `run` are arguments of `explore` about the run."""
    solving.arguments()
    with (
        interruptible(f"rounds that were done are in {memory}, the same command goes on"),
        setting_of(file) as setting,
        remembered(memory, {file: setting.robot}) as kept,
        as_typed("time", *run, *solving.demands),
    ):
        given = {**solving.arguments(setting.tolerance, setting.prefer), "memory": kept, "starts": setting.start}
        found = explore(setting.robot, setting.scene, **given, **run, progress=True)
    say(file, found, json=json)
    return SOLVED


def reach_file(
    file: str, solving: Solving, grid: dict[str, Any], out: Path | None, plot: Path | None, *, json: bool
) -> int:
    """Map what the robot of a file reaches; return the exit code. `grid` are arguments of `reach` about the grid."""
    check_outputs([file], out=out, plot=plot)
    if out is not None and out.suffix.lower() != ".npz":
        raise InputError("--out", "", str(out), "a name that ends in .npz")
    if plot is not None:
        from sinuous.pictures.workspace import check_map  # noqa: PLC0415

        check_map("--plot", plot)
    kept = "nothing is written" if out is None else "what was found is kept, the same command goes on"
    with interruptible(kept), setting_of(file) as setting, as_typed("out", *grid, *solving.demands):
        given = solving.arguments(setting.tolerance, setting.prefer)
        found = reach(setting.robot, setting.scene, **grid, out=out, progress=True, **given)
    if plot is not None:
        from sinuous.pictures.workspace import plot_reach  # noqa: PLC0415

        plot_reach(found, plot)
    say(file, found, json=json)
    return SOLVED


def train_file(file: str, out: Path, **own: int) -> int:
    """Train networks for the robot of a file among its obstacles, and write them; return the exit code."""
    check_outputs([file], out=out)
    with setting_of(file) as setting, as_typed(*own):
        began = perf_counter()
        found = train(setting.robot, setting.scene, **own, progress=True)
    found.save(out)
    typer.echo(f"{out}: {found}, {perf_counter() - began:.1f} s; next: --method learned --option network={out}")
    return SOLVED
