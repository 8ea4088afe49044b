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
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from sinuous.base.errors import InputError
from sinuous.cli.app import execute
from sinuous.cli.options import check_writable

os.environ.setdefault("SINUOUS_KERNELS", "compiled")  # nothing is measured, or judged, interpreted

if TYPE_CHECKING:
    from benchmarks.harness.conduct import Output
    from benchmarks.harness.experiment import Experiment


class Known(NamedTuple):
    """An experiment: what it measures, the module that has it, and the class there; else it has `PARTS`."""

    about: str
    module: str
    kind: str = ""


KNOWN = {
    "speed": Known("every speed and success figure of the README (10 minutes)", "speed.experiment"),
    "clutter": Known(
        "intricate places, each known to be possible: what is solved, how quickly, and whether claims are true",
        "clutter.experiment",
        "Clutter",
    ),
    "wild": Known(
        "anything that can be built, each problem with a hidden solution, every claim judged", "wild.experiment", "Wild"
    ),
    "many": Known("batches through files, engines, a batch that is killed, and a map of the workspace", "many"),
    "motion": Known(
        "motions that are planned, tracked, led and stepped: what is found, how quickly, and whether it is clear",
        "motion.experiment",
    ),
    "derivatives": Known(
        "derivatives of answers: what they cost, and whether differences agree with them", "derivatives.experiment"
    ),
    "design": Known("robots for sets of tasks, against random ones and a template", "design"),
    "real": Known(
        "robots as they are, beside what others published: calibrated from motion capture, and shapes under load",
        "real.experiment",
    ),
    "view": Known("pages: from an event of the mouse to a new shape, and pages in files", "view"),
    "worlds": Known(
        "100,000 small worlds with doors, each known to be possible: false claims that are rare",
        "clutter.experiment",
        "Worlds",
    ),
    "table1": Known("the paper's four poses, every method, beside what the paper publishes", "paper.table1", "Table1"),
    "tracking": Known("a path of 180 points behind random spheres, every method", "paper.tracking", "Tracking"),
    "segments": Known(
        "how the time of an iteration, and of a solve, grows with the number of segments", "paper.segments", "Segments"
    ),
    "methods": Known("all methods on common random problems, with and without obstacles", "paper.methods", "Methods"),
}

OF_METHODS = ("table1", "tracking", "segments", "methods")
"""Those in which methods can be chosen; of the others parts can be, and they may be measured in several rounds."""

OF_LINES = tuple(name for name in KNOWN if name not in OF_METHODS)
"""Those made of figures that a baseline can hold."""

TOOLS = {
    "trace": ("trace", "how many files of the package run in a solve"),
    "rooms": ("rooms", "lines of code by room, circles of imports, public names"),
    "corpus": ("corpus", "some 5,000 problems with their answers, to hold a change of the code to the last bit"),
    "ways": ("clutter.ways", "places solved in several ways: with a memory, explored, attempts switched off"),
    "places": ("clutter.gallery", "one place again, or a picture of one of each kind"),
}
"""Commands of their own: module, and what each does."""

INTERRUPTED = 130

app = typer.Typer(add_completion=False, rich_markup_mode=None)

Name = Annotated[str, typer.Argument(metavar="NAME", help="One of " + ", ".join(KNOWN) + ".")]
Out = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Folder of journal and results, default bench-NAME; there a run goes on."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, and nothing else.")]
Seed = Annotated[int, typer.Option(help="Of all random problems.")]
Quick = Annotated[bool, typer.Option("--quick", help="A short run, for a first look.")]
Rounds = Annotated[int, typer.Option(help="How often all is measured; of wild, 100,000 fresh problems each.")]
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
        help="Only this part, or those that a pattern like 'P5*' fits; repeat for more. What fits none is answered "
        "with all names.",
    ),
]
Method = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help=f"Of {', '.join(OF_METHODS)}, only this method; repeat for more."),
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
    asked = Asked(name, seed, quick, rounds, tuple(piece or ()), tuple(method or ()), tuple(only or ()), off)
    baselines = {"--against": against, "--save-baseline": save_baseline}
    asked.check({option: str(file) for option, file in baselines.items() if file is not None})
    from benchmarks.harness.quiet import ignore_suspicions  # noqa: PLC0415

    ignore_suspicions()
    if only:
        typer.echo("\n".join(import_module("benchmarks.wild.trials").replay(seed, only)))
        raise typer.Exit(0)
    from benchmarks.harness.conduct import Output  # noqa: PLC0415

    output = Output(out, json, anew, against, save_baseline, whole=not piece, record=record)
    raise typer.Exit(_measure(asked, output))


