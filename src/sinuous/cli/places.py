"""The commands about a robot among its obstacles, whatever the targets of its file: batch, explore, reach, train."""

from pathlib import Path
from time import perf_counter

import typer

from sinuous.base.documents import described
from sinuous.base.errors import InputError
from sinuous.cli.app import Batch, Explore, Reach, Train
from sinuous.cli.options import SOLVED, UNSOLVED, as_typed, check_outputs, names_in
from sinuous.cli.reading import interruptible, remembered, say, say_notes, setting_of
from sinuous.methods.learned import train
from sinuous.solver.memory import Memory
from sinuous.studies.batch.solve import solve_batch
from sinuous.studies.exploring.explore import explore
from sinuous.studies.runs.engine import Checkpoint
from sinuous.studies.workspace.find import reach

WORKSPACE = ("spacing", "directions", "within")
"""What may be typed instead of what a file says of its workspace."""


def batch_file(asked: Batch) -> int:
    """Solve all rows of a table; return the exit code."""
    solving = asked.solving
    solving.arguments()
    if asked.warm:
        say_notes({"--warm": ("does nothing any more; use --memory",)})
    chosen = {"columns": names_in(asked.columns), "shard": read_shard(asked.shard)}
    run = {"chunk": asked.chunk, **chosen, **asked.crew.arguments()}
    with (
        interruptible(lambda: _kept_rows(asked.out, asked.chunk)),
        setting_of(asked.file) as setting,
        as_typed("targets", "out", *vars(solving), *run, *solving.demands),
    ):
        given = {**solving.arguments(setting.tolerance, setting.prefer), "initial": setting.start}
        if solving.memory is not None:
            given["memory"] = Memory.load(solving.memory)
        found = solve_batch(setting.robot, asked.targets, setting.scene, asked.out, **given, **run, progress=True)
    say(asked.file, found, json=asked.json)
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


def explore_file(asked: Explore) -> int:
    """Explore the place of a file; return the exit code."""
    solving, run = asked.solving, {"rounds": asked.rounds, "spacing": asked.spacing, **asked.crew.arguments()}
    solving.arguments()
    with (
        interruptible(lambda: _kept_shapes(asked.memory)),
        setting_of(asked.file) as setting,
        remembered(asked.memory, {asked.file: setting.robot}) as kept,
        as_typed("time", *run, *solving.demands),
    ):
        given = {**solving.arguments(setting.tolerance, setting.prefer), "memory": kept, "starts": setting.start}
        found = explore(setting.robot, setting.scene, **given, **run, progress=True)
    say(asked.file, found, json=asked.json)
    return SOLVED


def reach_file(asked: Reach) -> int:
    """Map what the robot of a file reaches; return the exit code."""
    solving, out = asked.solving, asked.out
    check_outputs([asked.file], out=out, plot=asked.plot)
    if out is not None and out.suffix.lower() != ".npz":
        raise InputError("--out", "", str(out), "a name that ends in .npz")
    if asked.plot is not None:
        from sinuous.view.pictures.figures import check_picture  # noqa: PLC0415

        check_picture("--plot", asked.plot, others=("html",))
    typed = {key: value for key in WORKSPACE if (value := getattr(asked, key)) is not None}
    if asked.toward is not None:
        typed["directions"] = read_direction(asked)
    with (
        interruptible(lambda: _kept(out)),
        setting_of(asked.file) as setting,
        as_typed("out", "workers", *typed, *solving.demands),
    ):
        grid = described(setting.workspace) | typed
        given = solving.arguments(setting.tolerance, setting.prefer)
        found = reach(setting.robot, setting.scene, **grid, workers=asked.workers, out=out, **given)
    if asked.plot is not None:
        from sinuous.view.pictures.workspace import plot_reach  # noqa: PLC0415

        plot_reach(found, asked.plot, robot=setting.robot, scene=setting.scene)
    say(asked.file, found, json=asked.json)
    return SOLVED


def _kept_rows(out: Path, chunk: int) -> str:
    """What is kept of a batch that is interrupted."""
    count = len(Checkpoint(out, {}, "this batch").done())
    return f"{count} chunks of up to {chunk:,} rows are kept, the same command goes on"


def _kept_shapes(file: Path) -> str:
    """What is kept of an exploration that is interrupted."""
    if not file.exists():
        return "nothing is written"
    memory = Memory.load(file)
    return f"{len(memory):,} shapes and {len(memory.edges):,} motions are in {file}, the same command goes on"


def _kept(out: Path | None) -> str:
    """What is kept of a map that is interrupted."""
    if out is None:
        return "nothing is written"
    done = Checkpoint(out, {}, "this map")
    count = sum(len(done.read(number, "codes")["codes"]) for number in done.done())
    return f"what was found is kept ({count:,} solves), the same command goes on"


def read_direction(asked: Reach) -> list[float]:
    """Return the direction that is typed."""
    if asked.directions is not None:
        raise InputError("--toward", "cannot be combined with --directions", asked.toward, "one of both")
    try:
        numbers = [float(part) for part in str(asked.toward).split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or not any(numbers):
        raise InputError("--toward", "", asked.toward, "a direction: X,Y,Z")
    return numbers


def train_file(asked: Train) -> int:
    """Train networks for the robot of a file among its obstacles, and write them; return the exit code."""
    check_outputs([asked.file], out=asked.out)
    own = {key: getattr(asked, key) for key in ("samples", "width", "rounds", "seed")}
    with setting_of(asked.file) as setting, as_typed(*own):
        began = perf_counter()
        found = train(setting.robot, setting.scene, **own, progress=True)
    found.save(asked.out)
    out = asked.out
    typer.echo(f"{out}: {found}, {perf_counter() - began:.1f} s; next: --method learned --option network={out}")
    return SOLVED
