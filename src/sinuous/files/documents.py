"""Files of plain values: UTF-8 text, the part of YAML 1.2 that says what JSON says, and JSON.

PyYAML's parser gives the events. What they mean is decided here, because PyYAML's own constructors follow YAML 1.1,
where `1e-3` is a text, `010` is eight and `no` is false. There are no tags, so that nothing can be executed, and the
number of values that aliases stand for is bounded.

Why not ruamel.yaml, which follows YAML 1.2: it lets aliases multiply without a bound, merges keys (`<<`), makes dates
of `2001-01-01` and numbers of `0x10` and `1_000`, allows keys that are no names, and names a duplicate key without its
place among the others; each of these would need code here again. Its constructors in C take 11 times as long as this
module for a path of 20,000 waypoints, those in Python 27 times (ruamel.yaml 0.19.1 against PyYAML 6.0.4 with libyaml).
Why not PyYAML's composer, whose nodes are read by the same rules: it refuses an anchor that is given twice, which YAML
allows, takes a fifth longer for that path, and saves 24 lines here.
"""

import json
import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import yaml

from sinuous.base import checks
from sinuous.base.checks import readable
from sinuous.base.documents import result_value
from sinuous.base.errors import InputError, shown
from sinuous.base.text_tables import NUMBERS

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # in C where PyYAML has it; only its parser is used

_WORDS = {"": None, "~": None} | {
    form: value
    for word, value in (("null", None), ("true", True), ("false", False))
    for form in (word, word.capitalize(), word.upper())
}
_WHOLE = re.compile(r"[-+]?[0-9]+")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF|nan|NaN|NAN)")

_DEEP = "exceeded maximum nesting depth"
"""What recent versions of libyaml say where values stand too deeply in one another."""

_UNCLOSED = ("did not find expected node content", "did not find expected ','", "found unexpected end of stream")
"""How libyaml begins to say, at the end of a text, that something is still open."""

MOST_REPEATED = 100_000
"""Values that all aliases of a document may stand for together: nested aliases multiply."""

Place = tuple[Any, ...]
"""Where a value stands: `()`, or the place of what it stands in, and its name or number there."""


def parse_yaml(text: str) -> Any:
    """Read one YAML document; `None` when there is none.

    Values that an alias stands for are the same objects as those of its anchor; nobody may change them.

    Raises
    ------
    InputError
        With the number of the line when it is no YAML, uses a tag, or has aliases that cannot be meant; with the key
        when it stands twice or its number is not finite.
    """
    with refuse_deep(text):
        try:
            values = _Document(iter(_LOADER(text).get_event, None)).values()
        except yaml.MarkedYAMLError as error:
            if _DEEP in (error.problem or ""):
                raise RecursionError from None
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            problem = error.problem or "cannot be read"
            open_at_end = line > len(text.splitlines()) and problem.startswith(_UNCLOSED)
            refuse_line(text, line, "a list, mapping or quotation is not closed" if open_at_end else problem, "YAML")
        except yaml.YAMLError as error:
            reason = getattr(error, "reason", "cannot be read")
            raise InputError("file", str(reason), text, "YAML") from None
        refuse_infinite(values)
    return values


