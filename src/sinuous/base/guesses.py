"""Names that one guesses, answered by those that there are."""

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from sinuous.base.errors import InputError

Given = ParamSpec("Given")
Made = TypeVar("Made")
Kind = TypeVar("Kind")


def answers_guesses(**instead: str) -> Callable[[Callable[Given, Made]], Callable[Given, Made]]:
    """Let a function refuse arguments that it does not have, but that are often guessed: each says what is meant."""

    def around(function: Callable[Given, Made]) -> Callable[Given, Made]:
        @functools.wraps(function)
        def answering(*args: Given.args, **given: Given.kwargs) -> Made:
            for name in instead.keys() & given.keys():
                raise InputError(name, "there is no such argument", given[name], instead[name])
            return function(*args, **given)

        return answering

    return around


QUATERNION = "rotation=(w, x, y, z) or xyzw=(x, y, z, w), which say the order"
"""What a quaternion is called."""


def answers_attributes(**instead: str) -> Callable[[type[Kind]], type[Kind]]:
    """Let objects of a class say where that is which one guesses at them; type checkers see none of it."""

    def around(kind: type[Kind]) -> type[Kind]:
        def missing(self: Any, name: str) -> Any:
            hint = f"; see {instead[name]}" if name in instead else ""
            raise AttributeError(f"{kind.__name__!r} object has no attribute {name!r}{hint}", name=name, obj=self)

        kind.__getattr__ = missing  # type: ignore[attr-defined]
        return kind

    return around