def _measure(asked: "Asked", output: "Output") -> int:
    from benchmarks.harness.conduct import conduct, require  # noqa: PLC0415

    if output.save_baseline is not None:
        check_writable("--save-baseline", output.save_baseline)
    require()
    try:
        return conduct(asked.experiment(), output)
    except KeyboardInterrupt:
        typer.echo("benchmarks: interrupted before anything was measured", err=True)
        return INTERRUPTED


@dataclass(frozen=True)
class Asked:
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

    def check(self, baselines: dict[str, str]) -> None:
        """Refuse what cannot be meant; `baselines` are files by their options.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.base import checks  # noqa: PLC0415

        checks.choice("NAME", self.name, tuple(KNOWN))
        checks.integer("--seed", self.seed, 0, 2**31 - 1)
        checks.integer("--rounds", self.rounds, 1, 100)
        given: list[tuple[str, Any, tuple[str, ...]]] = [
            ("--piece", list(self.parts), OF_LINES),
            ("--method", list(self.methods), OF_METHODS),
            ("--only", list(self.only), ("wild",)),
            ("--without", ",".join(self.without), ("clutter",)),
            ("--rounds", self.rounds if self.rounds > 1 else None, OF_LINES),
            *((option, file, OF_LINES) for option, file in baselines.items()),
        ]
        for option, value, able in given:
            if value and self.name not in able:
                raise InputError(option, "is for " + ", ".join(able), value, f"nothing with {self.name}")

    def experiment(self) -> "Experiment":
        """Prepare it; what it needs is imported now.

        Raises
        ------
        InputError
            When there is no such part, method or attempt.
        """
        from benchmarks.harness.experiment import OfLines  # noqa: PLC0415
        from benchmarks.harness.plan import Plan  # noqa: PLC0415

        plan, known = Plan(self.seed, self.quick, self.rounds), KNOWN[self.name]
        module: Any = import_module(f"benchmarks.{known.module}")
        if self.name in OF_METHODS:
            contest: Experiment = getattr(module, known.kind)(plan, self.methods)
            return contest
        made: Any = getattr(module, known.kind)(plan) if known.kind else OfLines(self.name, plan, module.PARTS)
        if self.parts:
            made.choose(self.parts)
        if self.without:
            made.switch_off(self.without)
        experiment: Experiment = made
        return experiment


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; whatever is wrong with the input is one line on standard error.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    """
    typed = sys.argv[1:] if arguments is None else arguments
    if typed and typed[0] in TOOLS:
        code: int = import_module(f"benchmarks.{TOOLS[typed[0]][0]}").main(typed[1:])
        return code
    app.registered_commands[0].help = _help(next((word for word in typed if word in KNOWN), None))
    return execute(typer.main.get_command(app), "python -m benchmarks", arguments)


def _help(named: str | None) -> str:
    """What `--help` begins with: about the measurement that was named, or else about all."""
    told = {
        **{name: known.about for name, known in KNOWN.items()},
        **{name: about for name, (_, about) in TOOLS.items()},
    }
    listed = "\n".join(f"{name}: {about}" for name, about in told.items())
    text = f"Measure {named}: {KNOWN[named].about}." if named else f"Measure one of these.\n\n\b\n{listed}"
    return f"{text}\n\nOnly verified answers count."


if __name__ == "__main__":
    sys.exit(main())
