"""Options of the command line: each is declared once, as a field of a command or of a group that commands have.

Nothing heavy is imported here, so that `sinuous --help` answers at once.
"""

import inspect
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from sinuous.base.errors import InputError

if TYPE_CHECKING:
    from sinuous.methods.method import Choice
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

REQUIRED: Any = MISSING
"""In the place of a default: it has to be typed."""

Asked = TypeVar("Asked")


def methods_like(begun: str) -> list[str]:
    """Return names of methods, for the shell to complete one."""
    from sinuous.methods.method import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(begun)]


def opt(help: str, metavar: str | None = None, default: Any = None, **look: Any) -> Any:
    """Return a field of a command, or of a group of one, that is typed as an option of its name."""
    return field(default=default, metadata={"of": typer.Option, "help": help, "metavar": metavar, **look})


def flag(help: str) -> Any:
    """Return a field that is true where its name is typed; nothing is typed to deny it."""
    return opt(help, default=False, flag=True)


def argument(help: str, metavar: str | None = "FILE", **look: Any) -> Any:
    """Return a field that is typed without its name, in the order of the fields."""
    return opt(help, metavar, REQUIRED, **{"of": typer.Argument, "show_default": False, **look})


FILES, PLACE = "Problem files, YAML or JSON.", "A problem file; its targets are not used."
JSON = "Print one JSON object a line, and nothing else."
STARTS, WORKERS = "Most starts of one solve.", "Number of threads or processes; by default one per core."
COLUMNS = "Which columns of {} follow {}, in this order; by default all."
ROUTES = "Search for routes through free space where the first starts fail."
REMEMBERED = "Memory of earlier commands: solves begin from its shapes, and add theirs."
"""What is said of options that several commands have."""


@dataclass(frozen=True, kw_only=True)
class Demands:
    """Clearances that are demanded."""

    clearance: str | None = opt(
        "Least distance of the body from obstacles, in the unit of the file; or one per segment: 1,1,2 or wrist=2. By "
        "default that of the file.",
        "LENGTH",
    )
    self_clearance: str | None = opt("Least distance of the body from itself, given in the same way.", "LENGTH")

    def read(self) -> dict[str, Any]:
        """Return them as arguments: a number, or one for each segment, or some by names.

        Raises
        ------
        InputError
            That names the option.
        """
        said = {"clearance": self.clearance, "self_clearance": self.self_clearance}
        return {key: None if own is None else _one_or_some(_typed(key), own) for key, own in said.items()}


@dataclass(frozen=True, kw_only=True)
class Solving:
    """How solves are done."""

    method: str = opt(
        "Algorithm: newton (our own), or a method of the literature, such as dls or fabrikc.",
        default="newton",
        autocompletion=methods_like,
    )
    option: list[str] | None = opt("An option of the algorithm; may be repeated.", "KEY=VALUE")
    time: float = opt("Most time for one solve.", "SECONDS", 1.0)
    max_starts: int | None = opt("Most starts of one solve; by default as many as the time allows.", "COUNT")
    routes: bool = opt(ROUTES, default=True)
    seed: int = opt("Seed of the random starts; the same seed gives the same answer.", default=0)
    demanded: Demands

    def arguments(self, tolerance: "Tolerance | None" = None, prefer: "Preferences | None" = None) -> dict[str, Any]:
        """Return the options of `Solver`, with what the problem file says.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.solver.options import SolveOptions  # noqa: PLC0415

        typed = {key: getattr(self, key) for key in ("time", "max_starts", "routes", "seed")} | self.demands
        with as_typed(*typed):
            return vars(SolveOptions.of({"method": self.choice(), "tolerance": tolerance, "prefer": prefer, **typed}))

    @property
    def demands(self) -> dict[str, Any]:
        """Clearances that are demanded, as arguments."""
        return self.demanded.read()

    def choice(self) -> "Choice":
        """Return the method with its options.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.base.errors import suggested  # noqa: PLC0415
        from sinuous.methods.method import METHODS, with_options  # noqa: PLC0415

        if self.method not in METHODS:
            known = suggested(self.method, METHODS)
            raise InputError("--method", f"unknown method {self.method!r}", self.method, known)
        try:
            return with_options(self.method, tuple(self.option or ()))
        except InputError as error:
            raise InputError(f"--option {error.key}".rstrip(), error.problem, error.value, error.expected) from None


@dataclass(frozen=True, kw_only=True)
class Remembering(Solving):
    """How solves are done that begin from shapes of earlier ones."""

    memory: Path | None = opt(REMEMBERED, "FILE")


@dataclass(frozen=True, kw_only=True)
class PlanSolving(Remembering):
    """How a plan is solved."""

    time: float = opt("Most time for one plan.", "SECONDS", 5.0)


@dataclass(frozen=True, kw_only=True)
class BatchSolving(Solving):
    """How each target of a batch is solved."""

    max_starts: int = opt(STARTS, "COUNT", 100)
    time: float = opt("Most time for one target.", "SECONDS", 0.1)
    memory: Path | None = opt("Memory of earlier commands: solves begin from its shapes; nothing is added.", "FILE")


