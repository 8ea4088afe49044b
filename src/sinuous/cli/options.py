"""Options of the command line: each is declared once, in a group that commands take whole.

Nothing heavy is imported here, so that `sinuous --help` answers at once.
"""

import inspect
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sinuous.errors import InputError
from sinuous.writing.documents import written

if TYPE_CHECKING:
    from sinuous.methods.registry import Choice
    from sinuous.problem.problem import Preferences
    from sinuous.problem.target import Tolerance

SOLVED = 0
"""Exit code: everything is solved."""

UNSOLVED = 1
"""Exit code: something is not solved, or could not be written."""

BAD_INPUT = 2
"""Exit code: the input is wrong, which one line on standard error says."""

INTERRUPTED = 130
"""Exit code of a command that was interrupted."""

ENGINES = ("threads", "processes")
"""What `--engine` may name."""


def methods_like(begun: str) -> list[str]:
    """Return names of methods, for the shell to complete one."""
    from sinuous.methods.registry import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(begun)]


Files = Annotated[list[str], typer.Argument(metavar="FILE", help="Problem files, YAML or JSON.", show_default=False)]
Place = Annotated[
    str, typer.Argument(metavar="FILE", help="A problem file, whose targets are left alone.", show_default=False)
]
MostStarts = Annotated[int, typer.Option(metavar="COUNT", help="Most starts of one solve.")]
Routes = Annotated[bool, typer.Option(help="Search for routes through free space where the first starts fail.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object a line, and nothing else.")]
Clearance = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH", help="Distance from obstacles that the body keeps; or one a segment: 1,1,2; wrist=2."
    ),
]
SelfClearance = Annotated[str | None, typer.Option(metavar="LENGTH", help="The same of the body from itself.")]
Workers = Annotated[int | None, typer.Option(metavar="COUNT", help="Threads or processes; by default one a core.")]


@dataclass(frozen=True)
class Solving:
    """How solves are done."""

    method: Annotated[
        str, typer.Option(help="Algorithm; docs/methods.md has them all.", autocompletion=methods_like)
    ] = "newton"
    option: Annotated[
        list[str] | None, typer.Option(metavar="KEY=VALUE", help="Option of the algorithm; may be repeated.")
    ] = None
    time: Annotated[float, typer.Option(metavar="SECONDS", help="Budget of one solve.")] = 1.0
    max_starts: Annotated[
        int | None, typer.Option(metavar="COUNT", help="Most starts of one solve; else as many as the time allows.")
    ] = None
    routes: Routes = True
    seed: Annotated[int, typer.Option(help="Of the random starts; the same seed gives the same answer.")] = 0
    clearance: Clearance = None
    self_clearance: SelfClearance = None

    def arguments(self, tolerance: "Tolerance | None" = None, prefer: "Preferences | None" = None) -> dict[str, Any]:
        """Return the options of `Solver`, with what the problem file says.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.solving.options import SolveOptions  # noqa: PLC0415

        typed = {key: getattr(self, key) for key in ("time", "max_starts", "routes", "seed")} | self.demands
        with as_typed(*typed):
            return vars(SolveOptions.of({"method": self.choice(), "tolerance": tolerance, "prefer": prefer, **typed}))

    @property
    def demands(self) -> dict[str, Any]:
        """Clearances that are demanded, as arguments."""
        return read_demands(self.clearance, self.self_clearance)

    def choice(self) -> "Choice":
        """Return the method with its options.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.methods import registry  # noqa: PLC0415

        if self.method not in registry.METHODS:
            raise InputError("--method", "", self.method, "one of " + ", ".join(registry.METHODS))
        try:
            return registry.with_options(self.method, tuple(self.option or ()))
        except InputError as error:
            raise InputError(f"--option {error.key}".rstrip(), error.problem, error.value, error.expected) from None


@dataclass(frozen=True)
class Remembering(Solving):
    """How solves are done that begin from shapes of earlier ones."""

    memory: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Shapes to begin from, of earlier commands; what is solved is added.",
        ),
    ] = None


@dataclass(frozen=True)
class PlanSolving(Remembering):
    """How a plan is solved."""

    time: Annotated[float, typer.Option(metavar="SECONDS", help="Budget of one plan.")] = 5.0


