"""Robots that differ in some fields of the robot file: every combination of the values."""

import copy
import re
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any

from sinuous.errors import InputError, shown
from sinuous.files.nouns import read_robot
from sinuous.robot.robot import Robot

MOST_ROBOTS = 100_000


def sweep(robot: Robot, fields: Mapping[str, Iterable[Any]]) -> dict[str, Robot]:
    """Make robots that differ in fields of the robot file.

    Parameters
    ----------
    robot : Robot
    fields : mapping of str to iterable
        Values of each field, as a robot file has them: `radius`, `base.position`, `segments.length` (of all segments),
        `segments[2].max_bend` (of one, 0 = first), `segments.tendons.displacement`, `segments.count` (where all
        segments are equal).

    Returns
    -------
    dict of str to Robot
        Every combination, by what differs: `segments.count=4, radius=3`.

    Raises
    ------
    InputError
        When there is no such field, or a value is not what it should be.
    """
    if not isinstance(robot, Robot):
        raise InputError("robot", "", robot, "a Robot")
    if not isinstance(fields, Mapping) or not fields:
        raise InputError("fields", "", fields, "a mapping of fields to lists of values")
    listed = {}
    for field, values in fields.items():
        if isinstance(values, str) or not isinstance(values, Iterable):
            raise InputError(f"fields[{field!r}]", "", values, "a list of values")
        listed[field] = list(values)
    count = 1
    for values in listed.values():
        count *= len(values)
    if not 0 < count <= MOST_ROBOTS:
        raise InputError("fields", f"make {count} robots", list(listed), f"1 to {MOST_ROBOTS}")
    found = {}
    for values in product(*listed.values()):
        chosen = dict(zip(listed, values, strict=True))
        found[", ".join(f"{field}={shown(value)}" for field, value in chosen.items())] = _changed(robot, chosen)
    return found


def _changed(robot: Robot, chosen: Mapping[str, Any]) -> Robot:
    values = robot.to_dict()
    for field, value in chosen.items():
        _put(values, field, value)
    try:
        return read_robot(values)
    except InputError as error:
        raise error.within("fields") from None


def _put(values: dict[str, Any], field: str, value: Any) -> None:
    """Set a field; a radius of the robot is that of all segments."""
    first, *rest = field.split(".")
    match = re.fullmatch(r"segments(?:\[(\d+)\])?", first)
    if match is None:
        if field == "radius":
            for entry in _entries(values):
                entry.pop("radius", None)
        _set(values, [first, *rest], value, field)
        return
    if not rest:
        raise InputError(f"fields[{field!r}]", "names no field", field, "segments.KEY")
    for entry in _entries(values) if match[1] is None else [_one(values, int(match[1]), field)]:
        _set(entry, rest, value, field)


def _entries(values: dict[str, Any]) -> list[dict[str, Any]]:
    entries = values["segments"]
    return [entries] if isinstance(entries, dict) else entries


def _one(values: dict[str, Any], index: int, field: str) -> dict[str, Any]:
    """The mapping of one segment; segments that were written together are taken apart."""
    apart = [
        copy.deepcopy({key: each for key, each in entry.items() if key != "count"})
        for entry in _entries(values)
        for _ in range(entry.get("count", 1))
    ]
    if index >= len(apart):
        raise InputError(f"fields[{field!r}]", "there is no such segment", index, f"0 to {len(apart) - 1}")
    values["segments"] = apart
    return apart[index]


def _set(entry: dict[str, Any], path: list[str], value: Any, field: str) -> None:
    *outer, last = path
    if last == "count" and not outer and "length" not in entry:
        raise InputError(f"fields[{field!r}]", "is no field of it", value, "segments.count")
    for key in outer:
        if not isinstance(entry.get(key), dict):
            raise InputError(f"fields[{field!r}]", f"this robot has no {key}", value, "a field that is there")
        entry = entry[key]
    entry[last] = value
