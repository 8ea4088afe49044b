"""From a mapping to a noun: the parameters of the noun's constructor are the keys that may stand in the mapping."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any, TypeVar

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.base.words import suggested
from sinuous.files.documents import join

Noun = TypeVar("Noun")


def make(constructor: Callable[..., Noun], value: Any, parts: Mapping[str, Callable[[Any], Any]] | None = None) -> Noun:
    """Call `constructor` with the entries of the mapping `value` as arguments.

    Parameters
    ----------
    constructor : callable
        Its parameters are the keys; those without a default are required.
    value : object
        What the file says; only a mapping is right.
    parts : mapping of callables, optional
        For keys whose values are not plain: how to read them.

    Raises
    ------
    InputError
        When a key is unknown or missing, or when `constructor` or one of `parts` refuses a value.
    """
    entries = known_entries(value, *keys_of(constructor))
    for key, read in (parts or {}).items():
        if entries.get(key) is not None:
            with checks.inside(key):
                entries[key] = read(entries[key])
    return constructor(**entries)


def each(read: Callable[[Any], Noun], entries: Iterable[Any]) -> list[Noun]:
    """Read the entries of a list one after the other; a refusal names the place."""
    result = []
    for i, entry in enumerate(entries):
        with checks.inside(f"[{i}]"):
            result.append(read(entry))
    return result


@cache
def keys_of(constructor: Callable[..., Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of all parameters, and of those that have no default."""
    parameters = inspect.signature(constructor).parameters
    return tuple(parameters), tuple(name for name, p in parameters.items() if p.default is p.empty)


def known_entries(value: Any, known: Iterable[str], required: Iterable[str] = ()) -> dict[str, Any]:
    """Return a copy of a mapping that has all `required` keys and none that is not `known`."""
    names = tuple(known)
    if not isinstance(value, dict):
        raise InputError("", "", value, "a mapping with " + ", ".join(names))
    for key, entry in value.items():
        if key not in names:
            raise InputError(join("", key), "unknown key", entry, suggested(key, names))
    for key in required:
        if key not in value:
            raise InputError(key, "missing", value, "a value")
    return dict(value)
