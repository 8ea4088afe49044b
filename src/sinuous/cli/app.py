"""The command `sinuous`: what may be typed, and what the shell is told.

Nothing heavy is imported before a command runs, so that `sinuous --help` answers at once.
"""

import re
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
    """Find a shape that reaches a target, or several at once."""

    files: list[str] = argument(FILES)
    solving: Remembering
    output: Output
    why: bool = flag("Say why this is the answer, and which changes would help; each was tried.")
    why_time: float | None = opt("Time for --why; by default 2.", "SECONDS")
    all: int | None = opt("Find up to this many distinct solutions, best first.", "COUNT")
    by: str | None = opt(
        "For --all: route, one per way past the obstacles (the default where there are any); or shape, every shape."
    )


@command("work", "track_files")
@dataclass(frozen=True, kw_only=True)
class Track:
    """Follow a path with the tip, from waypoint to waypoint."""

    files: list[str] = argument(FILES)
    solving: Remembering
    output: MotionOutput
    timed: Timed
    deviation: float | None = opt(
        "How far the tip may be from the line between waypoints; by default ten position tolerances.", "LENGTH"
    )
    reconfigure: str | None = opt(
        "allow or refuse: may the tip leave the line where the robot cannot follow it? By default as in the file.",
        "WORD",
    )


@command("work", "plan_files")
@dataclass(frozen=True, kw_only=True)
class Plan:
    """Plan a motion from a start to a target or goal, clear of obstacles all the way."""

    files: list[str] = argument(FILES)
    solving: PlanSolving
    output: MotionOutput
    timed: Timed
    shortcuts: int = opt("How many shortcuts between random places of the motion to try.", "COUNT", 0)
    begin: float = opt("Time at which the motion begins; it matters where obstacles move.", "TIME", 0.0)


@command("places", "batch_file")
@dataclass(frozen=True, kw_only=True)
class Batch:
    """Solve all targets of a table. After an interrupt the same command goes on."""

    file: str = argument(PLACE)
    targets: Path = opt("Table of targets, one per row: .csv, .npz or .parquet.", "TABLE", REQUIRED, show_default=False)
    out: Path = opt("Table of results to write: .csv, .npz or .parquet.", "TABLE", REQUIRED, show_default=False)
    columns: str | None = opt(COLUMNS.format("--out", "row and status"), "NAME,...")
    solving: BatchSolving
    crew: Working
    chunk: int = opt("How many rows are solved, and then written, at a time.", "ROWS", 10_000)
    shard: str | None = opt("Solve only part I of N of the chunks; without it, parts that are there are joined.", "I/N")
    warm: bool = opt("Gone: see --memory.", default=False, flag=True, hidden=True)
    json: bool = flag(JSON)


@command("places", "explore_file")
@dataclass(frozen=True, kw_only=True)
class Explore:
    """Fill a memory with shapes and proved motions, from which later solves and plans in this scene begin."""

    file: str = argument(PLACE)
    solving: ExploreSolving
    crew: Working
    memory: Path = opt("The memory to fill; one that exists is added to.", "FILE", REQUIRED, show_default=False)
    rounds: int | None = opt("Most rounds of sampling; by default as many as the time allows.", "COUNT")
    spacing: float | None = opt(
        "Distance within which a known shape covers a position; by default 1/20 of the reach.", "LENGTH"
    )
    json: bool = flag(JSON)


@command("places", "reach_file")
@dataclass(frozen=True, kw_only=True)
class Reach:
    """Map what the robot reaches among its obstacles and without them, and why not more."""

    file: str = argument(PLACE)
    solving: MapSolving
    spacing: float | None = opt("Edge of a voxel; by default 1/35 of the reach.", "LENGTH")
    directions: int | None = opt(
        "How many directions of the tangent to ask for in each voxel; by default 0, positions alone.", "COUNT"
    )
    toward: str | None = opt("Ask for this one direction of the tangent, instead of --directions.", "X,Y,Z")
    within: float | None = opt(
        "How far the tangent may be off a direction, in rad; by default the tolerance of angles.", "ANGLE"
    )
    workers: int | None = opt(WORKERS, "COUNT")
    json: bool = flag(JSON)
    plot: Path | None = opt("Draw the map: .png, .svg or .pdf, or a page to turn, .html.", "FILE")
    out: Path | None = opt("Write the map, .npz.", "FILE")


@command("places", "train_file")
@dataclass(frozen=True, kw_only=True)
class Train:
    """Train the networks of the method `learned`, which guess shapes for targets."""

    file: str = argument(PLACE)
    out: Path = opt("File of the networks to write, .npz.", "FILE", REQUIRED, show_default=False)
    samples: int = opt("How many targets of each kind to learn from.", "COUNT", 5_000)
    width: int = opt("Units in each of the two hidden layers.", "COUNT", 64)
    rounds: int = opt("Passes over all targets (epochs).", "COUNT", 40)
    seed: int = opt("Seed of the targets; the same seed gives the same networks.", default=0)


@command("check", "check_files")
@dataclass(frozen=True, kw_only=True)
class Check:
    """Say what problem files contain, what is suspicious in them, and verify their starts."""

    files: list[str] = argument(FILES)
    json: bool = flag(JSON)