class _Document:
    """Makes values of the events of a parser."""

    def __init__(self, events: Iterator[Any]) -> None:
        self._events = events
        self._anchors: dict[str, tuple[Any, int]] = {}  # the value of each, and how many values are in it
        self._open: set[str] = set()
        self._made = self._repeated = 0

    def values(self) -> Any:
        next(self._events)
        if isinstance(next(self._events), yaml.StreamEndEvent):
            return None
        value = self._value((), next(self._events))
        next(self._events)
        after = next(self._events)
        if not isinstance(after, yaml.StreamEndEvent):
            raise InputError(_line(after), "starts another document", "---", "one document")
        return value

    def _value(self, place: Place, event: Any) -> Any:
        if isinstance(event, yaml.AliasEvent):
            return self._again(event)
        if event.tag is not None:
            raise InputError(_line(event), "has a tag", event.tag, "plain values")
        before = self._made
        self._made += 1
        if event.anchor is None:
            return self._own_value(place, event)
        self._open.add(event.anchor)
        value = self._own_value(place, event)
        self._open.discard(event.anchor)
        self._anchors[event.anchor] = value, self._made - before
        return value

    def _again(self, event: Any) -> Any:
        """Return the value that an alias stands for."""
        name = event.anchor
        if name in self._open:
            raise InputError(
                _line(event), "is an alias of what it is part of", f"*{name}", "an alias of a finished value"
            )
        if name not in self._anchors:
            raise InputError(_line(event), "has no anchor", f"*{name}", "an alias of an anchor above it")
        value, size = self._anchors[name]
        self._made += size
        self._repeated += size
        if self._repeated > MOST_REPEATED:
            raise InputError(_line(event), "aliases multiply", f"*{name}", f"at most {MOST_REPEATED} repeated values")
        return value

    def _own_value(self, place: Place, event: Any) -> Any:
        if isinstance(event, yaml.ScalarEvent):
            return _scalar(event.value) if event.implicit[0] else event.value
        return self._sequence(place) if isinstance(event, yaml.SequenceStartEvent) else self._mapping(place)

    def _sequence(self, place: Place) -> list[Any]:
        result: list[Any] = []
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            result.append(self._value((place, len(result)), event))
        return result

    def _mapping(self, place: Place) -> dict[str, Any]:
        result: dict[str, Any] = {}
        for event in self._events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            if not isinstance(event, yaml.ScalarEvent):
                raise InputError(_line(event), "has a key that is no name", _key(place), "a name")
            name, inner = event.value, (place, event.value)
            value = self._value(inner, next(self._events))
            if name in result:
                raise InputError(_key(inner), "stands twice", value, "every key once")
            result[name] = value
        return result


def _scalar(text: str) -> Any:
    """Read a plain scalar; a number that is not finite is kept, to be refused under its key."""
    if text in _WORDS:
        return _WORDS[text]
    if _WHOLE.fullmatch(text):
        return whole_number(text)
    if NUMBERS["."].fullmatch(text):
        return float(text)
    return float(text.replace(".", "")) if _NOT_FINITE.fullmatch(text) else text


def _key(place: Place) -> str:
    return join(_key(place[0]), place[1]) if place else ""


def _line(event: Any) -> str:
    return f"line {event.start_mark.line + 1}"


MOST_DIGITS = 400


def read_text(file: Path, key: str = "file", expected: str = "a text file in UTF-8") -> str:
    """Return the text of a file in UTF-8, without a byte order mark.

    Raises
    ------
    InputError
        For `key`, when the file is not there, not readable, or not UTF-8.
    """
    with readable(file, key):
        content = file.read_bytes()
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(key, f"not UTF-8 at byte {error.start}", str(file), expected) from None


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


def json_line(result: dict[str, Any]) -> str:
    """Return one result as one line, without a line break; numbers that are not finite become null."""
    try:
        return json.dumps(result, allow_nan=False, default=result_value)
    except ValueError:  # some number is not finite
        return json.dumps(result_value(result), allow_nan=False)


def result(file: str, answer: dict[str, Any], prepare_seconds: float) -> dict[str, Any]:
    """Put the name of the problem file in front of an answer, and the time of preparing after the time of solving.

    Remedies, where there are any, stand behind what they are remedies of.
    """
    answer = dict(answer)
    remedies = {"remedies": answer.pop("remedies")} if "remedies" in answer else {}
    entries: dict[str, Any] = {"file": file}
    for key, value in answer.items():
        entries[key] = value
        if key == "binding":
            entries.update(remedies)
        if key == "seconds":
            entries["prepare_seconds"] = prepare_seconds
    return entries


def read_results(file: Path) -> list[tuple[int, dict[str, Any]]]:
    """Read the results in a file, each with the number of its line.

    Raises
    ------
    InputError
        When it cannot be read, holds no result, or a line is no JSON object.
    """
    lines = [(i, line) for i, line in enumerate(read_text(file).splitlines(), 1) if line.strip()]
    results = []
    for number, line in lines:
        with checks.inside(f"line {number}"):
            values = parse_json(line)
            checks.instance("", values, dict, "a result")
        results.append((number, values))
    if not results:
        raise InputError("file", "is empty", str(file), "results, one a line")
    return results
