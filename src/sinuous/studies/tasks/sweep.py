"""Robots that differ in some fields of the robot file: every combination of the values."""

import copy
import math
import re
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any

from sinuous.base import checks
from sinuous.base.errors import InputError, shown
from sinuous.files.nouns import read_robot
from sinuous.model.robot import Robot

MOST_ROBOTS = 100_000

PLACES = ("base", "tool")
"""Poses, which a robot file need not say."""


def sweep(robot: Robot, fields: Mapping[str, Iterable[Any]]) -> dict[str, Robot]:
    """Make robots that differ in fields of the robot file.

    Parameters
    ----------
    robot : Robot
    fields : mapping of str to iterable
        Values of each field, as a robot file has them: `radius`, `base.position`, `segments.length` (of all segments),
        `segments[2].max_bend` (of one, 0 = first, or by its name: `segments[wrist].max_bend`),
        `segments.tendons.displacement`, `segments.count` (where all segments are equal).

    Returns
    -------
    dict of str to Robot
        Every combination, by what differs: `segments.count=4, radius=3`.

    Raises
    ------
    InputError
        When there is no such field, or a value is not what it should be.
    """
    checks.instance("robot", robot, Robot, "a Robot")
    if not isinstance(fields, Mapping) or not fields:
        raise InputError("fields", "", fields, "a mapping of fields to lists of values")
    listed = {}
    for field, values in fields.items():
        if isinstance(values, str) or not isinstance(values, Iterable):
            raise InputError(f"[{field!r}]", "", values, "a list of values")
        listed[field] = list(values)
    count = math.prod(map(len, listed.values()))
    if not 0 < count <= MOST_ROBOTS:
        raise InputError("fields", f"make {count} robots", list(listed), f"1 to {MOST_ROBOTS}")
    found = {}
    for values in product(*listed.values()):
        chosen = dict(zip(listed, values, strict=True))
        name = ", ".join(f"{field}={shown(value)}" for field, value in chosen.items())
        found[name] = with_fields(robot, chosen, "fields")
    return found


def with_fields(robot: Robot, chosen: Mapping[str, Any], where: str) -> Robot:
    """Return a robot with other values of some fields; `where` is what a refusal calls the mapping of them.

    A field may be an element of a list: `base.position[2]`.

    Raises
    ------
    InputError
        When there is no such field, or a value is not what it should be.
    """
    values = robot.to_dict()
    with checks.inside(where):
        for field, value in chosen.items():
            _put(values, field, value)
        return read_robot(values)


def _put(values: dict[str, Any], field: str, value: Any) -> None:
    """Set a field; a radius of the robot is that of all segments."""
    first, *rest = field.split(".")
    match = re.fullmatch(r"segments(?:\[([^\]]+)\])?", first)
    if match is None:
        if field == "radius":
            for entry in _entries(values):
                entry.pop("radius", None)
        _set(values, [first, *rest], value, field)
        return
    if not rest:
        raise InputError(f"[{field!r}]", "names no field", field, "segments.KEY")
    for entry in _entries(values) if match[1] is None else [one_segment(values, match[1], field)]:
        _set(entry, rest, value, field)


def _entries(values: dict[str, Any]) -> list[dict[str, Any]]:
    entries = values["segments"]
    return [entries] if isinstance(entries, dict) else entries


def one_segment(values: dict[str, Any], which: str, field: str) -> dict[str, Any]:
    """The mapping of one segment, by its place or its name; segments that were written together are taken apart."""
    apart = [
        copy.deepcopy({key: each for key, each in entry.items() if key != "count"})
        for entry in _entries(values)
        for _ in range(entry.get("count", 1))
    ]
    names = [entry.get("name", f"s{k + 1}") for k, entry in enumerate(apart)]
    places = {**{str(k): k for k in range(len(apart))}, **{name: k for k, name in enumerate(names)}}
    if which not in places:
        expected = f"0 to {len(apart) - 1}, or one of {', '.join(names)}"
        raise InputError(f"[{field!r}]", "there is no such segment", which, expected)
    values["segments"] = apart
    return apart[places[which]]


def _set(entry: dict[str, Any], path: list[str], value: Any, field: str) -> None:
    """Set a field, or an element of a list: of a length that is one number, both ends are that.

    A robot that stands or carries its tool nowhere special has these places, too.
    """
    *outer, last = path
    if last == "count" and not outer and "length" not in entry:
        raise InputError(f"[{field!r}]", "is no field of it", value, "segments.count")
    for key in outer:
        if key in PLACES and key not in entry:
            entry[key] = {}
        if not isinstance(entry.get(key), dict):
            raise InputError(f"[{field!r}]", f"this robot has no {key}", value, "a field that is there")
        entry = entry[key]
    match = re.fullmatch(r"(\w+)\[(\d+)\]", last)
    if match is not None:
        last, i = match[1], int(match[2])
        listed = entry.get(last, [0.0, 0.0, 0.0] if last == "position" else None)
        if last == "length" and isinstance(listed, int | float):
            listed = [listed, listed]
        if not isinstance(listed, list) or i >= len(listed):
            raise InputError(f"[{field!r}]", "is no element of it", value, "an element of a list that is there")
        value = [*listed[:i], value, *listed[i + 1 :]]
    entry[last] = value
