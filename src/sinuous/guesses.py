"""Names that one guesses, answered by those that there are."""

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from sinuous.errors import InputError

Given = ParamSpec("Given")
Made = TypeVar("Made")


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
