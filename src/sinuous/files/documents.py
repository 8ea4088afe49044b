"""Files of plain values, and the values of a problem file that may stand in a file of their own."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from sinuous import checks
from sinuous.errors import InputError
from sinuous.files.json_syntax import parse_json
from sinuous.files.text import read_text
from sinuous.files.yaml_syntax import parse_yaml

Noun = TypeVar("Noun")


def parse(text: str, file: Path) -> Any:
    """Read plain values from the text of a file: JSON when it is called so, YAML otherwise."""
    return parse_json(text) if file.suffix.lower() == ".json" else parse_yaml(text)


def read_part(key: str, value: Any, folder: Path, read: Callable[[Any, Path], Noun]) -> Noun:
    """Read what stands under `key`, or in the file that is named there.

    Parameters
    ----------
    key : str
    value : object
        Plain values, or the name of a file with them; no file may name another one in their place.
    folder : Path
        Where relative names of files begin.
    read : callable
        Makes a noun of the values and the folder of the file that they stand in.

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
    try:
        values = parse(text, file)
        if values is None or isinstance(values, str):
            raise InputError("file", "", values, f"what stands under {key}, not the name of another file")
        return read(values, file.parent)
    except InputError as error:
        raise error.in_file(file) from None
