"""Numbers and lists in sentences, the same in every message."""

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

Value = TypeVar("Value", bound=Hashable)


def number(value: Any, digits: int = 4) -> str:
    """A number with so many digits; of a vector or an interval all of them."""
    if isinstance(value, bool | str) or value is None:
        return str(value)
    if isinstance(value, np.ndarray | list | tuple):
        return "[" + ", ".join(number(each, digits) for each in value) + "]"
    return f"{value + 0.0:.{digits}g}"


def degrees(angle: float) -> str:
    """An angle in rad as people imagine it: `17.2 deg`."""
    return f"{number(math.degrees(angle), 3)} deg"


def rounded(value: float) -> float:
    """Drop the last digits, which say what arithmetic rounds."""
    return float(f"{value:.12g}")


def rounded_up(value: float) -> float:
    """Round a number greater than 0 up to three digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return rounded(unit * math.ceil(value / unit * (1.0 - 1e-12)))


def duration(seconds: float) -> str:
    """`87 us`, `4.09 ms` or `1.2 s`."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} us"


def counted(count: int, noun: str) -> str:
    """`1 edge`, `2 edges`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def span(pair: Sequence[float]) -> str:
    """`1 to 2`, or `1` where both are the same."""
    low, high = map(number, pair)
    return low if low == high else f"{low} to {high}"


def ranges(numbers: Iterable[int]) -> str:
    """Increasing numbers as `1 to 3, 7`."""
    runs: list[list[int]] = []
    for one in numbers:
        if runs and one == runs[-1][-1] + 1:
            runs[-1].append(one)
        else:
            runs.append([one])
    return ", ".join(span((run[0], run[-1])) if len(run) > 1 else str(run[0]) for run in runs)


def listed(texts: Iterable[str]) -> str:
    """`a, b and c`."""
    *front, last = tuple(texts)
    return f"{', '.join(front)} and {last}" if front else last


def one_of_body(label: int | str | None) -> str:
    """`segment 3`; `link 'elbow'` of a joint's name; `the body` where neither is known."""
    return "the body" if label is None else f"link {label!r}" if isinstance(label, str) else f"segment {label}"


def labelled(labels: Iterable[int | str], count: int | None = None) -> str:
    """What has limits: `joint 'roll' and segments 1 to 3`; see `segments`."""
    every = [*labels]
    numbers = [each for each in every if isinstance(each, int)]
    return listed(
        [f"joint {each!r}" for each in every if isinstance(each, str)] + ([segments(numbers, count)] if numbers else [])
    )


def segments(numbers: Sequence[int], count: int | None = None) -> str:
    """`segment 3`, `segments 1 to 4 and 6`; with the `count` of the robot's segments, `all segments`."""
    if count is not None and len(numbers) == count > 1:
        return "all segments"
    runs: list[list[int]] = []
    for each in sorted(numbers):
        if runs and each == runs[-1][-1] + 1:
            runs[-1].append(each)
        else:
            runs.append([each])
    texts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else listed(map(str, run)) for run in runs]
    return f"segment{'s' if len(numbers) > 1 else ''} {listed(texts)}"


def grouped(values: Mapping[int, Value]) -> list[tuple[list[int], Value]]:
    """Put the numbers together that have the same value, in the order in which values come first."""
    groups: dict[Value, list[int]] = {}
    for each, value in values.items():
        groups.setdefault(value, []).append(each)
    return [(numbers, value) for value, numbers in groups.items()]
