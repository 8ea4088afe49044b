"""What YAML, JSON and CSV have in common: UTF-8 text, decimal numbers, and plain values in one another."""

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from sinuous.errors import InputError, shown

NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
"""A decimal number: `1e-3` is one; `0x10`, `1_000` and `1:30` are not."""

MOST_DIGITS = 400


def read_text(file: Path, key: str = "file") -> str:
    """Return the text of a file in UTF-8, without a byte order mark.

    Raises
    ------
    InputError
        For `key`, when the file is not there, not readable, or not UTF-8.
    """
    try:
        return file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(key, f"not UTF-8 at byte {error.start}", str(file), "a text file in UTF-8") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(key, f"cannot be read: {reason}", str(file), "the name of a file that can be read") from None


def join(key: str, inner: str | int) -> str:
    """Path of what stands in `key` under a name or at a place: `scene[2].sphere`."""
    if isinstance(inner, int):
        return f"{key}[{inner}]"
    name = inner if inner.isidentifier() and len(inner) < 60 else shown(inner)
    return f"{key}.{name}" if key else name


def whole_number(text: str) -> int | float:
    """Read a whole number; one with absurdly many digits becomes infinite, to be refused as that."""
    return int(text) if len(text) <= MOST_DIGITS else float(text)


def refuse_infinite(value: Any) -> None:
    """Check that every number in plain values is finite; the refusal names its key."""
    if isinstance(value, float) and not math.isfinite(value):
        raise InputError("", "", value, "a finite number")
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for inner, entry in entries:
        if isinstance(entry, (dict, list)) or (isinstance(entry, float) and not math.isfinite(entry)):
            try:  # a key is put together for what is refused alone: a long path has a hundred thousand of them
                refuse_infinite(entry)
            except InputError as error:
                raise error.within(join("", inner)) from None


def refuse_line(text: str, line: int, reason: str, expected: str) -> NoReturn:
    """Refuse a text for what stands on one of its lines, 1 = first."""
    lines = text.splitlines()
    got = lines[line - 1].strip() if line <= len(lines) else "the end of the file"
    raise InputError(f"line {line}", reason, got, expected) from None


@contextmanager
def refuse_deep(text: str) -> Iterator[None]:
    """Refuse values that stand too deeply in one another for Python to follow."""
    try:
        yield
    except RecursionError:
        raise InputError("file", "is nested too deeply", text, "lists and mappings of a few levels") from None
