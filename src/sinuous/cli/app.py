"""The command `sinuous`: what may be typed, and what the shell is told.

Nothing heavy is imported before a command runs, so that `sinuous --help` answers at once.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from sinuous import __version__
from sinuous.cli.options import Options
from sinuous.errors import InputError

FAILED, BAD_INPUT = 1, 2
_UsageError: Any = typer.BadParameter.__bases__[0]  # typer brings its own copy of click, under a private name

app = typer.Typer(
    help="Inverse kinematics and motion of continuum robots among obstacles.",
    epilog="Exit codes: 0 everything solved, 1 something not, 2 bad input, 130 interrupted.",
    rich_markup_mode=None,
)


def _methods(begun: str) -> list[str]:
    """Names of methods, for the shell to complete one."""
    from sinuous.methods.registry import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(begun)]


def _kinds(begun: str) -> list[str]:
    """Kinds of new problem files, for the shell to complete one."""
    from sinuous.cli.new import KINDS  # noqa: PLC0415

    return [kind for kind in KINDS if kind.startswith(begun)]


Files = Annotated[list[str], typer.Argument(metavar="FILE", help="Problem files, YAML or JSON.", show_default=False)]

Method = Annotated[str, typer.Option(help="Algorithm; docs/methods.md has them all.", autocompletion=_methods)]
Option = Annotated[
    list[str] | None, typer.Option(metavar="KEY=VALUE", help="Option of the algorithm; may be repeated.")
]
Time = Annotated[float, typer.Option(metavar="SECONDS", help="Budget of one solve.")]
MaxStarts = Annotated[
    int | None, typer.Option(metavar="COUNT", help="Most starts of one solve; else as many as the time allows.")
]
MostStarts = Annotated[int, typer.Option("--max-starts", metavar="COUNT", help="Most starts of one solve.")]
Routes = Annotated[bool, typer.Option(help="Search for routes through free space where the first starts fail.")]
Seed = Annotated[int, typer.Option(help="Of the random starts; the same seed gives the same answer.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object a line, and nothing else.")]
Why = Annotated[bool, typer.Option("--why", help="Say why it ended so, and what would help; all of that is tried.")]
Plot = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Draw it: .png, .svg, .pdf; .gif, .mp4 move; .html to turn; several files are numbered."
    ),
]
Out = Annotated[Path | None, typer.Option(metavar="FILE", help="Write the results as JSON lines.")]
Csv = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Write configurations and actuators as a table; several files are numbered."),
]
All = Annotated[
    int | None, typer.Option("--all", metavar="COUNT", help="Find up to so many distinct solutions, best first.")
]
By = Annotated[
    str | None,
    typer.Option(
        help="Of --all: route (one solution a class; the default among obstacles) or shape (all distinct ones)."
    ),
]
Rate = Annotated[
    float | None, typer.Option(metavar="HZ", help="Rows of --csv in a unit of time; by default one a knot.")
]
Deviation = Annotated[
    float | None,
    typer.Option(metavar="LENGTH", help="How far the tip may be from the straight line between waypoints."),
]
Shortcuts = Annotated[
    int, typer.Option(metavar="COUNT", help="How many random places of the motion are tried to be joined directly.")
]
Duration = Annotated[
    float | None,
    typer.Option(metavar="TIME", help="How long the motion takes; by default 1 or, with rates, as short as is found."),
]
Begin = Annotated[float, typer.Option(metavar="TIME", help="When the motion begins, where obstacles move.")]
PlanTime = Annotated[float, typer.Option("--time", metavar="SECONDS", help="Budget of one plan.")]
Kind = Annotated[
    str,
    typer.Argument(help="tendon, pneumatic, insertion or inspection.", autocompletion=_kinds, show_default=False),
]
ViewFile = Annotated[str, typer.Argument(metavar="FILE", help="A problem file, YAML or JSON.", show_default=False)]
Html = Annotated[
    Path | None, typer.Option(metavar="OUT", help="Write the page, with the answer, into one file instead.")
]
Host = Annotated[str, typer.Option(metavar="ADDRESS", help="Address to listen at; of this machine alone by default.")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port to listen at, or the next one that is free.")]
Result = Annotated[
    Path | None,
    typer.Option("--result", metavar="RESULTS", help="Begin with what solve, track or plan wrote (--out) for it."),
]
Browser = Annotated[bool, typer.Option(help="Open the page in the browser.")]
New = Annotated[Path, typer.Argument(metavar="FILE", help="The file to write.", show_default=False)]
Force = Annotated[bool, typer.Option("--force", help="Write over a file that is there.")]
Methods = Annotated[
    list[str] | None,
    typer.Option("--method", help="Only what this method needs; may be repeated.", autocompletion=_methods),
]

Problem = Annotated[
    str, typer.Argument(metavar="FILE", help="A problem file, whose targets are left alone.", show_default=False)
]
Targets = Annotated[
    Path, typer.Option(metavar="TABLE", help="Targets, a row each: .csv, .npz or .parquet.", show_default=False)
]
Results = Annotated[
    Path, typer.Option("--out", metavar="TABLE", help="Results, of the same kinds.", show_default=False)
]
Chunk = Annotated[int, typer.Option(metavar="ROWS", help="What is solved, and written, together.")]
EngineName = Annotated[str, typer.Option("--engine", help="threads or processes.")]
Dask = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Workers of this Dask scheduler; local: some on this machine.")
]
Workers = Annotated[int | None, typer.Option(metavar="COUNT", help="Threads or processes; by default one a core.")]
Shard = Annotated[
    str | None, typer.Option(metavar="I/N", help="Only this part of the chunks; without it, all parts are joined.")
]
Spacing = Annotated[
    float | None, typer.Option(help="Edge of a voxel; by default a 35th of the reach.", show_default=False)
]
Directions = Annotated[int, typer.Option(metavar="COUNT", help="Of the tangent, in each voxel.")]
MapOut = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the map as NPZ.")]
MapPlot = Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="Draw the map; .html is a page.")]
Warm = Annotated[bool, typer.Option("--warm", help="Begin from solutions of near targets.")]


@app.command()
def solve(
    files: Files,
    method: Method = "newton",
    option: Option = None,
    time: Time = 1.0,
    max_starts: MaxStarts = None,
    routes: Routes = True,
    seed: Seed = 0,
    why: Why = False,
    json: Json = False,
    plot: Plot = None,
    out: Out = None,
    csv: Csv = None,
    all_: All = None,
    by: By = None,
) -> None:
    """Meet a target, or several at once."""
    from sinuous.cli.work import solve_files  # noqa: PLC0415

    options = Options(method, tuple(option or ()), time, max_starts, routes, seed, json, plot, out, why, csv)
    raise typer.Exit(solve_files(files, options, all_, by))


@app.command()
def track(
    files: Files,
    method: Method = "newton",
    option: Option = None,
    time: Time = 1.0,
    max_starts: MaxStarts = None,
    routes: Routes = True,
    seed: Seed = 0,
    json: Json = False,
    plot: Plot = None,
    out: Out = None,
    csv: Csv = None,
    rate: Rate = None,
    deviation: Deviation = None,
) -> None:
    """Follow a path, each target from the last."""
    from sinuous.cli.work import track_files  # noqa: PLC0415

    options = Options(method, tuple(option or ()), time, max_starts, routes, seed, json, plot, out, csv=csv, rate=rate)
    raise typer.Exit(track_files(files, options, deviation))


@app.command()
def plan(
    files: Files,
    method: Method = "newton",
    option: Option = None,
    time: PlanTime = 5.0,
    max_starts: MaxStarts = None,
    routes: Routes = True,
    shortcuts: Shortcuts = 0,
    begin: Begin = 0.0,
    duration: Duration = None,
    seed: Seed = 0,
    json: Json = False,
    plot: Plot = None,
    out: Out = None,
    csv: Csv = None,
    rate: Rate = None,
) -> None:
    """Plan a motion from a start to a target or goal, clear all the way."""
    from sinuous.cli.work import plan_files  # noqa: PLC0415

    options = Options(method, tuple(option or ()), time, max_starts, routes, seed, json, plot, out, csv=csv, rate=rate)
    raise typer.Exit(plan_files(files, options, shortcuts=shortcuts, begin=begin, duration=duration))


@app.command()
def batch(
    file: Problem,
    targets: Targets,
    out: Results,
    chunk: Chunk = 10_000,
    engine: EngineName = "threads",
    dask: Dask = None,
    workers: Workers = None,
    shard: Shard = None,
    warm: Warm = False,
    method: Method = "newton",
    option: Option = None,
    time: Time = 1.0,
    max_starts: MostStarts = 1000,
    routes: Routes = True,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Solve the targets of a table, any number; interrupted, the same command goes on."""
    from sinuous.cli.batch import Run, batch_file  # noqa: PLC0415

    run = Run(targets, out, chunk, engine, dask, workers, shard, warm)
    raise typer.Exit(batch_file(file, run, Options(method, tuple(option or ()), time, max_starts, routes, seed, json)))


