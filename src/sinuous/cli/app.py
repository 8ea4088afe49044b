"""The command `sinuous`: what may be typed, and what the shell is told.

Nothing heavy is imported before a command runs, so that `sinuous --help` answers at once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from sinuous import __version__
from sinuous.base.errors import InputError, UnfinishedError, suggested
from sinuous.cli.options import (
    BAD_INPUT,
    COLUMNS,
    FILES,
    JSON,
    PLACE,
    REMEMBERED,
    REQUIRED,
    UNSOLVED,
    WORKERS,
    Asked,
    BatchSolving,
    Demands,
    DesignSolving,
    ExploreSolving,
    MapSolving,
    MotionOutput,
    Output,
    PlanSolving,
    Remembering,
    Timed,
    Working,
    argument,
    flag,
    for_typer,
    methods_like,
    opt,
)

_UsageError: Any = typer.BadParameter.__bases__[0]  # typer brings its own copy of click, under a private name

app = typer.Typer(
    help="Inverse kinematics and motion of continuum robots among obstacles.",
    epilog="Exit codes: 0 everything solved, 1 something not, 2 bad input, 130 interrupted.",
    rich_markup_mode=None,
)


def command(module: str, answer: str) -> Callable[[type[Asked]], type[Asked]]:
    """Make a command of a dataclass, whose fields are its options: a function of a module of this room answers it."""

    def declared(asked: type[Asked]) -> type[Asked]:
        def answered(given: Asked) -> int:
            code: int = getattr(import_module(f"sinuous.cli.{module}"), answer)(given)
            return code

        app.command(asked.__name__.lower())(for_typer(asked, answered))
        return asked

    return declared


@command("work", "solve_files")
@dataclass(frozen=True, kw_only=True)
class Solve:
    """Meet a target, or several at once."""

    files: list[str] = argument(FILES)
    solving: Remembering
    output: Output
    why: bool = flag("Say why it ended so, and what would help; all of that is tried.")
    why_time: float | None = opt("Time for --why; default 2.", "SECONDS")
    all: int | None = opt("Find up to so many distinct solutions, best first.", "COUNT")
    by: str | None = opt(
        "Of --all: route (one solution a class; the default among obstacles) or shape (all distinct ones)."
    )


@command("work", "track_files")
@dataclass(frozen=True, kw_only=True)
class Track:
    """Follow a path, each target from the last."""

    files: list[str] = argument(FILES)
    solving: Remembering
    output: MotionOutput
    timed: Timed
    deviation: float | None = opt("How far the tip may be from the straight line between waypoints.", "LENGTH")
    reconfigure: str | None = opt(
        "refuse or allow: may the tip leave that line where the robot cannot follow it? By default as in the file.",
        "WORD",
    )


@command("work", "plan_files")
@dataclass(frozen=True, kw_only=True)
class Plan:
    """Plan a motion from a start to a target or goal. It is clear all the way."""

    files: list[str] = argument(FILES)
    solving: PlanSolving
    output: MotionOutput
    timed: Timed
    shortcuts: int = opt("How many random places of the motion are tried to be joined directly.", "COUNT", 0)
    begin: float = opt("When the motion begins, where obstacles move.", "TIME", 0.0)


@command("places", "batch_file")
@dataclass(frozen=True, kw_only=True)
class Batch:
    """Solve the targets of a table, any number. Interrupted, the same command goes on."""

    file: str = argument(PLACE)
    targets: Path = opt("Targets, a row each: .csv, .npz or .parquet.", "TABLE", REQUIRED, show_default=False)
    out: Path = opt("Results, of the same kinds.", "TABLE", REQUIRED, show_default=False)
    columns: str | None = opt(COLUMNS.format("--out", "row and status"), "NAME,...")
    solving: BatchSolving
    crew: Working
    chunk: int = opt("What is solved, and written, together.", "ROWS", 10_000)
    shard: str | None = opt("Only this part of the chunks; without it, all parts are joined.", "I/N")
    warm: bool = opt("Gone: see --memory.", default=False, flag=True, hidden=True)
    json: bool = flag(JSON)


@command("places", "explore_file")
@dataclass(frozen=True, kw_only=True)
class Explore:
    """Fill a memory with shapes and proved motions. Later solves and plans in this scene begin from them."""

    file: str = argument(PLACE)
    solving: ExploreSolving
    crew: Working
    memory: Path = opt("What is filled; when it is there, it goes on.", "FILE", REQUIRED, show_default=False)
    rounds: int | None = opt("Most rounds; by default as many as the time allows.", "COUNT")
    spacing: float | None = opt("How near covers a position; by default a 20th of the reach.", "LENGTH")
    json: bool = flag(JSON)


@command("places", "reach_file")
@dataclass(frozen=True, kw_only=True)
class Reach:
    """Map what the robot reaches, and why not more. Both among its obstacles and without them."""

    file: str = argument(PLACE)
    solving: MapSolving
    spacing: float | None = opt("Edge of a voxel; by default a 35th of the reach.", show_default=False)
    directions: int | None = opt("Of the tangent, in each voxel; by default 0: positions alone.", "COUNT")
    toward: str | None = opt("One direction of the tangent, instead of --directions.", "X,Y,Z")
    within: float | None = opt("How far the tangent may be off a direction, rad.", "ANGLE")
    workers: int | None = opt(WORKERS, "COUNT")
    json: bool = flag(JSON)
    plot: Path | None = opt("Draw the map; .html is a page.", "FILE")
    out: Path | None = opt("Write the map as NPZ.", "FILE")


@command("places", "train_file")
@dataclass(frozen=True, kw_only=True)
class Train:
    """Train the networks of the method learned. They give the robot shapes for targets."""

    file: str = argument(PLACE)
    out: Path = opt("Write the networks.", "NPZ", REQUIRED, show_default=False)
    samples: int = opt("Targets of each kind to learn from.", "COUNT", 5_000)
    width: int = opt("Units of each of the two hidden layers.", "COUNT", 64)
    rounds: int = opt("How often all targets are gone through.", "COUNT", 40)
    seed: int = opt("Of the targets; the same seed gives the same networks.", default=0)


@command("check", "check_files")
@dataclass(frozen=True, kw_only=True)
class Check:
    """Say what files contain; verify their starts."""

    files: list[str] = argument(FILES)
    json: bool = flag(JSON)


@command("calibrate", "calibrate_file")
@dataclass(frozen=True, kw_only=True)
class Calibrate:
    """Fit a robot to measurements."""

    file: str = argument("A problem file, or a file with a robot.")
    measured: str = argument("Columns: actuators, and x,y,z.", "MEASURED.csv")
    fit: list[str] | None = opt("What to fit, as base,offsets,stiffness; else it is chosen; may be repeated.")
    unit: float = opt("Length units of the robot in one of the measurements.", default=1.0)
    frame: str = opt("Whose pose is fitted, and where gravity is known: base or device.", default="base")
    motion: Path | None = opt("Rows of one motion: the robot has the bound of these.", "ROWS.csv")
    out: Path | None = opt("Write the calibrated robot.", "ROBOT.yaml")
    plot: Path | None = opt("Draw errors over rows and patterns.", "FILE.png")
    json: bool = flag(JSON)


@command("view", "view_file")
@dataclass(frozen=True, kw_only=True)
class View:
    """Show a problem in the browser, to be solved by dragging."""

    file: str = argument("A problem file, YAML or JSON.")
    html: Path | None = opt("Write the page, with the answer, into one file instead.", "OUT")
    result: Path | None = opt("Begin with what solve, track or plan wrote (--out) for it.", "RESULTS")
    host: str = opt("Address to listen at; of this machine alone by default.", "ADDRESS", "127.0.0.1")
    port: int = opt("Port to listen at, or the next one that is free.", default=8080, min=0, max=65535)
    browser: bool = opt("Open the page in the browser.", default=True)
    memory: Path | None = opt(REMEMBERED, "FILE")
    demanded: Demands


KINDS = {
    "tendon": "three sections with spacers, three tendons each, through a gap between obstacles",
    "pneumatic": "three soft sections that stretch, driven by three chambers each",
    "insertion": "an arm on an insertion stage, through a hole in a wall",
    "inspection": "a long slim arm that follows a path of views within a tank",
}
"""What each problem is about; `templates` holds the files."""


def _kinds_like(begun: str) -> list[str]:
    """Return kinds of new problem files, for the shell to complete one."""
    return [kind for kind in KINDS if kind.startswith(begun)]


@command("check", "write_new")
@dataclass(frozen=True, kw_only=True)
class New:
    """Write a commented problem file to start from."""

    kind: str = argument("tendon, pneumatic, insertion or inspection.", None, autocompletion=_kinds_like)
    file: Path = argument("The file to write.")
    force: bool = flag("Write over a file that is there.")


@command("warm", "warm_up")
@dataclass(frozen=True, kw_only=True)
class Warm:
    """Compile everything now, once on this machine."""

    method: list[str] | None = opt("Only what this method needs; may be repeated.", autocompletion=methods_like)
    where: bool = flag("Say where compiled kernels are kept.")
    clear: bool = flag("Remove what is compiled.")
    profile: bool = flag("Print the seconds of what is compiled.")


@command("design", "design_file")
@dataclass(frozen=True, kw_only=True)
class Design:
    """Find the robot that does all tasks of a file. It has the least of something, such as actuators."""

    file: str = argument("Robot, scene, tasks, and what is varied.")
    solving: DesignSolving
    minimise: str | None = opt("Instead of what the file says: actuators, length, bend, ...", "NAME[,NAME]")
    vary: list[str] | None = opt("Or FIELD=VALUE,VALUE; beside those of the file; may be repeated.", "FIELD=LOW:HIGH")
    robots: int | None = opt("Robots that are judged.", "COUNT")
    budget: float | None = opt("Time for all of them.", "SECONDS")
    workers: int | None = opt(WORKERS, "COUNT")
    out: Path | None = opt("Write the best robot, as YAML or JSON; goes on if interrupted.", "FILE")
    csv: Path | None = opt("Write the front as a table.", "FILE")
    plot: Path | None = opt("Draw the front: .png, .svg, .pdf.", "FILE")
    json: bool = flag(JSON)


@app.callback(invoke_without_command=True)
def _start(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
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
    return execute(_commands(), "sinuous", arguments)


@cache
def _commands() -> Any:
    """Make all commands with their options, once a process: it takes longer than to read what was typed."""
    return typer.main.get_command(app)


def execute(commands: Any, name: str, arguments: Sequence[str] | None) -> int:
    """Run commands and return the exit code, with one line on standard error where the input is wrong.

    Parameters
    ----------
    commands : Command
        What `typer.main.get_command` makes of a `Typer`.
    name : str
        What was typed before the arguments.
    arguments : sequence of str, optional
        Default: those of the process.
    """
    try:
        code = commands.main(arguments, prog_name=name, standalone_mode=False)
        return int(code or 0)
    except InputError as error:
        _say(str(error))
        return BAD_INPUT
    except _UsageError as error:
        _say(_refusal(name, error))
        return BAD_INPUT
    except (OSError, UnfinishedError) as error:
        _say(f"{name}: {error}")
        return UNSOLVED


WANTED = {"float": "a number", "int": "a whole number"}
"""What an option expects, by how the type of a refusal begins."""


def _refusal(name: str, error: Any) -> str:
    """What is wrong with what was typed, in the line that refuses input elsewhere."""
    option = getattr(error, "option_name", None)
    causes: list[dict[str, Any]] = getattr(error.__cause__, "errors", list)()
    if option is not None and error.ctx is not None:
        typed = [name for each in error.ctx.command.get_params(error.ctx) for name in each.opts + each.secondary_opts]
        known = [name for name in typed if name.startswith("-")]
        return str(InputError(option, "unknown option", None, suggested(option, known)))
    if causes:
        first = causes[0]
        wanted = WANTED.get(first["type"].partition("_")[0], first["msg"].removeprefix("Input should be "))
        return str(InputError(error.param.opts[0], "", first["input"], wanted))
    return f"{name}: {error.format_message()}"


def _say(message: str) -> None:
    typer.echo(" ".join(message.split()), err=True)
