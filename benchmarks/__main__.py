"""`python -m benchmarks NAME`: what may be typed, and what the shell is told.

Nothing heavy is imported before a measurement begins: `--help` answers at once, and the number of threads is set before
NumPy looks at it.
"""

import os
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from sinuous.cli.app import execute

os.environ.setdefault("SINUOUS_KERNELS", "compiled")  # nothing is measured, or judged, interpreted
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    # Read when NumPy is first imported. Matrices are tiny here: on a busy machine the threads of a linear algebra
    # library wait for each other ten times as long as verifying takes.
    os.environ.setdefault(_variable, "1")

if TYPE_CHECKING:
    from benchmarks.harness import Experiment, Plan


class Known(NamedTuple):
    """An experiment: what it measures, its module, and what makes it of a plan; or its parts, by default `PARTS`."""

    about: str
    module: str
    made: str = "PARTS"


KNOWN = {
    "speed": Known("every speed and success figure of the README (10 minutes)", "speed.experiment"),
    "clutter": Known(
        "intricate places, each known to be possible: what is solved, and how quickly", "clutter", "clutter"
    ),
    "wild": Known("anything that can be built, with hidden solutions, every claim judged", "wild.experiment", "wild"),
    "ablation": Known("places with each attempt of the solver switched off", "ways", "ablation"),
    "demanded": Known("places with a clearance demanded, or a body that is thicker by as much", "ways", "demanded"),
    "remembered": Known("many targets in one place, with a memory and without", "ways", "remembered"),
    "explored": Known("plans into places that were explored, and without that", "ways", "explored"),
    "many": Known("batches through files, and engines", "many"),
    "motion": Known(
        "motions planned, tracked, led and stepped: what is found, and whether it is clear", "motion.experiment"
    ),
    "seams": Known("welds, seams and other paths: followed whole, and whether the tip stays on them", "motion.seams"),
    "limits": Known("limits of tension in steps and motions of elastic arms, loaded or not", "motion.limits"),
    "derivatives": Known("derivatives of answers: their costs, and whether differences agree", "derivatives"),
    "design": Known("robots for sets of tasks, against random ones and a template", "design"),
    "joints": Known("arms with joints before the segments, beside an analytic rigid solver", "joints"),
    "real": Known("robots as they are, beside published figures: calibrated, and under load", "real"),
    "workspace": Known("maps of three published robots, against solves at random places", "workspace"),
    "inputs": Known("files in every dialect: right, refused, or noted; wrong units; large meshes", "inputs"),
    "view": Known("pages: from an event of the mouse to a new shape, and pages in files", "view"),
    "worlds": Known("100,000 small worlds with doors: false claims that are rare", "clutter", "worlds"),
    "table1": Known("the paper's four poses, every method, beside what the paper publishes", "methods", "table1"),
    "tracking": Known("a path of 180 points behind random spheres, every method", "methods", "tracking"),
    "segments": Known("how times grow with the number of segments", "methods", "segments"),
    "methods": Known("all methods on common random problems, with and without obstacles", "methods", "methods"),
}

TOOLS = {
    "trace": ("trace", "how many files of the package run in a solve"),
    "rooms": ("rooms", "lines of code by room, rooms, public names, words"),
    "corpus": ("corpus", "some thousand problems with their answers, to hold a change of the code to the last bit"),
    "mbm": ("mbm", "plans of the problems of MotionBenchMaker, beside what is published for the Panda"),
    "places": ("clutter", "one place again, and a picture of it"),
}
"""Commands of their own: module, whose function `run` or whose `app` is the command, and what each does."""

INTERRUPTED = 130

app = typer.Typer(add_completion=False, rich_markup_mode=None)

Name = Annotated[str, typer.Argument(metavar="NAME", help="One of " + ", ".join(KNOWN) + ".")]
Out = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Folder of journal and results, default bench-NAME; there a run goes on."),
]
Seed = Annotated[int, typer.Option(help="Of all random problems.")]
Quick = Annotated[bool, typer.Option("--quick", help="A short run, for a first look.")]
Record = Annotated[Path | None, typer.Option(metavar="FOLDER", help="Also keep the report there as NAME.txt.")]
Parts = Annotated[
    list[str] | None,
    typer.Option("--piece", metavar="NAME", help="Only this part, or a pattern like 'P5*'; repeat for more."),
]


@app.command(epilog="Exit codes: 0 all claims held, 1 one did not, 2 bad input, 130 interrupted.")
def run(
    name: Name, out: Out = None, seed: Seed = 0, quick: Quick = False, record: Record = None, piece: Parts = None
) -> None:
    """Measure."""
    from sinuous.base import checks  # noqa: PLC0415

    checks.choice("NAME", name, tuple(KNOWN))
    checks.integer("--seed", seed, 0, 2**31 - 1)
    from benchmarks.harness import Plan, conduct, ignore_suspicions, require  # noqa: PLC0415

    ignore_suspicions()
    require()
    try:
        raise typer.Exit(conduct(experiment(name, Plan(seed, quick), piece or ()), out, record))
    except KeyboardInterrupt:
        typer.echo("benchmarks: interrupted before anything was measured", err=True)
        raise typer.Exit(INTERRUPTED) from None


def experiment(name: str, plan: "Plan", parts: Sequence[str] = ()) -> "Experiment":
    """Prepare an experiment, or some of its parts; what it needs is imported now.

    Parameters
    ----------
    name : str
    plan : Plan
    parts : sequence of str
        Those to measure, also by patterns; none means all.

    Raises
    ------
    InputError
        When there is no such part.
    """
    from benchmarks.harness import Experiment  # noqa: PLC0415

    known = KNOWN[name]
    made: Any = getattr(import_module(f"benchmarks.{known.module}"), known.made)
    whole = Experiment.of(name, plan, made) if isinstance(made, Mapping) else made(plan)
    return whole.only(parts) if parts else whole


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; whatever is wrong with the input is one line on standard error.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    """
    typed = sys.argv[1:] if arguments is None else arguments
    if typed and typed[0] in TOOLS:
        from benchmarks.harness import ignore_suspicions  # noqa: PLC0415

        ignore_suspicions()
        tool: Any = import_module(f"benchmarks.{TOOLS[typed[0]][0]}")
        own = getattr(tool, "app", None)
        if own is None:
            own = typer.Typer(add_completion=False, rich_markup_mode=None)
            own.command()(tool.run)
        return execute(typer.main.get_command(own), f"python -m benchmarks {typed[0]}", typed[1:])
    app.registered_commands[0].help = _help(next((word for word in typed if word in KNOWN), None))
    return execute(typer.main.get_command(app), "python -m benchmarks", arguments)


def _help(named: str | None) -> str:
    """What `--help` begins with: about the measurement that was named, or else about all."""
    told = {name: known.about for name, known in KNOWN.items()} | {name: about for name, (_, about) in TOOLS.items()}
    listed = "\n".join(f"{name}: {about}" for name, about in told.items())
    text = f"Measure {named}: {KNOWN[named].about}." if named else f"Measure one of these.\n\n\b\n{listed}"
    return f"{text}\n\nOnly verified answers count."


if __name__ == "__main__":
    sys.exit(main())