@app.command()
def reach(
    file: Problem,
    spacing: Spacing = None,
    directions: Directions = 26,
    workers: Workers = None,
    method: Method = "newton",
    option: Option = None,
    time: Time = 1.0,
    max_starts: MostStarts = 1,
    routes: Routes = False,
    seed: Seed = 0,
    json: Json = False,
    plot: MapPlot = None,
    out: MapOut = None,
) -> None:
    """Map what the robot reaches, with its obstacles and without, and why not more."""
    from sinuous.cli.reach import Map, reach_file  # noqa: PLC0415

    options = Options(method, tuple(option or ()), time, max_starts, routes, seed, json, plot, out)
    raise typer.Exit(reach_file(file, Map(spacing, directions, workers), options))


@app.command()
def check(files: Files, json: Json = False) -> None:
    """Say what files contain; verify their starts."""
    from sinuous.cli.check import check_files  # noqa: PLC0415

    raise typer.Exit(check_files(files, json=json))


@app.command()
def view(
    file: ViewFile,
    html: Html = None,
    result: Result = None,
    host: Host = "127.0.0.1",
    port: Port = 8080,
    browser: Browser = True,
) -> None:
    """Show a problem in the browser, to be solved by dragging."""
    from sinuous.cli.view import view_file  # noqa: PLC0415

    raise typer.Exit(view_file(file, html, host, port, result, browser=browser))


@app.command()
def new(kind: Kind, file: New, force: Force = False) -> None:
    """Write a commented problem file to start from."""
    from sinuous.cli.new import write_new  # noqa: PLC0415

    raise typer.Exit(write_new(kind, file, force=force))


@app.command()
def warm(method: Methods = None) -> None:
    """Compile everything now, once on this machine."""
    from sinuous.cli.warm import warm_up  # noqa: PLC0415

    raise typer.Exit(warm_up(method or ()))


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
    except OSError as error:
        _say(f"{name}: {error}")
        return FAILED


def _say(message: str) -> None:
    typer.echo(" ".join(message.split()), err=True)
