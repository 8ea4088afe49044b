"""Attributes that one guesses, answered by what there is."""

from collections.abc import Callable
from typing import Any, TypeVar

Kind = TypeVar("Kind")


def answers_attributes(**instead: str) -> Callable[[type[Kind]], type[Kind]]:
    """Let objects of a class say where that is which one guesses at them; type checkers see none of it."""

    def around(kind: type[Kind]) -> type[Kind]:
        def missing(self: Any, name: str) -> Any:
            hint = f"; see {instead[name]}" if name in instead else ""
            raise AttributeError(f"{kind.__name__!r} object has no attribute {name!r}{hint}", name=name, obj=self)

        kind.__getattr__ = missing  # type: ignore[attr-defined]
        return kind

    return around
