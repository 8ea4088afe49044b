"""The command `sinuous`: what may be typed, and what the shell is told.

Nothing heavy is imported before a command runs, so that `sinuous --help` answers at once.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from sinuous import __version__
from sinuous.cli.options import (
    BAD_INPUT,
    UNSOLVED,
    BatchSolving,
    Clearance,
    Crew,
    DesignSolving,
    ExploreSolving,
    Files,
    Json,
    MapSolving,
    MotionOutput,
    Output,
    Place,
    PlanSolving,
    Remembering,
    SelfClearance,
    Timed,
    Workers,
    methods_like,
    read_demands,
    with_groups,
)
from sinuous.errors import InputError, UnfinishedError

_UsageError: Any = typer.BadParameter.__bases__[0]  # typer brings its own copy of click, under a private name

app = typer.Typer(
    help="Inverse kinematics and motion of continuum robots among obstacles.",
    epilog="Exit codes: 0 everything solved, 1 something not, 2 bad input, 130 interrupted.",
    rich_markup_mode=None,
)


@app.command()
@with_groups
def solve(
    files: Files,
    solving: Remembering,
    output: Output,
    why: Annotated[
        bool, typer.Option("--why", help="Say why it ended so, and what would help; all of that is tried.")
    ] = False,
    all_: Annotated[
        int | None, typer.Option("--all", metavar="COUNT", help="Find up to so many distinct solutions, best first.")
    ] = None,
    by: Annotated[
        str | None,
        typer.Option(
            help="Of --all: route (one solution a class; the default among obstacles) or shape (all distinct ones)."
        ),
    ] = None,
) -> int:
    """Meet a target, or several at once."""
    from sinuous.cli.work import solve_files  # noqa: PLC0415

    return solve_files(files, solving, output, why, all_, by)


@app.command()
@with_groups
def track(
    files: Files,
    solving: Remembering,
    output: MotionOutput,
    timed: Timed,
    deviation: Annotated[
        float | None,
        typer.Option(metavar="LENGTH", help="How far the tip may be from the straight line between waypoints."),
    ] = None,
) -> int:
    """Follow a path, each target from the last."""
    from sinuous.cli.work import track_files  # noqa: PLC0415

    return track_files(files, solving, output, timed, deviation)


@app.command()
@with_groups
def plan(
    files: Files,
    solving: PlanSolving,
    output: MotionOutput,
    timed: Timed,
    shortcuts: Annotated[
        int,
        typer.Option(metavar="COUNT", help="How many random places of the motion are tried to be joined directly."),
    ] = 0,
    begin: Annotated[float, typer.Option(metavar="TIME", help="When the motion begins, where obstacles move.")] = 0.0,
) -> int:
    """Plan a motion from a start to a target or goal, clear all the way."""
    from sinuous.cli.work import plan_files  # noqa: PLC0415

    return plan_files(files, solving, output, timed, shortcuts=shortcuts, begin=begin)


@app.command()
@with_groups
def batch(
    file: Place,
    targets: Annotated[
        Path, typer.Option(metavar="TABLE", help="Targets, a row each: .csv, .npz or .parquet.", show_default=False)
    ],
    out: Annotated[Path, typer.Option(metavar="TABLE", help="Results, of the same kinds.", show_default=False)],
    solving: BatchSolving,
    crew: Crew,
    chunk: Annotated[int, typer.Option(metavar="ROWS", help="What is solved, and written, together.")] = 10_000,
    shard: Annotated[
        str | None,
        typer.Option(metavar="I/N", help="Only this part of the chunks; without it, all parts are joined."),
    ] = None,
    warm: Annotated[bool, typer.Option("--warm", help="Begin from solutions of near targets.")] = False,
    json: Json = False,
) -> int:
    """Solve the targets of a table, any number; interrupted, the same command goes on."""
    from sinuous.cli.places import batch_file, read_shard  # noqa: PLC0415

    run = {"chunk": chunk, "warm": warm, "shard": read_shard(shard), **crew.arguments()}
    return batch_file(file, targets, out, solving, run, json=json)


@app.command()
@with_groups
def explore(
    file: Place,
    solving: ExploreSolving,
    crew: Crew,
    memory: Annotated[
        Path, typer.Option(metavar="FILE", help="What is filled; when it is there, it goes on.", show_default=False)
    ],
    rounds: Annotated[
        int | None, typer.Option(metavar="COUNT", help="Most rounds; by default as many as the time allows.")
    ] = None,
    spacing: Annotated[
        float | None,
        typer.Option(metavar="LENGTH", help="How near covers a position; by default a 20th of the reach."),
    ] = None,
    json: Json = False,
) -> int:
    """Fill a memory ahead with shapes and proved motions of a place that stays."""
    from sinuous.cli.places import explore_file  # noqa: PLC0415

    return explore_file(file, solving, memory, {"rounds": rounds, "spacing": spacing, **crew.arguments()}, json=json)


@app.command()
@with_groups
def reach(
    file: Place,
    solving: MapSolving,
    spacing: Annotated[
        float | None, typer.Option(help="Edge of a voxel; by default a 35th of the reach.", show_default=False)
    ] = None,
    directions: Annotated[int, typer.Option(metavar="COUNT", help="Of the tangent, in each voxel.")] = 26,
    workers: Workers = None,
    json: Json = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the map; .html is a page.")] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the map as NPZ.")] = None,
) -> int:
    """Map what the robot reaches, with its obstacles and without, and why not more."""
    from sinuous.cli.places import reach_file  # noqa: PLC0415

    grid = {"spacing": spacing, "directions": directions, "workers": workers}
    return reach_file(file, solving, grid, out, plot, json=json)


@app.command()
def train(
    file: Place,
    out: Annotated[Path, typer.Option(metavar="NPZ", help="Write the networks.", show_default=False)],
    samples: Annotated[int, typer.Option(metavar="COUNT", help="Targets of each kind to learn from.")] = 5_000,
    width: Annotated[int, typer.Option(metavar="COUNT", help="Units of each of the two hidden layers.")] = 64,
    rounds: Annotated[int, typer.Option(metavar="COUNT", help="How often all targets are gone through.")] = 40,
    seed: Annotated[int, typer.Option(help="Of the targets; the same seed gives the same networks.")] = 0,
) -> int:
    """Train networks that give the robot shapes for targets, for the method learned."""
    from sinuous.cli.places import train_file  # noqa: PLC0415

    return train_file(file, out, samples=samples, width=width, rounds=rounds, seed=seed)


@app.command()
@with_groups
def check(files: Files, json: Json = False) -> int:
    """Say what files contain; verify their starts."""
    from sinuous.cli.check import check_files  # noqa: PLC0415

    return check_files(files, json=json)


@app.command()
def calibrate(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A problem file, or a file with a robot.")],
    measured: Annotated[str, typer.Argument(metavar="MEASURED.csv", help="Columns: actuators, and x,y,z.")],
    fit: Annotated[str | None, typer.Option(help="What to fit, as base,offsets,stiffness; else it is chosen.")] = None,
    unit: Annotated[float, typer.Option(help="Length units of the robot in one of the measurements.")] = 1.0,
    frame: Annotated[
        str, typer.Option(help="Whose pose is fitted, and where gravity is known: base or device.")
    ] = "base",
    motion: Annotated[
        Path | None, typer.Option(metavar="ROWS.csv", help="Rows of one motion: the robot has the bound of these.")
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="ROBOT.yaml", help="Write the calibrated robot.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw errors over rows and patterns.")] = None,
    json: Json = False,
) -> int:
    """Fit a robot to measurements."""
    from sinuous.cli.calibrate import calibrate_file  # noqa: PLC0415

    return calibrate_file(file, measured, fit, unit, frame, motion, out, plot, json=json)


@app.command()
@with_groups
def view(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A problem file, YAML or JSON.", show_default=False)],
    html: Annotated[
        Path | None, typer.Option(metavar="OUT", help="Write the page, with the answer, into one file instead.")
    ] = None,
    result: Annotated[
        Path | None,
        typer.Option(metavar="RESULTS", help="Begin with what solve, track or plan wrote (--out) for it."),
    ] = None,
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Address to listen at; of this machine alone by default.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen at, or the next one that is free.")
    ] = 8080,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    memory: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Shapes to begin from, of earlier commands; what is solved is added."),
    ] = None,
    clearance: Clearance = None,
    self_clearance: SelfClearance = None,
) -> int:
    """Show a problem in the browser, to be solved by dragging."""
    from sinuous.cli.view import view_file  # noqa: PLC0415

    demands = read_demands(clearance, self_clearance)
    return view_file(file, html, host, port, result, browser=browser, memory=memory, demands=demands)


def _kinds_like(begun: str) -> list[str]:
    """Return kinds of new problem files, for the shell to complete one."""
    from sinuous.cli.new import KINDS  # noqa: PLC0415

    return [kind for kind in KINDS if kind.startswith(begun)]


@app.command()
@with_groups
def new(
    kind: Annotated[
        str,
        typer.Argument(
            help="tendon, pneumatic, insertion or inspection.", autocompletion=_kinds_like, show_default=False
        ),
    ],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The file to write.", show_default=False)],
    force: Annotated[bool, typer.Option("--force", help="Write over a file that is there.")] = False,
) -> int:
    """Write a commented problem file to start from."""
    from sinuous.cli.new import write_new  # noqa: PLC0415

    return write_new(kind, file, force=force)


@app.command()
@with_groups
def warm(
    method: Annotated[
        list[str] | None,
        typer.Option(help="Only what this method needs; may be repeated.", autocompletion=methods_like),
    ] = None,
    where: Annotated[bool, typer.Option("--where", help="Say where compiled kernels are kept.")] = False,
    clear: Annotated[bool, typer.Option("--clear", help="Remove what is compiled.")] = False,
    profile: Annotated[bool, typer.Option("--profile", help="Print the seconds of what is compiled.")] = False,
) -> int:
    """Compile everything now, once on this machine."""
    from sinuous.cli import warm as command  # noqa: PLC0415

    if where + clear + profile > 1 or (method and (where or clear)):
        raise InputError("warm", "", "several options", "--where, --clear or --profile alone")
    if where:
        return command.show_store()
    if clear:
        return command.clear_store()
    return command.profile(method or ()) if profile else command.warm_up(method or ())


@app.command()
@with_groups
def design(
    file: Annotated[str, typer.Argument(metavar="FILE", help="Robot, scene, tasks, and what is varied.")],
    solving: DesignSolving,
    minimise: Annotated[
        str | None,
        typer.Option(metavar="NAME[,NAME]", help="Instead of what the file says: actuators, length, bend, ..."),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="FIELD=LOW:HIGH", help="Or FIELD=VALUE,VALUE; beside those of the file; may be repeated."),
    ] = None,
    robots: Annotated[int | None, typer.Option(metavar="COUNT", help="Robots that are judged.")] = None,
    budget: Annotated[float | None, typer.Option(metavar="SECONDS", help="Time for all of them.")] = None,
    workers: Workers = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the best robot, as YAML or JSON; goes on if interrupted.")
    ] = None,
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the front as a table.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the front: .png, .svg, .pdf.")] = None,
    json: Json = False,
) -> int:
    """Find the robot that does all tasks of a file and has the least of something."""
    from sinuous.cli.design import design_file  # noqa: PLC0415

    run = {"robots": robots, "budget": budget, "workers": workers}
    return design_file(file, solving, minimise, vary or [], run, out, csv, plot, json=json)


@app.callback(invoke_without_command=True)
def _start(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        typer.echo(f"sinuous {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; whatever is wrong with the input is one line on standard error.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    """
    return execute(app, "sinuous", arguments)


def execute(commands: typer.Typer, name: str, arguments: Sequence[str] | None) -> int:
    """Run commands and return the exit code, with one line on standard error where the input is wrong.

    Parameters
    ----------
    commands : Typer
    name : str
        What was typed before the arguments.
    arguments : sequence of str, optional
        Default: those of the process.
    """
    try:
        command = typer.main.get_command(commands)
        code = command.main(arguments, prog_name=name, standalone_mode=False)
        return int(code or 0)
    except InputError as error:
        _say(str(error))
        return BAD_INPUT
    except _UsageError as error:
        _say(f"{name}: {error.format_message()}")
        return BAD_INPUT
    except (OSError, UnfinishedError) as error:
        _say(f"{name}: {error}")
        return UNSOLVED


def _say(message: str) -> None:
    typer.echo(" ".join(message.split()), err=True)