@dataclass(frozen=True, kw_only=True)
class ExploreSolving(Solving):
    """How positions are solved while a place is explored."""

    max_starts: int = opt("Most starts for one position.", "COUNT", 24)
    time: float = opt("Time for the whole exploration.", "SECONDS", 60.0)


@dataclass(frozen=True, kw_only=True)
class DesignSolving(Solving):
    """How each target of a task is solved."""

    max_starts: int = opt(STARTS, "COUNT", 24)


@dataclass(frozen=True, kw_only=True)
class MapSolving(Solving):
    """How each direction of a map is solved."""

    max_starts: int = opt(STARTS, "COUNT", 1)
    routes: bool = opt(ROUTES, default=False)


@dataclass(frozen=True, kw_only=True)
class Working:
    """Who works on what takes long."""

    engine: str = opt("Run on threads or processes of this machine.", default="threads")
    dask: str | None = opt(
        "Run on the workers of this Dask scheduler instead; local starts some on this machine.", "ADDRESS"
    )
    workers: int | None = opt(WORKERS, "COUNT")

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


def names_in(typed: str | None) -> list[str] | None:
    """Names that were typed with commas between them."""
    return None if typed is None else [name.strip() for name in typed.split(",")]


@dataclass(frozen=True, kw_only=True)
class Output:
    """Where answers go."""

    json: bool = flag(JSON)
    plot: Path | None = opt(
        "Draw the answer: .png, .svg or .pdf; .gif or .mp4 for a motion; .html to turn it. Several are numbered.",
        "FILE",
    )
    out: Path | None = opt("Write the results as JSON lines.", "FILE")
    csv: Path | None = opt("Write configurations and actuators as a table. Several are numbered.", "FILE")
    columns: str | None = opt(COLUMNS.format("--csv", "the first"), "NAME,...")

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
        if self.columns is not None and self.csv is None:
            raise InputError("--columns", "is for --csv", self.columns, "--csv FILE, too")
        if self.plot is not None and is_page(self.plot):
            from sinuous.view.page.show import check_page  # noqa: PLC0415

            check_page("--plot", self.plot)
        elif self.plot is not None:
            from sinuous.view.pictures.figures import MOVIES, check_picture  # noqa: PLC0415

            check_picture("--plot", self.plot, others=(*MOVIES, "html"))


@dataclass(frozen=True, kw_only=True)
class MotionOutput(Output):
    """Where motions go."""

    rate: float | None = opt("Rows of --csv per unit of time; by default one per computed configuration.", "HZ")

    def check(self, files: list[str]) -> None:
        """See `Output.check`."""
        if self.rate is not None:
            from sinuous.base import checks  # noqa: PLC0415

            checks.number("--rate", self.rate, above=0.0)
            if self.csv is None:
                raise InputError("--rate", "is for --csv", self.rate, "--csv FILE, too")
        super().check(files)


@dataclass(frozen=True, kw_only=True)
class Timed:
    """In which times a motion is passed."""

    duration: float | None = opt(
        "How long the motion takes; by default as short as rates of the file allow, else 1, or 1 per waypoint.", "TIME"
    )
    timed: bool = flag("Move as fast as the rates and accelerations of the file allow.")
    blend: float | None = opt(
        "With --timed: round corners by at most this distance, instead of stopping at each.", "LENGTH"
    )

    def check(self) -> None:
        """Refuse what cannot be meant.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.base import checks  # noqa: PLC0415

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


def for_typer(asked: type[Asked], answer: Callable[[Asked], int]) -> Callable[..., None]:
    """Return a command for Typer, which exits: its options are the fields of a dataclass, and of dataclasses in it."""
    own = {each.name: each for each in _fields(asked)}
    flat = []
    for name, each in own.items():
        look = dict(each.metadata)
        names = [_typed(name)] if look.pop("flag", False) else []
        shown = look.pop("of")(... if each.default is REQUIRED else each.default, *names, **look)
        flat.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=each.type, default=shown))

    def run(**given: Any) -> None:
        raise typer.Exit(answer(_made(asked, given)))

    run.__doc__ = asked.__doc__
    run.__annotations__ = {each.name: each.annotation for each in flat}
    run.__signature__ = inspect.Signature(flat)  # type: ignore[attr-defined]
    return run


def _fields(asked: Any) -> "Iterator[Field[Any]]":
    for each in fields(asked):
        yield from _fields(each.type) if is_dataclass(each.type) else (each,)


def _made(asked: Any, given: dict[str, Any]) -> Any:
    return asked(**{f.name: _made(f.type, given) if is_dataclass(f.type) else given[f.name] for f in fields(asked)})


def _typed(name: str) -> str:
    return "--" + name.replace("_", "-")


def _one_or_some(option: str, typed: str) -> float | tuple[float, ...] | dict[str, float]:
    from sinuous.base import checks  # noqa: PLC0415

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
        raise InputError(_typed(error.key), error.problem, error.value, error.expected) from None


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
    from sinuous.base.checks import written  # noqa: PLC0415  # with NumPy, which help does without

    with written(file, option):
        with file.open("ab"):
            pass
        if not there:
            file.unlink()
