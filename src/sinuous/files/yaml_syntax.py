"""YAML text to plain values: the part of YAML 1.2 that says what JSON says.

PyYAML's parser gives the events; what they mean is decided here, because its own constructors follow YAML 1.1, where
`1e-3` is a text, `010` is eight and `no` is false. There are no tags, anchors or aliases, so nothing can be executed or
multiply.
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

Events = Iterator[Any]

Place = tuple[Any, ...]
"""Where a value stands: `()`, or the place of what it stands in, and its name or number there."""


def parse_yaml(text: str) -> Any:
    """Read one YAML document; `None` when there is none.

    Raises
    ------
    InputError
        With the number of the line when it is no YAML or uses a tag or an alias, with the key when it stands twice or
        its number is not finite.
    """
    with refuse_deep(text):
        try:
            values = _document(iter(_LOADER(text).get_event, None))
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            refuse_line(text, line, error.problem or "cannot be read", "YAML")
        except yaml.YAMLError as error:
            reason = getattr(error, "reason", "cannot be read")
            raise InputError("file", str(reason), text, "YAML") from None
        refuse_infinite(values)
    return values


def _document(events: Events) -> Any:
    next(events)
    if isinstance(next(events), yaml.StreamEndEvent):
        return None
    value = _value((), next(events), events)
    next(events)
    after = next(events)
    if not isinstance(after, yaml.StreamEndEvent):
        raise InputError(_line(after), "starts another document", "---", "one document")
    return value


def _value(place: Place, event: Any, events: Events) -> Any:
    if event.anchor is not None:
        raise InputError(_line(event), "has an anchor or an alias", event.anchor, "every value written out")
    if event.tag is not None:
        raise InputError(_line(event), "has a tag", event.tag, "plain values")
    if isinstance(event, yaml.ScalarEvent):
        return _scalar(event.value) if event.implicit[0] else event.value
    return _sequence(place, events) if isinstance(event, yaml.SequenceStartEvent) else _mapping(place, events)


def _sequence(place: Place, events: Events) -> list[Any]:
    result: list[Any] = []
    for event in events:
        if isinstance(event, yaml.SequenceEndEvent):
            break
        result.append(_value((place, len(result)), event, events))
    return result


def _mapping(place: Place, events: Events) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for event in events:
        if isinstance(event, yaml.MappingEndEvent):
            break
        if not isinstance(event, yaml.ScalarEvent):
            raise InputError(_line(event), "has a key that is no name", _key(place), "a name")
        name, inner = event.value, (place, event.value)
        value = _value(inner, next(events), events)
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
