"""JSON text to plain values, strictly: no key twice, every number finite."""

import json
from typing import Any

from sinuous.errors import InputError
from sinuous.files.text import join, refuse_deep, refuse_infinite, refuse_line, whole_number


def parse_json(text: str) -> Any:
    """Read one JSON document.

    Raises
    ------
    InputError
        With the number of the line when it is no JSON, with the key when it stands twice or its number is not finite.
    """
    with refuse_deep(text):
        try:
            values = json.loads(text, object_pairs_hook=_unique, parse_int=whole_number)
        except json.JSONDecodeError as error:
            refuse_line(text, error.lineno, error.msg, "JSON")
        refuse_infinite(values)
    return values


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for name, value in pairs:
        if name in result:
            raise InputError(join("", name), "stands twice", value, "every key once")
        result[name] = value
    return result
