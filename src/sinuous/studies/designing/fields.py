"""The robots that are tried: fields of the robot file with ranges or lists of values."""

import copy
import itertools
import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import Robot
from sinuous.studies.tasks.sweep import one_segment, with_fields

MOST_CHOICES = 10_000
"""Most combinations of values that are listed."""

ENDS = {"length": (0, 1), "max_bend": (1, 1), "max_curvature": (1, 1), "radius": (0, 0)}
"""Fields of segments that only widen what a robot can do as they move to one end of their range, and between which ends
of it a robot that can do all of that lies: 0 the lower, 1 the upper."""


class Range(NamedTuple):
    """A field that may have any value between two."""

    field: str
    low: float
    high: float

    def value(self, share: float) -> float:
        """The value at a share of the range."""
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """At which share of the range a value lies."""
        return (value - self.low) / (self.high - self.low)


class Choices(NamedTuple):
    """A field with some values."""

    field: str
    values: tuple[Any, ...]


class Space:
    """All robots that differ from a template in some fields.

    Parameters
    ----------
    template : Robot
    vary : mapping of str to (low, high) or list
        Fields as for `sweep`, and elements of lists: `base.position[2]`. A tuple of two numbers, or a mapping
        `{range: [low, high]}`, is a range; anything else lists values.

    Attributes
    ----------
    ranges : tuple of Range
    choices : tuple of Choices
    combinations : tuple of tuple
        Of the values of `choices`.
    segments : int
        Most segments of any of these robots.

    Raises
    ------
    InputError
        When there is no such field, a range is empty, or a value is not what it should be.
    """

    def __init__(self, template: Robot, vary: Any) -> None:
        checks.instance("template", template, Robot, "a Robot")
        if not isinstance(vary, Mapping) or not vary:
            raise InputError("vary", "", vary, "a mapping of fields to ranges or lists of values")
        read = [_read(str(field), value) for field, value in vary.items()]
        self.template = template
        self.ranges = tuple(each for each in read if isinstance(each, Range))
        self.choices = tuple(each for each in read if isinstance(each, Choices))
        count = int(np.prod([len(each.values) for each in self.choices], dtype=np.float64))
        if count > MOST_CHOICES:
            raise InputError("vary", f"lists {count} combinations", list(vary), f"at most {MOST_CHOICES}")
        self.combinations = tuple(itertools.product(*(each.values for each in self.choices)))
        self.segments = 1
        for combination in self.combinations:
            for share in (0.0, 1.0):  # a field that does not exist is refused now
                robot = self.robot(combination, np.full(len(self.ranges), share), refuse=True)
                self.segments = max(self.segments, 0 if robot is None else len(robot))

    @property
    def fields(self) -> tuple[str, ...]:
        """All fields: those with ranges, then those with lists."""
        return (*(each.field for each in self.ranges), *(each.field for each in self.choices))

    def values(self, combination: tuple[Any, ...], shares: Floats) -> dict[str, Any]:
        """Values of all fields at shares (d,) of the ranges."""
        inner = {each.field: each.value(float(share)) for each, share in zip(self.ranges, shares, strict=True)}
        return inner | {each.field: value for each, value in zip(self.choices, combination, strict=True)}

    def robot(self, combination: tuple[Any, ...], shares: Floats, refuse: bool = False) -> Robot | None:
        """Make a robot; `None` where these values together make none, unless that is to be refused."""
        try:
            return with_fields(self.template, self._ordered(self.values(combination, shares)), "vary")
        except InputError:
            if refuse:
                raise
            return None

    def shares_of(self, robot: Robot) -> tuple[int, Floats] | None:
        """Where a robot lies: the number of its combination, and the shares (d,); `None` where it is none of these."""
        own = robot.to_dict()
        shares = []
        for each in self.ranges:
            value = _value_of(own, each.field)
            if not isinstance(value, int | float) or not each.low <= value <= each.high:
                return None
            shares.append(each.share(value))
        values = tuple(_value_of(own, each.field) for each in self.choices)
        found = next((i for i, each in enumerate(self.combinations) if list(each) == list(values)), None)
        return None if found is None else (found, np.array(shares))

    def widest(self, combination: tuple[Any, ...]) -> tuple[Robot, float] | None:
        """Return a robot that can do whatever any robot of a combination can, and how far its base may have to move.

        `None` where no such robot is known.
        """
        values: dict[str, Any] = {}
        moved = 0.0
        for each in self.ranges:
            key = each.field.rpartition(".")[2]
            if re.fullmatch(r"base\.position\[\d\]", each.field):
                values[each.field] = each.value(0.5)
                moved += (0.5 * (each.high - each.low)) ** 2
            elif each.field == "radius" or (each.field.startswith("segments") and key in ENDS):
                ends = each.low, each.high
                low, high = (ends[i] for i in ENDS[key])
                values[each.field] = [low, high] if key == "length" else high
            else:
                return None
        values |= {each.field: value for each, value in zip(self.choices, combination, strict=True)}
        try:
            return with_fields(self.template, self._ordered(values), "vary"), moved**0.5
        except InputError:
            return None

    def _ordered(self, values: dict[str, Any]) -> dict[str, Any]:
        """The number of segments first: other fields may be those of one segment."""
        return dict(sorted(values.items(), key=lambda pair: pair[0] != "segments.count"))


def _read(field: str, value: Any) -> Range | Choices:
    key = f"vary[{field!r}]"
    if isinstance(value, Mapping):
        if set(value) not in ({"range"}, {"values"}):
            raise InputError(key, "", dict(value), "{range: [low, high]} or {values: [...]}")
        inner = next(iter(value.values()))
        pair = isinstance(inner, list | tuple) and len(inner) == 2 and all(isinstance(e, int | float) for e in inner)
        if "range" in value and not pair:
            raise InputError(f"{key}.range", "", inner, "two numbers")
        value = tuple(inner) if "range" in value else list(inner) if isinstance(inner, list | tuple) else inner
    if isinstance(value, tuple) and len(value) == 2 and all(isinstance(each, int | float) for each in value):
        low, high = (checks.number(key, each) for each in value)
        if low >= high:
            raise InputError(key, "is empty", list(value), "(low, high) with low < high")
        return Range(field, low, high)
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise InputError(key, "", value, "a range (low, high), or a list of values")
    listed = tuple(each.tolist() if isinstance(each, np.generic) else each for each in value)
    if not listed:
        raise InputError(key, "is empty", list(listed), "at least one value")
    return Choices(field, listed)


def _value_of(values: dict[str, Any], field: str) -> Any:
    """The value of a field in a robot file; `None` where it is not said."""
    place: Any = copy.copy(values)
    first, *rest = field.split(".")
    one = re.fullmatch(r"segments\[([^\]]+)\]", first)
    if one is not None:
        place = one_segment(place, one[1], field)
    for part in [first, *rest] if one is None else rest:
        match = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", part)
        if match is None or not isinstance(place, dict) or match[1] not in place:
            return None
        place = place[match[1]]
        if match[2] is not None:
            if not isinstance(place, list) or int(match[2]) >= len(place):
                return None
            place = place[int(match[2])]
    return place
