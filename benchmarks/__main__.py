"""`python -m benchmarks NAME`: what may be typed, and what the shell is told.

Nothing heavy is imported before a measurement begins: `--help` answers at once, and the number of threads is set before
NumPy looks at it.
"""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sinuous.base.errors import InputError
from sinuous.cli.app import execute
from sinuous.cli.options import check_writable

os.environ.setdefault("SINUOUS_KERNELS", "compiled")  # nothing is measured, or judged, interpreted

if TYPE_CHECKING:
    from benchmarks.harness.conduct import Output
    from benchmarks.harness.experiment import Experiment

ABOUT = {
    "speed": "every speed and success figure of the README (10 minutes)",
    "clutter": "intricate places, each known to be possible: what is solved, how quickly, and whether claims are true",
    "wild": "anything that can be built, each problem with a hidden solution, every claim judged",
    "many": "batches through files, engines, a batch that is killed, and a map of the workspace",
    "motion": "motions that are planned, tracked, led and stepped: what is found, how quickly, and whether it is clear",
    "derivatives": "derivatives of answers: what they cost, and whether differences agree with them",
    "design": "robots for sets of tasks, against random ones and a template",
    "real": "robots as they are, beside what others published: calibrated from motion capture, and shapes under load",
    "worlds": "100,000 small worlds with doors, each known to be possible: false claims that are rare",
    "view": "pages: from an event of the mouse to a new shape, what a browser gets, and pages in files",
    "table1": "the paper's four poses, every method, beside what the paper publishes",
    "tracking": "a path of 180 points behind random spheres, every method",
    "segments": "how the time of an iteration, and of a solve, grows with the number of segments",
    "methods": "all methods on common random problems, with and without obstacles",
}
"""What each one measures."""

OF_LINES = ("speed", "clutter", "wild", "many", "motion", "derivatives", "design", "real")
"""Those made of figures that a baseline can hold, and that may be measured in several rounds."""

OF_PARTS = (*OF_LINES, "view")
"""Those in which parts can be chosen."""

OF_METHODS = ("table1", "tracking", "segments", "methods")
"""Those in which methods can be chosen."""

BENCHMARKS = (*OF_LINES, "worlds", "view", *OF_METHODS)

HOMES = {
    "speed": ("speed.experiment", "Speed"),
    "clutter": ("clutter.experiment", "Clutter"),
    "wild": ("wild.experiment", "Wild"),
    "many": ("many.experiment", "Many"),
    "motion": ("motion.experiment", "Motions"),
    "real": ("real.experiment", "Real"),
    "derivatives": ("derivatives.experiment", "OfDerivatives"),
    "design": ("design.experiment", "OfDesigns"),
    "view": ("view.experiment", "View"),
    "worlds": ("clutter.worlds", "Worlds"),
}
"""Where those are that take a plan and nothing else."""

TOOLS = {
    "trace": "how many files of the package run in a solve",
    "rooms": "lines of code by room, circles of imports, public names",
    "corpus": "some 5,000 problems with their answers, to hold a change of the code to the last bit",
}
"""What looks at the code, and takes no time: modules with a command of their own."""

INTERRUPTED = 130

app = typer.Typer(add_completion=False, rich_markup_mode=None)

Name = Annotated[str, typer.Argument(metavar="NAME", help="One of " + ", ".join(BENCHMARKS) + ".")]
Out = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Folder of journal and results, default bench-NAME; there a run goes on."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, and nothing else.")]
Seed = Annotated[int, typer.Option(help="Of all random problems.")]
Quick = Annotated[bool, typer.Option("--quick", help="A short run, for a first look.")]
Rounds = Annotated[
    int,
    typer.Option(help="Of speed, clutter and motion, how often all is measured; of wild, 100,000 fresh problems each."),
]
Anew = Annotated[bool, typer.Option("--anew", help="Measure again what the folder holds.")]
Against = Annotated[
    Path | None, typer.Option(metavar="BASELINE", help="Say what is worse than there; exit with 1 if anything is.")
]
Keep = Annotated[Path | None, typer.Option(metavar="FILE", help="Keep the figures, to compare later runs with.")]
Record = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Also keep the report there as NAME.txt: docs/results is shown on the site."),
]
Parts = Annotated[
    list[str] | None,
    typer.Option(
        "--piece",
        metavar="NAME",
        help="Of "
        + ", ".join(OF_PARTS[:-1])
        + f" and {OF_PARTS[-1]}, only this part, or those that a pattern like 'P5*' fits; repeat for more. "
        "What fits none is answered with all names.",
    ),
]
Method = Annotated[
    list[str] | None, typer.Option(metavar="NAME", help="Of the others, only this method; repeat for more.")
]

Only = Annotated[
    list[str] | None,
    typer.Option(metavar="PROBLEM", help="Of wild, look at this problem alone, as reports name it; repeat for more."),
]
Without = Annotated[
    str | None,
    typer.Option(metavar="NAME,NAME", help="Of clutter, attempts of the solver that are switched off."),
]


