"""What goes wrong, in words: wrong input, and a solve that did not reach its target."""

import reprlib
from typing import Any


def shown(value: Any) -> str:
    """Text of a value, short enough for one line."""
    short = reprlib.Repr(maxstring=60, maxother=60, maxlist=6, maxtuple=6, maxdict=4)
    return " ".join(short.repr(value).split())


class InputError(ValueError):
    """Input that cannot be meant: names the key, the value and what was expected.

    Attributes
    ----------
    key : str
        Where the value stands, like `segments[2].length`.
    problem : str
        What is wrong.
    value : object
        The value as it was given.
    expected : str
        What would have been right.
    """

    def __init__(self, key: str, problem: str, value: Any, expected: str) -> None:
        super().__init__(f"{key}: {problem} (got {shown(value)}), expected {expected}")
        self.key = key
        self.problem = problem
        self.value = value
        self.expected = expected

    def within(self, outer: str) -> "InputError":
        """Return the same error, seen from the key that contains this one."""
        inner = self.key if self.key.startswith("[") or not self.key else f".{self.key}"
        return InputError(f"{outer}{inner}" if outer else self.key, self.problem, self.value, self.expected)

    def __reduce__(self) -> tuple[Any, ...]:
        return InputError, (self.key, self.problem, self.value, self.expected)


class NotSolvedError(RuntimeError):
    """Raised by `raise_for_status()` of a solution that is not solved; `solution` holds it."""

    def __init__(self, message: str, solution: Any) -> None:
        super().__init__(message)
        self.solution = solution
