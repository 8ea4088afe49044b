"""What the commands that solve have in common."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sinuous.errors import InputError

if TYPE_CHECKING:
    from sinuous.methods.registry import Choice
    from sinuous.problem.preferences import Preferences
    from sinuous.problem.target import Tolerance


@dataclass(frozen=True)
class Options:
    """The options of one call; `check` says what is wrong with them.

    Attributes
    ----------
    method : str
    options : tuple of str
        Options of the method, `KEY=VALUE` each.
    time : float
        Budget per solve, in seconds.
    max_starts : int
        Most starts of one solve.
    routes : bool
        Whether to search for routes through free space where the first starts fail.
    seed : int
    json : bool
        Results on standard output as JSON lines.
    plot : Path or None
        Where a picture goes.
    out : Path or None
        Where the results go as JSON lines.
    why : bool
        Whether to explain every answer.
    csv : Path or None
        Where configurations and the values of actuators go, as a table.
    rate : float or None
        Rows of that table of a motion, in a unit of time.
    """

    method: str = "newton"
    options: tuple[str, ...] = ()
    time: float = 1.0
    max_starts: int | None = None
    routes: bool = True
    seed: int = 0
    json: bool = False
    plot: Path | None = None
    out: Path | None = None
    why: bool = False
    csv: Path | None = None
    rate: float | None = None

    def check(self, files: list[str]) -> None:
        """Refuse values that cannot be meant, before any file is read or written.

        Raises
        ------
        InputError
            That names the option.
        """
        self.solve_options()
        if self.rate is not None:
            from sinuous import checks  # noqa: PLC0415

            checks.number("--rate", self.rate, above=0.0)
            if self.csv is None:
                raise InputError("--rate", "is for --csv", self.rate, "--csv FILE beside it")
        for option, file in (("--out", self.out), ("--plot", self.plot), ("--csv", self.csv)):
            if file is not None:
                check_writable(option, file, files)
        if self.plot is not None and is_page(self.plot):
            from sinuous.viewer.show import check_page  # noqa: PLC0415

            check_page("--plot", self.plot)
        elif self.plot is not None:
            from sinuous.pictures.files import check_picture  # noqa: PLC0415

            check_picture("--plot", self.plot)

    def solve_options(
        self, tolerance: "Tolerance | None" = None, prefer: "Preferences | None" = None
    ) -> dict[str, Any]:
        """Return the options of `Solver`, with what the problem file says.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.solving.options import SolveOptions  # noqa: PLC0415

        typed = {key: getattr(self, key) for key in ("time", "max_starts", "routes", "seed")}
        try:
            return vars(SolveOptions.of({"method": self.choice(), "tolerance": tolerance, "prefer": prefer, **typed}))
        except InputError as error:
            if error.key not in typed:
                raise
            option = "--" + error.key.replace("_", "-")
            raise InputError(option, error.problem, error.value, error.expected) from None

    def choice(self) -> "Choice":
        """Return the method with its options.

        Raises
        ------
        InputError
            That names the option.
        """
        from sinuous.methods import registry as methods  # noqa: PLC0415

        if self.method not in methods.METHODS:
            raise InputError("--method", "", self.method, "one of " + ", ".join(methods.METHODS))
        try:
            return methods.with_options(self.method, self.options)
        except InputError as error:
            raise InputError(f"--option {error.key}".rstrip(), error.problem, error.value, error.expected) from None


def is_page(file: Path) -> bool:
    """Whether a picture is to be a page that can be turned."""
    return file.suffix.lower() == ".html"


def numbered(file: Path | None, number: int, files: int) -> Path | None:
    """Where what comes of problem `number`, 1 = first, of `files` goes: several are numbered."""
    if file is None or files == 1:
        return file
    width = int(math.log10(files)) + 1
    return file.with_name(f"{file.stem}-{number:0{width}}{file.suffix}")


def check_writable(option: str, file: Path, inputs: Sequence[str] = ()) -> None:
    """Refuse a file that cannot be written, or is one of the `inputs`; a file that was not there still is not."""
    if any(Path(name).resolve() == file.resolve() for name in inputs):
        raise InputError(option, "would overwrite a problem file", str(file), "another file")
    there = file.exists()
    try:
        with file.open("ab"):
            pass
        if not there:
            file.unlink()
    except OSError as error:
        raise InputError(
            option, f"cannot be written: {error.strerror}", str(file), "a file that can be written"
        ) from None