@app.command(
    epilog="Exit codes: 0 all claims held, 1 one did not or a figure is worse than the baseline, 2 bad input, "
    "130 interrupted."
)
def run(
    name: Name,
    out: Out = None,
    json: Json = False,
    seed: Seed = 0,
    quick: Quick = False,
    rounds: Rounds = 1,
    anew: Anew = False,
    against: Against = None,
    save_baseline: Keep = None,
    record: Record = None,
    piece: Parts = None,
    method: Method = None,
    only: Only = None,
    without: Without = None,
) -> None:
    """Measure."""
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        # Read when NumPy is first imported. Matrices are tiny here: on a busy machine the threads of a linear algebra
        # library wait for each other ten times as long as verifying takes.
        os.environ.setdefault(variable, "1")
    off = () if without is None else tuple(without.split(","))
    chosen = Chosen(name, seed, quick, rounds, tuple(piece or ()), tuple(method or ()), tuple(only or ()), off)
    chosen.check()
    from benchmarks.harness.quiet import ignore_suspicions  # noqa: PLC0415

    ignore_suspicions()
    if chosen.only:
        from benchmarks.wild.replay import replay  # noqa: PLC0415

        typer.echo("\n".join(replay(chosen.seed, chosen.only)))
        raise typer.Exit(0)
    from benchmarks.harness.conduct import Output  # noqa: PLC0415

    output = Output(out, json, anew, against, save_baseline, whole=not piece, record=record)
    raise typer.Exit(_measure(chosen, output))


def _measure(chosen: "Chosen", output: "Output") -> int:
    from benchmarks.harness.conduct import conduct, require  # noqa: PLC0415

    for option, file in (("--against", output.against), ("--save-baseline", output.save_baseline)):
        if file is not None and chosen.name not in OF_LINES:
            raise InputError(option, "is for " + ", ".join(OF_LINES), str(file), f"nothing with {chosen.name}")
    if output.save_baseline is not None:
        check_writable("--save-baseline", output.save_baseline)
    require()
    try:
        return conduct(chosen.experiment(), output)
    except KeyboardInterrupt:
        typer.echo("benchmarks: interrupted before anything was measured", err=True)
        return INTERRUPTED


@dataclass(frozen=True)
class Chosen:
    """An experiment, as it was asked for.

    Attributes
    ----------
    name : str
    seed : int
    quick : bool
    rounds : int
    parts, methods : tuple of str
        Those to measure, parts also by patterns; none means all.
    only : tuple of str
        Names of problems to look at, instead of measuring.
    without : tuple of str
        Attempts of the solver that are switched off.
    """

    name: str
    seed: int = 0
    quick: bool = False
    rounds: int = 1
    parts: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    def check(self) -> None:
        """Refuse what cannot be meant.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.base import checks  # noqa: PLC0415

        if self.name not in BENCHMARKS:
            raise InputError("NAME", "", self.name, "one of " + ", ".join(BENCHMARKS))
        checks.integer("--seed", self.seed, 0, 2**31 - 1)
        checks.integer("--rounds", self.rounds, 1, 100)
        for option, given, able in (
            ("--piece", list(self.parts), OF_PARTS),
            ("--method", list(self.methods), OF_METHODS),
            ("--only", list(self.only), ("wild",)),
            ("--without", ",".join(self.without), ("clutter",)),
            ("--rounds", self.rounds if self.rounds > 1 else None, OF_LINES),
        ):
            if given and self.name not in able:
                raise InputError(option, "is for " + ", ".join(able), given, f"nothing with {self.name}")

    def experiment(self) -> "Experiment":
        """Prepare it; what it needs is imported now.

        Raises
        ------
        InputError
            When there is no such part, method or attempt.
        """
        from benchmarks.harness.plan import Plan  # noqa: PLC0415

        plan = Plan(self.seed, self.quick, self.rounds)
        if self.name in HOMES:
            home, kind = HOMES[self.name]
            plain = getattr(import_module(f"benchmarks.{home}"), kind)(plan)
            if self.parts:
                plain.choose(self.parts)
            if self.without:
                plain.switch_off(self.without)
            experiment: Experiment = plain
            return experiment
        made: Experiment = getattr(import_module(f"benchmarks.paper.{self.name}.experiment"), self.name.capitalize())(
            plan, self.methods
        )
        return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; whatever is wrong with the input is one line on standard error.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    """
    typed = sys.argv[1:] if arguments is None else arguments
    if typed and typed[0] in TOOLS:
        code: int = import_module(f"benchmarks.{typed[0]}").main(typed[1:])
        return code
    app.registered_commands[0].help = _help(next((word for word in typed if word in ABOUT), None))
    return execute(typer.main.get_command(app), "python -m benchmarks", arguments)


def _help(named: str | None) -> str:
    """What `--help` begins with: about the measurement that was named, or else about all."""
    listed = "\n".join(f"{name}: {about}" for name, about in {**ABOUT, **TOOLS}.items())
    text = f"Measure {named}: {ABOUT[named]}." if named else f"Measure one of these.\n\n\b\n{listed}"
    return f"{text}\n\nOnly verified answers count."


if __name__ == "__main__":
    sys.exit(main())
