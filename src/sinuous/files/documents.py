"""Files of plain values, JSON or YAML, and the values of a problem file that may stand in a file of their own."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from sinuous import checks
from sinuous.errors import InputError
from sinuous.files.text import join, read_text, refuse_deep, refuse_infinite, refuse_line, whole_number
from sinuous.files.yaml_syntax import parse_yaml

Noun = TypeVar("Noun")


def parse(text: str, file: Path) -> Any:
    """Read plain values from the text of a file: JSON when its name says so, YAML otherwise."""
    return parse_json(text) if file.suffix.lower() == ".json" else parse_yaml(text)


def read_values(file: str | Path) -> Any:
    """Read the plain values of a file.

    Raises
    ------
    InputError
        When it cannot be read, or is neither JSON nor YAML.
    """
    path = Path(file)
    return parse(read_text(path), path)


def parse_json(text: str) -> Any:
    """Read one JSON document.

    Raises
    ------
    InputError
        With the number of the line when the text is no JSON; with the key when it stands twice or its number is not
        finite.
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


def read_part(
    key: str,
    value: Any,
    folder: Path,
    read: Callable[[Any, Path], Noun],
    parse_file: Callable[[str, Path], Any] = parse,
) -> Noun:
    """Read what stands under `key`, or in the file that is named there.

    Parameters
    ----------
    key : str
    value : object
        Plain values, or the name of a file with them. That file may not name another one in their place.
    folder : Path
        Where relative names of files begin.
    read : callable
        Makes a noun of the values and of the folder of the file that they stand in.
    parse_file : callable
        Makes values of the text and the name of that file.

    Raises
    ------
    InputError
        With the name of the inner file, when it is wrong there.
    """
    if not isinstance(value, str):
        with checks.inside(key):
            return read(value, folder)
    file = folder / value
    text = read_text(file, key)  # a file that is not there is a fault of the key
    with checks.in_file(file):
        values = parse_file(text, file)
        if values is None or isinstance(values, str):
            raise InputError("file", "", values, f"what stands under {key}, not the name of another file")
        return read(values, file.parent)
