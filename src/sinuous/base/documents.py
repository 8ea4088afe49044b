"""Nouns as plain values, and these as a document: YAML that a person likes to read, or JSON; arrays as NPZ.

The plain values of a noun are the arguments that make an equal one.
"""

import csv
import inspect
import json
import math
import os
import platform
import re
import threading
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ElementTree, indent

import numpy as np

from sinuous.base.checks import Floats, readable, written
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen

ENDINGS = (".yaml", ".yml", ".json")
"""How files of documents are called."""

WIDTH = 120
"""Lists and mappings stand on one line up to this many letters."""

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)*")
_WORDS = frozenset({"null", "true", "false", "yes", "no", "on", "off", "y", "n"})
"""Texts that some version of YAML takes for something else."""


@contextmanager
def draft_of(file: Path) -> Iterator[Path]:
    """Yield another name, to be written within; the file gets its own name when that succeeds.

    No two threads or processes write the same draft, also not on different machines.
    """
    own = f"{platform.node()}-{os.getpid()}-{threading.get_ident()}"
    draft = file.with_name(f".{file.stem}.{own}{file.suffix}")
    try:
        yield draft
        draft.replace(file)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


def write_table(file: str | Path, header: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a table as CSV; what is not known (`None`) is an empty cell.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with written(file), Path(file).open("w", encoding="utf-8", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


def write_xml(file: str | Path, root: Element) -> None:
    """Write an element as a document of XML, indented. A file that is there is replaced.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    tree = ElementTree(root)
    indent(tree)
    with written(file):
        tree.write(Path(file), encoding="utf-8", xml_declaration=True)


def write_document(file: str | Path, values: Any) -> None:
    """Write plain values: as JSON when the file is called so, as YAML otherwise. A file that is there is replaced.

    Raises
    ------
    InputError
        When the name of the file has another ending than `ENDINGS`, it cannot be written, or a text has no form in
        UTF-8.
    """
    path = Path(file)
    if path.suffix and path.suffix.lower() not in ENDINGS:
        raise InputError("file", "its ending names no format of documents", str(file), "one of " + ", ".join(ENDINGS))
    text = json.dumps(values, indent=1) + "\n" if path.suffix.lower() == ".json" else yaml_text(values)
    try:
        data = text.encode()
    except UnicodeEncodeError as error:
        raise InputError("file", "a name in it has no form in UTF-8", error.object, "texts in UTF-8") from None
    with written(file):
        path.write_bytes(data)


def yaml_text(values: Any) -> str:
    """Write plain values as YAML, which reads the same by YAML 1.1 and 1.2.

    PyYAML's dumper in C, told to put what is short on one line, takes 2.6 times as long for 20,000 waypoints.
    """
    lines = _block(values, "") if isinstance(values, dict | list) and values else [_flow(values)]
    return "\n".join(lines) + "\n"


def _block(value: Any, indent: str) -> Iterator[str]:
    """Yield the lines of a mapping or list that stands on several."""
    entries = value.items() if isinstance(value, dict) else ((None, entry) for entry in value)
    for key, entry in entries:
        front = f"{indent}- " if key is None else f"{indent}{_scalar(key)}: "
        line = front + _flow(entry)
        if not entry or not isinstance(entry, dict | list) or len(line) <= WIDTH:
            yield line
        elif key is None:
            first, *rest = _block(entry, indent + "  ")
            yield front + first.lstrip(" ")
            yield from rest
        else:
            yield front.rstrip()
            yield from _block(entry, indent + "  ")


def _flow(value: Any) -> str:
    """Write a value on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_scalar(key)}: {_flow(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return json.dumps(value)
    if isinstance(value, float):
        text = repr(value)  # with a point, without which YAML 1.1 takes 1e-05 for a text
        return text if "." in text or "e" not in text else text.replace("e", ".0e")
    if not isinstance(value, str):
        return str(value)
    if _PLAIN.fullmatch(value) and value.lower() not in _WORDS:
        return value
    return '"' + "".join(_letter(letter) for letter in value) + '"'


def _letter(letter: str) -> str:
    """Write a letter of a quoted text; those that YAML would fold or refuse are escaped."""
    if letter in '"\\':
        return "\\" + letter
    code = ord(letter)
    if letter.isprintable() or 0xD800 <= code <= 0xDFFF:  # half of a letter is no text, and will be refused
        return letter
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def write_archive(file: str | Path, *, compressed: bool = False, **arrays: Any) -> None:
    """Write arrays by their names, perhaps compressed: a file that was there stays until the new one is complete.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    path = Path(file)
    with written(path), draft_of(path) as draft, draft.open("wb") as out:
        (np.savez_compressed if compressed else np.savez)(out, **arrays)


@contextmanager
def read_archive(file: str | Path, key: str, versions: tuple[int, ...], what: str) -> Iterator[Any]:
    """Open an archive that holds under `key` one of these versions, the newest last.

    What is wrong with what it holds, as it turns out within, is said under that key, too.

    Raises
    ------
    InputError
        When it is not `what` is expected.
    """
    with readable(file, key), Path(file).open("rb") as stream:
        if not zipfile.is_zipfile(stream) or f"{key}.npy" not in zipfile.ZipFile(stream).namelist():
            raise InputError(key, "damaged, or another kind of file", str(file), what)
        try:
            stream.seek(0)
            with np.load(stream) as data:
                version = int(data[key])
                if version in versions:
                    yield data
                    return
        except Exception as error:  # a damaged archive raises errors of zipfile, zlib, numpy, json
            raise InputError(key, f"damaged: {error}", str(file), what) from None
    raise InputError(key, "of another version", version, f"{versions[-1]}; make it anew: {what}", str(file))


MOST_WHOLE = 2**53
"""Below this, floats without a fraction are written as whole numbers."""


def described(noun: Frozen) -> dict[str, Any]:
    """Return the arguments of a noun's constructor as plain values, without those that have their defaults.

    The value of an argument is the attribute of the same name, or the one that `Frozen._arguments` names.
    """
    result = {}
    for name, parameter in inspect.signature(type(noun)).parameters.items():
        value = getattr(noun, noun._arguments.get(name, name), None)
        value = _TURNS[name](value) if name in _TURNS and name not in noun._asked else plain(value)
        default = None if parameter.default is parameter.empty else plain(parameter.default)
        nothing = value is None or (value == [] and default is None)
        if not nothing and value != default:
            result[name] = value
    return result


def plain(value: Any) -> Any:
    """Return a value as dict, list, str, int, float, bool or None; what says nothing (no limit) is None."""
    if isinstance(value, Frozen):
        return described(value)
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, tuple | list):
        return _listed([plain(entry) for entry in value])
    if isinstance(value, float):
        return _number(value)
    return value


def _number(value: float) -> int | float | None:
    if math.isinf(value):
        return None
    signed_zero = value == 0.0 and math.copysign(1.0, value) < 0.0
    return int(value) if value.is_integer() and abs(value) < MOST_WHOLE and not signed_zero else value


def _listed(entries: list[Any]) -> list[Any] | None:
    return None if entries and all(entry is None for entry in entries) else entries


def result_of(found: object, names: str) -> dict[str, Any]:
    """Return what a result says under these names, separated by blanks: attributes as plain values, in this order."""
    return {name: result_value(getattr(found, name)) for name in names.split()}


def result_value(value: Any) -> Any:
    """Return a value as dict, list, str, int, finite float, bool and None; a number that is not finite is None.

    Results have a `to_dict`; of tuples with names, and of data classes, it is a mapping of their fields.
    """
    if value is None or isinstance(value, int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, np.ndarray):
        own = value.tolist()
        return own if value.dtype.kind in "bi" or np.isfinite(value).all() else result_value(own)
    return _result_of_several(value)


def _result_of_several(value: Any) -> Any:
    """The same of what holds other values, or of a number of NumPy."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if is_dataclass(value) or hasattr(value, "_asdict"):
        value = vars(value) if is_dataclass(value) else value._asdict()
    if isinstance(value, Mapping):
        return {str(key): result_value(entry) for key, entry in value.items()}
    if isinstance(value, np.generic):
        return result_value(value.item())
    return [result_value(entry) for entry in value] if isinstance(value, list | tuple) else value


def pose_arguments(pose: Floats) -> dict[str, Any] | None:
    """Write a pose (4, 4) as `position` and `rotation`, without those that change nothing; None without both."""
    parts = {"position": plain(pose[:3, 3]) if pose[:3, 3].any() else None, "rotation": _rotation(pose[:3, :3])}
    return {key: value for key, value in parts.items() if value is not None} or None


def _rotation(matrix: Floats | None) -> Any:
    return None if matrix is None or np.array_equal(matrix, np.eye(3)) else plain(matrix)


_TURNS: dict[str, Callable[[Any], Any]] = {"rotation": _rotation, "base": pose_arguments, "tool": pose_arguments}
"""Arguments that are a rotation or a pose."""


def counted(parts: list[dict[str, Any]]) -> dict[str, Any] | list[dict[str, Any]]:
    """Put equal neighbours together, with their `count`; a single entry stands alone."""
    runs: list[tuple[int, dict[str, Any]]] = []
    for part in parts:
        if runs and runs[-1][1] == part:
            runs[-1] = runs[-1][0] + 1, part
        else:
            runs.append((1, part))
    listed = [part if count == 1 else {"count": count, **part} for count, part in runs]
    return listed[0] if len(listed) == 1 else listed
