"""`python -m benchmarks NAME`: what may be typed, and what the shell is told.

Nothing heavy is imported before a measurement begins: `--help` answers at once, and the number of threads is set before
NumPy looks at it.
"""

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sinuous.cli.app import execute

os.environ.setdefault("SINUOUS_KERNELS", "compiled")  # nothing is measured, or judged, interpreted
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    # Read when NumPy is first imported. Matrices are tiny here: on a busy machine the threads of a linear algebra
    # library wait for each other ten times as long as verifying takes.
    os.environ.setdefault(_variable, "1")

if TYPE_CHECKING:
    from benchmarks.harness import Experiment, Plan


KNOWN = {
    "speed": ("speed.experiment", "every speed and success figure of the README (10 minutes)"),
    "clutter": ("clutter", "intricate places, each known to be possible: what is solved, and how quickly"),
    "wild": ("wild.experiment", "anything that can be built, with hidden solutions, every claim judged"),
    "ablation": ("ways", "places with each attempt of the solver switched off"),
    "remembered": ("ways", "many targets in one place, with a memory and without"),
    "explored": ("ways", "plans into places that were explored, and without that"),
    "many": ("many", "batches through files, and engines"),
    "motion": ("motion.experiment", "motions planned, tracked, led and stepped: what is found, and if it is clear"),
    "seams": ("motion.seams", "welds, seams and other paths: followed whole, and whether the tip stays on them"),
    "limits": ("motion.limits", "limits of tension in steps and motions of elastic arms, loaded or not"),
    "derivatives": ("derivatives", "derivatives of answers: their costs, and whether differences agree"),
    "design": ("design", "robots for sets of tasks, against random ones and a template"),
    "joints": ("joints", "arms with joints before the segments, beside an analytic rigid solver"),
    "real": ("real", "robots as they are, beside published figures: calibrated, and under load"),
    "workspace": ("workspace", "maps of three published robots, against solves at random places"),
    "inputs": ("inputs", "files in every dialect: right, refused, or noted; wrong units; large meshes"),
    "view": ("view", "pages: from an event of the mouse to a new shape, and pages in files"),
    "worlds": ("clutter", "100,000 small worlds with doors: false claims that are rare"),
    "table1": ("methods", "the paper's four poses, every method, beside what the paper publishes"),
    "tracking": ("methods", "a path of 180 points behind random spheres, every method"),
    "segments": ("methods", "how times grow with the number of segments"),
    "methods": ("methods", "all methods on common random problems, with and without obstacles"),
}
"""Experiments: module, whose `PARTS`, or whose function of that name, make one of a plan; and what each measures."""

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

    module: Any = import_module(f"benchmarks.{KNOWN[name][0]}")
    whole = Experiment.of(name, plan, module.PARTS) if hasattr(module, "PARTS") else getattr(module, name)(plan)
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
    listed = "\n".join(f"{name}: {about}" for name, (_, about) in (KNOWN | TOOLS).items())
    text = f"Measure {named}: {KNOWN[named][1]}." if named else f"Measure one of these.\n\n\b\n{listed}"
    return f"{text}\n\nOnly verified answers count."


if __name__ == "__main__":
    sys.exit(main())