@dataclass(frozen=True)
class BatchSolving(Solving):
    """How each target of a batch is solved."""

    max_starts: MostStarts = 100
    time: Annotated[float, typer.Option(metavar="SECONDS", help="Budget of one target.")] = 0.1
    memory: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Shapes to begin from, of earlier commands; it is only read.")
    ] = None


@dataclass(frozen=True)
class ExploreSolving(Solving):
    """How positions are solved while a place is explored."""

    max_starts: Annotated[int, typer.Option(metavar="COUNT", help="Most starts of a position anywhere.")] = 24
    time: Annotated[float, typer.Option(metavar="SECONDS", help="Time of all of it.")] = 60.0


@dataclass(frozen=True)
class DesignSolving(Solving):
    """How each target of a task is solved."""

    max_starts: MostStarts = 24


@dataclass(frozen=True)
class MapSolving(Solving):
    """How each direction of a map is solved."""

    max_starts: MostStarts = 1
    routes: Routes = False


@dataclass(frozen=True)
class Crew:
    """Who works on what takes long."""

    engine: Annotated[str, typer.Option(help="threads or processes.")] = "threads"
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Workers of this Dask scheduler; local: some on this machine."),
    ] = None
    workers: Workers = None

    def arguments(self) -> dict[str, Any]:
        """Return the arguments `engine` and `workers` of `solve_batch` and `explore`.

        Raises
        ------
        InputError
            That names the option.
        """
        if self.engine not in ENGINES:
            raise InputError("--engine", "", self.engine, "one of " + ", ".join(ENGINES))
        if self.dask is None:
            return {"engine": self.engine, "workers": self.workers}
        if self.engine != "threads":
            raise InputError("--dask", "cannot be combined with --engine", self.dask, "one of --engine, --dask")
        if self.dask != "local" and "://" not in self.dask:
            raise InputError("--dask", "", self.dask, "tcp://HOST:PORT of a scheduler, or local")
        return {"engine": "dask" if self.dask == "local" else self.dask, "workers": self.workers}


@dataclass(frozen=True)
class Output:
    """Where answers go."""

    json: Json = False
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Draw it: .png, .svg, .pdf; .gif, .mp4 move; .html to turn; several files are numbered.",
        ),
    ] = None
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the results as JSON lines.")] = None
    csv: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write configurations and actuators as a table; several files are numbered."),
    ] = None

    @property
    def file(self) -> Path | None:
        """A file of the answers; beside it stands what is done until all is."""
        return self.out or self.csv or self.plot

    def check(self, files: list[str]) -> None:
        """Refuse files that cannot be written, before any problem file is read.

        Raises
        ------
        InputError
            That names the option.
        """
        check_outputs(files, out=self.out, plot=self.plot, csv=self.csv)
        if self.plot is not None and is_page(self.plot):
            from sinuous.viewer.show import check_page  # noqa: PLC0415

            check_page("--plot", self.plot)
        elif self.plot is not None:
            from sinuous.pictures.files import check_picture  # noqa: PLC0415

            check_picture("--plot", self.plot)


@dataclass(frozen=True)
class MotionOutput(Output):
    """Where motions go."""

    rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Rows of --csv in a unit of time; by default one a knot.")
    ] = None

    def check(self, files: list[str]) -> None:
        """See `Output.check`."""
        if self.rate is not None:
            from sinuous import checks  # noqa: PLC0415

            checks.number("--rate", self.rate, above=0.0)
            if self.csv is None:
                raise InputError("--rate", "is for --csv", self.rate, "--csv FILE, too")
        super().check(files)


