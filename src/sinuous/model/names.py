"""Names of segments and of what drives them: those that were given, and default names for the rest."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.errors import InputError, shown, suggested

MOST_SEGMENTS = 10_000


def segment_number(key: str, value: Any, names: Sequence[str]) -> int:
    """Number, 1 = first, of a segment of these that is given by its number or its name."""
    if not isinstance(value, str):
        return checks.integer(key, value, 1, len(names))
    if value not in names:
        raise InputError(key, f"no segment is called {shown(value)}", value, suggested(value, names))
    return names.index(value) + 1


def any_segment(value: Any) -> Any:
    """Check a segment of a robot that is not known yet: its number or its name, or none."""
    if value is None or isinstance(value, str):
        return value if value is None else checks.text("segment", value)
    return checks.integer("segment", value, 1, MOST_SEGMENTS)


def each_segment(key: str, value: Any, names: Sequence[str]) -> float | tuple[float, ...]:
    """Check a number of at least 0 for all segments, or one for each, or some by the names of segments."""
    if not isinstance(value, Mapping):
        return checks.one_each(key, value, len(names), "segment")
    listed = [0.0] * len(names)
    for name, number in value.items():
        listed[segment_number(key, name, names) - 1] = checks.number(f"{key}.{name}", number, low=0.0)
    return tuple(listed)


def optional_name(value: Any) -> str | None:
    """Check a name, or none."""
    return None if value is None else checks.text("name", value)


def listed(key: str, value: Any, count: int, expected: str) -> list[Any]:
    """Check that there are `count` of something, and list them."""
    found = list(islice(value, count + 1)) if np.iterable(value) and not isinstance(value, (str, bytes, dict)) else []
    if len(found) != count:
        raise InputError(key, "", value, expected)
    return found


def listed_names(value: Any, count: int) -> tuple[str, ...] | None:
    """Check `count` names, or none at all."""
    if value is None:
        return None
    names = listed("names", value, count, f"a list of {count} names")
    return tuple(checks.text(f"names[{i}]", name) for i, name in enumerate(names))


def line_names(segment: str, letter: str, given: tuple[str, ...] | None, count: int) -> tuple[str, ...]:
    """Names of the tendons (letter `t`) or chambers (`c`) of a segment; by default `s1.t1`, `s1.t2`, ..."""
    return given or tuple(f"{segment}.{letter}{j + 1}" for j in range(count))


def refuse_repeated(named: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that stands twice, among pairs of the key that gives a name and the name."""
    first: dict[str, str] = {}
    for key, name in named:
        if name in first:
            raise InputError(key, f"is that of {first[name]} already", name, "a name of its own")
        first[name] = key


def motor_columns(actuators: Iterable[str], joints: Collection[str]) -> list[str]:
    """Names of the columns of motors in tables: those of actuators, `roll.motor` beside a joint `roll`."""
    return [f"{name}.motor" if name in joints else name for name in actuators]