@command("calibrate", "calibrate_file")
@dataclass(frozen=True, kw_only=True)
class Calibrate:
    """Fit the parameters of a robot to measurements."""

    file: str = argument("A problem file, or a file with a robot.")
    measured: str = argument("Measured rows: a column for each actuator, and x,y,z.", "MEASURED.csv")
    fit: list[str] | None = opt("What to fit, such as base,offsets,stiffness; by default it is chosen.", "NAME,...")
    unit: float = opt(
        "How many length units of the robot one unit of the measurements is; mm measured for a robot in m: 0.001.",
        "NUMBER",
        default=1.0,
    )
    frame: str = opt(
        "Whose pose is fitted: base, of the robot, in the frame of the device; or device, in the world.", default="base"
    )
    motion: Path | None = opt(
        "Rows measured along one motion; the written robot gets the error bound of these.", "ROWS.csv"
    )
    out: Path | None = opt("Write the calibrated robot, YAML or JSON.", "ROBOT.yaml")
    plot: Path | None = opt("Draw the errors of rows and of patterns of motion.", "FILE.png")
    json: bool = flag(JSON)


@command("view", "view_file")
@dataclass(frozen=True, kw_only=True)
class View:
    """Show a problem in the browser, to be solved by dragging."""

    file: str = argument("A problem file, YAML or JSON.")
    html: Path | None = opt("Write the page with the answer into a file, and open nothing.", "FILE")
    result: Path | None = opt("Begin with a result that solve, track or plan wrote for this file by --out.", "FILE")
    host: str = opt("Address to listen at; the default is heard on this machine alone.", "ADDRESS", "127.0.0.1")
    port: int = opt("Port to listen at; if it is taken, the next free one.", default=8080, min=0, max=65535)
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

    kind: str = argument(
        "What kind of robot and task: tendon, pneumatic, insertion or inspection.", None, autocompletion=_kinds_like
    )
    file: Path = argument("The file to write.")
    force: bool = flag("Replace a file that exists.")


@command("warm", "warm_up")
@dataclass(frozen=True, kw_only=True)
class Warm:
    """Compile all kernels now, which is done once on a machine."""

    method: list[str] | None = opt("Compile only what this method needs; may be repeated.", autocompletion=methods_like)
    where: bool = flag("Print the folder of the compiled kernels.")
    clear: bool = flag("Delete all compiled kernels.")
    profile: bool = flag("Print how many CPU seconds each kernel took to compile.")


@command("design", "design_file")
@dataclass(frozen=True, kw_only=True)
class Design:
    """Find the robot that does all tasks of a file with the least of something, such as actuators."""

    file: str = argument("A file of a robot, a scene, tasks, and what is varied.")
    solving: DesignSolving
    minimise: str | None = opt(
        "What to minimise, instead of what the file says: actuators, length, bend, ...", "NAME[,NAME]"
    )
    vary: list[str] | None = opt(
        "Vary this too, within an interval or among FIELD=VALUE,VALUE,...; may be repeated.", "FIELD=LOW:HIGH"
    )
    robots: int | None = opt("Most robots to try; by default 2000.", "COUNT")
    budget: float | None = opt("Time for the whole search; by default 60.", "SECONDS")
    workers: int | None = opt(WORKERS, "COUNT")
    out: Path | None = opt("Write the best robot, YAML or JSON. After an interrupt the same command goes on.", "FILE")
    csv: Path | None = opt("Write the best robots (the Pareto front) as a table.", "FILE")
    plot: Path | None = opt("Draw the Pareto front: .png, .svg or .pdf.", "FILE")
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
    option, param = getattr(error, "option_name", None), getattr(error, "param", None)
    causes: list[dict[str, Any]] = getattr(error.__cause__, "errors", list)()
    context, message = error.ctx, error.format_message()
    told = re.search(r"^No such command '(?P<command>.+?)'|extra arguments?(\(s\))? \((?P<more>.+)\)$", message)
    refused = None
    if causes:
        first = causes[0]
        wanted = WANTED.get(first["type"].partition("_")[0], first["msg"].removeprefix("Input should be "))
        refused = InputError(_label(param), "", first["input"], wanted)
    elif param is not None and message.startswith("Missing"):
        wanted = (param.help or "a value").rstrip(".")
        refused = InputError(_label(param), "", None, wanted[0].lower() + wanted[1:])
    elif option is not None and context is not None:
        typed = [name for each in context.command.get_params(context) for name in each.opts + each.secondary_opts]
        known = [name for name in typed if name.startswith("-")]
        refused = InputError(option, "unknown option", None, suggested(option, known))
    elif option is not None:
        lacks = "requires" in message
        refused = InputError(option, "" if lacks else "takes no value", None, "a value" if lacks else f"{option} alone")
    elif told is not None and told["command"]:
        known = context.command.list_commands(context)
        refused = InputError(told["command"], "unknown command", None, suggested(told["command"], known))
    elif told is not None:
        labels = [label for each in context.command.get_params(context) if not (label := _label(each)).startswith("-")]
        refused = InputError(context.info_name, "more than it takes", told["more"], " ".join(labels) or "options alone")
    return f"{name}: {message}" if refused is None else str(refused)


def _label(param: Any) -> str:
    """What help calls an option or argument."""
    name: str = param.opts[0]
    return name if name.startswith("-") else param.metavar or name.upper()


def _say(message: str) -> None:
    typer.echo(" ".join(message.split()), err=True)
