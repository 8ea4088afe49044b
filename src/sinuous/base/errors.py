"""What goes wrong, in words: wrong or suspicious input, and a solve that did not reach its target."""

import re
import reprlib
import sys
import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol, Self

if TYPE_CHECKING:  # numpy takes long to import, and `sinuous --help` does without it
    import numpy as np
    from numpy.typing import NDArray

GUESS = "did you mean "
"""How a refusal begins to say what is meant, in the place of what was expected."""

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 60
_SHORT.maxlist = _SHORT.maxtuple = 6


def shown(value: object) -> str:
    """Text of a value, short enough for one line."""
    try:
        return " ".join(_SHORT.repr(value).split())
    except ValueError:  # whole numbers of more than 4300 digits have no text
        return f"{type(value).__name__} without a text"


class InputError(ValueError):
    """Input that cannot be meant, in one line: `KEY: PROBLEM; expected EXPECTED, got VALUE`.

    In front stands the file that holds the key, when it came from one. The problem is left out where the rest says it;
    of a name that is not known, the one that is meant may be what was expected: `did you mean 'length'?`.

    Attributes
    ----------
    key : str
        Where the value stands, like `segments[2].length`.
    problem : str
        What is wrong; empty where the value and what was expected say it.
    value : object
        The value as it was given.
    expected : str
        What would have been right.
    file : str or None
        The file that holds the key, when it came from one.
    """

    def __init__(self, key: str, problem: str, value: object, expected: str, file: str | None = None) -> None:
        place = key if file is None else f"{file}: {key}"
        wrong = f"{problem}; " if problem else ""
        right = expected if expected.startswith(GUESS) else f"expected {expected}, got {shown(value)}"
        super().__init__(f"{place}: {wrong}{right}")
        self.key = key
        self.problem = problem
        self.value: Any = value
        self.expected = expected
        self.file = file

    def within(self, outer: str) -> Self:
        """Return the same error, seen from the key that contains this one; a file's keys stay that file's."""
        if self.file is not None or not outer:
            return self
        inner = self.key if self.key.startswith("[") or not self.key else f".{self.key}"
        return type(self)(f"{outer}{inner}", self.problem, self.value, self.expected)

    def in_file(self, file: object) -> Self:
        """Return the same error with the name of the file it is in, unless it names one already."""
        if self.file is not None:
            return self
        return type(self)(self.key, self.problem, self.value, self.expected, str(file))

    @property
    def row(self) -> tuple[str, int] | None:
        """Of which array a row is refused, and which one, 0 = first, where it is one: the key `positions[3]`."""
        found = re.fullmatch(r"(\w+)\[(\d+)\]", self.key)
        return None if found is None else (found[1], int(found[2]))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.key, self.problem, self.value, self.expected, self.file)


class UnknownOptionError(InputError, TypeError):
    """An argument that a function does not have: for Python a `TypeError`, and said in the same line as in a file."""


class SuspiciousInput(UserWarning):
    """Input that can be meant, but hardly is. Nothing is changed for it."""


def warn_of(texts: Iterable[str]) -> None:
    """Give every text to Python's `warnings`, which by default shows each once."""
    for text in texts:
        warnings.warn(text, SuspiciousInput, stacklevel=_level())


def _level() -> int:
    """How far up the first function is that is not of this package: the one that a warning is for."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "sinuous":
        level, frame = level + 1, frame.f_back
    return level


class Answer(Protocol):
    """What a `Solution` and a `Motion` have in common."""

    @property
    def status(self) -> str:
        """How it ended."""
        ...

    @property
    def solved(self) -> bool:
        """Whether the status is `solved`."""
        ...

    @property
    def q(self) -> "NDArray[np.float64]":
        """Configuration (n, 3), or configurations (T, n, 3)."""
        ...


class NotSolvedError(RuntimeError):
    """Raised by `raise_for_status()` of a solution or motion that is not solved, in one line; `solution` holds it."""

    def __init__(self, message: str, solution: Answer) -> None:
        super().__init__(message)
        self.solution = solution


class UnfinishedError(RuntimeError):
    """Raised when a batch cannot go on; its text is one line that says what happened, and what is kept."""
