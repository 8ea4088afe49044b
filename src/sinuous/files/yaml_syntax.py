"""YAML text to plain values: the part of YAML 1.2 that says what JSON says.

PyYAML's parser gives the events. What they mean is decided here, because PyYAML's own constructors follow YAML 1.1,
where `1e-3` is a text, `010` is eight and `no` is false. There are no tags, so that nothing can be executed, and the
number of values that aliases stand for is bounded.

Why not ruamel.yaml, which follows YAML 1.2: it lets aliases multiply without a bound, merges keys (`<<`), makes dates
of `2001-01-01` and numbers of `0x10` and `1_000`, allows keys that are no names, and names a duplicate key without its
place among the others; each of these would need code here again. Its constructors in C take 11 times as long as this
module for a path of 20,000 waypoints, those in Python 27 times (ruamel.yaml 0.19.1 against PyYAML 6.0.4 with libyaml).
"""

import re
from collections.abc import Iterator
from typing import Any

import yaml

from sinuous.errors import InputError
from sinuous.files.text import NUMBER, join, refuse_deep, refuse_infinite, refuse_line, whole_number

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
            refuse_line(text, line, error.problem or "cannot be read", "YAML")
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
            raise InputError(_line(event), "stands for what it is part of", f"*{name}", "an alias of a finished value")
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
    if NUMBER.fullmatch(text):
        return float(text)
    return float(text.replace(".", "")) if _NOT_FINITE.fullmatch(text) else text


def _key(place: Place) -> str:
    return join(_key(place[0]), place[1]) if place else ""


def _line(event: Any) -> str:
    return f"line {event.start_mark.line + 1}"