@dataclass(frozen=True)
class Timed:
    """In which times a motion is passed."""

    duration: Annotated[
        float | None,
        typer.Option(metavar="TIME", help="How long the motion takes; by default 1, or as short as rates allow."),
    ] = None
    timed: Annotated[
        bool, typer.Option("--timed", help="Pass the way as fast as rates and accelerations of the file allow.")
    ] = False
    blend: Annotated[
        float | None,
        typer.Option(metavar="LENGTH", help="With --timed: round corners by that much, instead of stopping in each."),
    ] = None

    def check(self) -> None:
        """Refuse what cannot be meant.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous import checks  # noqa: PLC0415

        if self.duration is not None:
            checks.number("--duration", self.duration, above=0.0)
            if self.timed:
                raise InputError(
                    "--duration", "cannot be combined with --timed", self.duration, "one of --duration, --timed"
                )
        if self.blend is not None:
            checks.number("--blend", self.blend, above=0.0)
            if not self.timed:
                raise InputError("--blend", "is for --timed", self.blend, "--timed, too")


def with_groups(command: Callable[..., int]) -> Callable[..., None]:
    """Return a command for Typer that takes each option of its groups as an option of its own, and exits.

    A group is a parameter of `command` whose type is a dataclass; its fields are declared as options.
    """
    own = inspect.signature(command).parameters
    groups: dict[str, Any] = {name: each.annotation for name, each in own.items() if is_dataclass(each.annotation)}
    flat: list[inspect.Parameter] = []
    for name, each in own.items():
        options = [(f.name, f.type, f.default) for f in fields(groups[name])] if name in groups else []
        options = options or [(name, each.annotation, each.default)]
        flat += [inspect.Parameter(n, each.KEYWORD_ONLY, annotation=a, default=d) for n, a, d in options]

    def run(**typed: Any) -> None:
        made = {name: group(**{f.name: typed.pop(f.name) for f in fields(group)}) for name, group in groups.items()}
        raise typer.Exit(command(**typed, **made))

    run.__name__, run.__doc__ = command.__name__, command.__doc__
    run.__annotations__ = {each.name: each.annotation for each in flat}
    run.__signature__ = inspect.Signature(flat)  # type: ignore[attr-defined]
    return run


def read_demands(clearance: str | None, self_clearance: str | None) -> dict[str, Any]:
    """Read what `--clearance` and `--self-clearance` say: a number, or some with commas between them, or with names.

    Raises
    ------
    InputError
        That names the option.
    """
    return {
        key: None if typed is None else _one_or_some(option, typed)
        for key, option, typed in (
            ("clearance", "--clearance", clearance),
            ("self_clearance", "--self-clearance", self_clearance),
        )
    }


def _one_or_some(option: str, typed: str) -> float | tuple[float, ...] | dict[str, float]:
    from sinuous import checks  # noqa: PLC0415

    wanted = "a number of at least 0, or one a segment, as 1,1,2, or by names, as wrist=2,s1=1"
    parts = [part.rpartition("=") for part in typed.split(",")]
    names = [name.strip() for name, _, _ in parts if name.strip()]
    try:
        numbers = [float(number) for _, _, number in parts]
    except ValueError:
        raise InputError(option, "", typed, wanted) from None
    checked = tuple(checks.number(option, each, low=0.0) for each in numbers)
    if len({*names}) not in (0, len(checked)):
        raise InputError(option, "", typed, wanted)
    return dict(zip(names, checked, strict=True)) if names else checked[0] if len(checked) == 1 else checked


@contextmanager
def as_typed(*names: str) -> Iterator[None]:
    """Name the option in the place of the argument of this name, where one of these is refused."""
    try:
        yield
    except InputError as error:
        if error.key not in names or error.file is not None:
            raise
        option = "--" + error.key.replace("_", "-")
        raise InputError(option, error.problem, error.value, error.expected) from None


def is_page(file: Path) -> bool:
    """Whether a picture is to be a page that can be turned."""
    return file.suffix.lower() == ".html"


def numbered(file: Path | None, number: int, files: int) -> Path | None:
    """Where what comes of problem `number`, 1 = first, of `files` goes: several are numbered."""
    if file is None or files == 1:
        return file
    width = int(math.log10(files)) + 1
    return file.with_name(f"{file.stem}-{number:0{width}}{file.suffix}")


def check_outputs(inputs: Sequence[str], **outputs: Path | None) -> None:
    """Refuse files of options of these names that cannot be written, or are among the `inputs`."""
    for name, file in outputs.items():
        if file is not None:
            check_writable(f"--{name}", file, inputs)


def check_writable(option: str, file: Path, inputs: Sequence[str] = ()) -> None:
    """Refuse a file that cannot be written, or is one of the `inputs`; a file that was not there still is not."""
    if str(file) == "-":
        raise InputError(option, "is no file", "-", "the name of a file")
    if any(Path(name).resolve() == file.resolve() for name in inputs):
        raise InputError(option, "would overwrite a problem file", str(file), "another file")
    there = file.exists()
    with written(file, option):
        with file.open("ab"):
            pass
        if not there:
            file.unlink()
