"""Checks of input at the surface: each returns a clean value or raises one `InputError`.

Names of segments and of what drives them are checked here, too, and those that were not given are made.
"""

import math
import numbers
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sinuous.base.errors import InputError, shown, suggested

Floats = NDArray[np.float64]

Word = TypeVar("Word", bound=str)
Kind = TypeVar("Kind", bound=np.generic)

LARGEST = 1e100
"""Largest coordinate of a point: squares and cubes of it are numbers still."""

LARGEST_FLOAT = sys.float_info.max

UNIT_SLACK = 4e-15
"""By how much the square of a unit vector differs from 1 at most, after rounding."""


def closed(array: NDArray[Kind]) -> NDArray[Kind]:
    """Make an array read-only, and return it."""
    array.flags.writeable = False
    return array


@contextmanager
def inside(key: str) -> Iterator[None]:
    """Put `key` in front of the key of whatever is refused within."""
    try:
        yield
    except InputError as error:
        raise error.within(key) from None


@contextmanager
def in_file(file: object) -> Iterator[None]:
    """Put the name of a file in front of whatever is refused within, unless it names a file already."""
    try:
        yield
    except InputError as error:
        raise error.in_file(file) from None


def written(file: str | Path, key: str = "file") -> AbstractContextManager[None]:
    """Refuse a file, under `key`, when it turns out within that it cannot be written."""
    return _usable(file, key, "written", "a file that can be written")


def readable(file: str | Path, key: str = "file") -> AbstractContextManager[None]:
    """Refuse a file, under `key`, when it turns out within that it cannot be read."""
    return _usable(file, key, "read", "the name of a file that can be read")


@contextmanager
def _usable(file: str | Path, key: str, use: str, expected: str) -> Iterator[None]:
    if "\0" in str(file):
        raise InputError(key, f"cannot be {use}: a null character in its name", str(file), expected)
    try:
        yield
    except OSError as error:
        raise InputError(key, f"cannot be {use}: {error.strerror or error}", str(file), expected) from None


def instance(key: str, value: Any, kind: Any, expected: str) -> None:
    """Refuse what is of no class, or union of classes, that is meant."""
    if not isinstance(value, kind):
        raise InputError(key, "", value, expected)


def number(key: str, value: Any, *, low: float = -math.inf, above: float = -math.inf, high: float = math.inf) -> float:
    """Check a finite number: at least `low`, greater than `above`, at most `high`."""
    if type(value) is float and max(low, -LARGEST_FLOAT) <= value <= min(high, LARGEST_FLOAT) and value > above:
        return value
    expected = "a finite number"
    if above > -math.inf:
        expected = f"a number greater than {above:g}"
    elif low > -math.inf:
        expected = f"a number of at least {low:g}"
    if high < math.inf:
        expected += f", at most {high:g}"
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise InputError(key, "", value, expected)
    try:
        result = float(value)
    except OverflowError:
        raise InputError(key, "too large", value, expected) from None
    if not math.isfinite(result) or result < low or result <= above or result > high:
        raise InputError(key, "", value, expected)
    return result


def integer(key: str, value: Any, low: int, high: int) -> int:
    """Check a whole number between `low` and `high`, both allowed."""
    if type(value) is int and low <= value <= high:
        return value
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral) or not low <= int(value) <= high:
        raise InputError(key, "", value, f"a whole number from {low} to {high}")
    return int(value)


def one_each(key: str, value: Any, count: int | None) -> float | tuple[float, ...]:
    """Check a number of at least 0, or one for each of `count` segments (None: of any); returns it, or all of them."""
    if isinstance(value, numbers.Real) or not np.iterable(value) or isinstance(value, (str, bytes, dict)):
        return number(key, value, low=0.0)
    listed = list(value)
    if count is not None and len(listed) != count:
        raise InputError(key, "", listed, f"a number, or {count} numbers, one for each segment")
    return tuple(number(f"{key}[{i}]", each, low=0.0) for i, each in enumerate(listed))


def array(key: str, value: Any, shape: Sequence[int | None], expected: str | None = None) -> Floats:
    """Check an array of finite numbers; `None` in `shape` stands for any extent. Returns a new read-only array."""
    wanted = expected or _described(tuple(shape))
    result = _numbers(key, value, wanted)
    if result.shape != shape and not _fits(result.shape, shape):
        raise InputError(key, "" if result.ndim < 2 else f"shape {result.shape}", value, wanted)
    if result.dtype != np.float64:
        result = result.astype(np.float64)
    if not np.isfinite(result).all():
        raise InputError(key, "", value, wanted)
    return closed(result)


def _fits(extents: Sequence[int], shape: Sequence[int | None]) -> bool:
    return len(extents) == len(shape) and all(s is None or s == d for s, d in zip(shape, extents, strict=True))


@cache
def _described(shape: tuple[int | None, ...]) -> str:
    """Say what an array of this shape holds: `3 finite numbers`, `rows of 3 finite numbers`."""
    if shape == (1,):
        return "1 finite number"
    counts = ["" if extent is None else f"{extent} " for extent in shape]
    if len(shape) <= 2:
        return " rows of ".join(counts).replace("  ", " ").lstrip() + "finite numbers"
    return "finite numbers of shape (" + ", ".join("any" if s is None else str(s) for s in shape) + ")"


def _numbers(key: str, value: Any, expected: str) -> NDArray[Any]:
    """Make a new array of numbers of any kind and shape."""
    try:
        result = np.array(value, order="C")
    except (ValueError, TypeError, OverflowError):
        raise InputError(key, "", value, expected) from None
    if result.dtype.kind not in "iuf" or _has_truth_value(value):
        raise InputError(key, "", value, expected)
    return result


def _has_truth_value(value: Any) -> bool:
    """Whether a nested list hides true or false among its numbers; NumPy would count them as 1 and 0."""
    if isinstance(value, (list, tuple)):
        return not set(map(type, value)) <= {int, float} and any(map(_has_truth_value, value))
    return isinstance(value, (bool, np.bool_))


def stack(key: str, value: Any, shape: Sequence[int | None], expected: str | None = None) -> Floats:
    """Check an array of finite numbers whose last axes have this shape, with any axes in front of them."""
    expected = expected or _stacked(tuple(shape))
    try:
        lead = np.ndim(value) - len(shape)
    except ValueError:  # rows of different lengths; `array` says so
        lead = 0
    if lead < 0:
        raise InputError(key, "too few axes", value, expected)
    return array(key, value, (*([None] * lead), *shape), expected)


@cache
def _stacked(shape: tuple[int | None, ...]) -> str:
    extents = "".join(", any" if s is None else f", {s}" for s in shape)
    return f"finite numbers of shape (...{extents})" if shape else "finite numbers"


def broadcast(key: str, value: Any, *arrays: Floats) -> list[Floats]:
    """Bring arrays to one shape; `value` is what is refused where they have none."""
    try:
        return list(np.broadcast_arrays(*arrays))
    except ValueError:
        shapes = " and ".join(str(a.shape) for a in arrays)
        raise InputError(key, "does not fit the rest", value, f"shapes that broadcast, not {shapes}") from None


def vector(key: str, value: Any) -> Floats:
    """Check three finite numbers."""
    return array(key, value, (3,))


def direction(key: str, value: Any, size: int = 3) -> Floats:
    """Check finite numbers, three by default, that are not all zero; return the unit vector.

    What is a unit vector already, up to rounding, is kept: it can be written down and read again.
    """
    v = array(key, value, (size,))
    entries = v.tolist()
    largest = max(map(abs, entries))
    if 0.4 < largest < 1.1 and abs(_squares(entries) - 1.0) <= UNIT_SLACK:
        return v
    if largest == 0.0:
        raise InputError(key, "", value, "a vector that is not zero")
    scaled = v / largest
    return closed(scaled / math.sqrt(_squares(scaled.tolist())))


def rows(key: str, value: Any, *shape: int) -> Floats:
    """Check finite numbers (m, *shape), m from 0; a refusal names the first bad row. Returns a new read-only array."""
    wanted = _described((None, *shape))
    result = _numbers(key, value, wanted)
    if result.shape[1:] != shape or result.ndim == 0:
        raise InputError(key, "" if result.ndim < 2 else f"shape {result.shape}", value, wanted)
    result = result.astype(np.float64, copy=False)
    if not np.isfinite(result).all():
        first = int(np.argmin(np.isfinite(result).reshape(len(result), -1).all(axis=1)))
        raise InputError(f"{key}[{first}]", "", result[first].tolist(), _described(shape))
    return closed(result)


def directions(key: str, value: Any, size: int = 3) -> Floats:
    """Check rows of finite numbers as `direction` checks one; return the unit vectors (m, size), equal to its own."""
    v = rows(key, value, size)
    largest = np.maximum.reduce(np.abs(v).T)  # over rows: along short rows NumPy is slow
    if (largest == 0.0).any():
        first = int(np.argmin(largest))
        raise InputError(f"{key}[{first}]", "", v[first].tolist(), "a vector that is not zero")
    close = (largest > 0.4) & (largest < 1.1)
    close[close] = np.abs(_squares(v[close].T) - 1.0) <= UNIT_SLACK
    if close.all():
        return v
    scaled = v[~close] / largest[~close, None]
    result = v.copy()
    result[~close] = scaled / np.sqrt(_squares(scaled.T))[:, None]
    return closed(result)


def _squares(parts: Iterable[Any]) -> Any:
    """Sum of squares of numbers, or of arrays, from the first to the last; `sum` would round numbers otherwise."""
    total = 0.0
    for part in parts:
        total = total + part * part
    return total


def interval(key: str, value: Any, *, low: float = -math.inf) -> tuple[float, float]:
    """Check a number, or a pair [low, high] in this order."""
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        single = number(key, value, low=low)
        return single, single
    ends = [] if isinstance(value, (str, bytes, dict)) or not np.iterable(value) else list(islice(value, 3))
    if len(ends) != 2:
        raise InputError(key, "", value, "a number or [low, high]")
    pair = number(f"{key}[0]", ends[0], low=low), number(f"{key}[1]", ends[1], low=low)
    if pair[0] > pair[1]:
        raise InputError(key, "lower limit above the upper one", value, "[low, high] with low <= high")
    return pair


def increasing(key: str, value: Any, count: int | None) -> Floats:
    """Check finite numbers, so many where that is known, each greater than the one before."""
    result = array(key, value, (count,))
    early = np.flatnonzero(np.diff(result) <= 0.0)
    if len(early):
        i = int(early[0]) + 1
        raise InputError(f"{key}[{i}]", f"{key} must increase", float(result[i]), f"more than {result[i - 1]:g}")
    return result


def points(key: str, value: Any) -> Floats:
    """Check rows of three finite numbers, at least one; a refusal names the first bad row. Returns a new array."""
    expected = "rows of 3 finite numbers"
    result = _numbers(key, value, expected)
    if result.size == 0:
        raise InputError(key, "", value, "at least one point")
    if result.ndim != 2 or result.shape[1] != 3:
        raise InputError(key, f"shape {result.shape}", value, expected)
    result = result.astype(np.float64)
    good = (np.abs(result) <= LARGEST).all(axis=1)
    if not good.all():
        first = int(np.flatnonzero(~good)[0])
        problem = "too large" if np.isfinite(result[first]).all() else ""
        raise InputError(f"{key}[{first}]", problem, result[first].tolist(), "3 finite numbers")
    return closed(result)


def truth(key: str, value: Any) -> bool:
    """Check true or false; numbers are neither."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(key, "", value, "true or false")
    return bool(value)


def text(key: str, value: Any) -> str:
    """Check a piece of text that is not empty."""
    if not isinstance(value, str) or not value:
        raise InputError(key, "", value, "a text")
    return value


def needed(package: str, extra: str, key: str, value: object = None, name: str = "") -> Any:
    """Import a package that an extra brings, or say what to install; it is called `name`, where that is another one."""
    try:
        return import_module(package)
    except ImportError:
        wanted = f"it installed: pip install sinuous[{extra}]"
        raise InputError(key, f"needs {name or package}", value, wanted) from None


def names_of(key: str, value: Any, known: Sequence[str]) -> list[str]:
    """Check names that are known, each given once; by default all of them."""
    if value is None:
        return list(known)
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise InputError(key, "", value, "a list of names")
    names = list(value)
    for i, name in enumerate(names):
        choice(f"{key}[{i}]", name, known)
        if name in names[:i]:
            raise InputError(f"{key}[{i}]", "given twice", name, "each name once")
    return names


def choice(key: str, value: Any, words: Sequence[Word]) -> Word:
    """Check that a value is one of some words."""
    found = next((word for word in words if isinstance(value, str) and word == value), None)
    if found is None:
        expected = " or ".join(words) if len(words) < 3 else "one of " + ", ".join(words)
        raise InputError(key, "", value, expected)
    return found


MOST_SEGMENTS = 10_000


def segment_number(key: str, value: Any, names: Sequence[str]) -> int:
    """Number, 1 = first, of a segment of these that is given by its number or its name."""
    if not isinstance(value, str):
        return integer(key, value, 1, len(names))
    if value not in names:
        raise InputError(key, f"no segment is called {shown(value)}", value, suggested(value, names))
    return names.index(value) + 1


def any_segment(value: Any) -> Any:
    """Check a segment of a robot that is not known yet: its number or its name, or none."""
    if value is None or isinstance(value, str):
        return value if value is None else text("segment", value)
    return integer("segment", value, 1, MOST_SEGMENTS)


def each_segment(key: str, value: Any, names: Sequence[str]) -> float | tuple[float, ...]:
    """Check a number of at least 0 for all segments, or one for each, or some by the names of segments."""
    if not isinstance(value, Mapping):
        return one_each(key, value, len(names))
    result = [0.0] * len(names)
    for name, each in value.items():
        result[segment_number(key, name, names) - 1] = number(f"{key}.{name}", each, low=0.0)
    return tuple(result)


def optional_name(value: Any) -> str | None:
    """Check a name, or none."""
    return None if value is None else text("name", value)


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
    return tuple(text(f"names[{i}]", name) for i, name in enumerate(names))


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


MOST_NAMED = 4
"""Names that a refusal names."""


def few(names: Sequence[str]) -> str:
    """The first of some names, and how many more there are."""
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED + 1 else ""
    return ", ".join(names[:MOST_NAMED] if more else names) + more


def in_order(
    key: str, values: Mapping[str, Any], names: Sequence[str], noun: str = "actuator", *, finite: bool = True
) -> Floats:
    """Values (..., m) in the order of these names, of values (...) under them; those that are measured may be NaN."""
    for name in values:
        if name not in names:
            known = f"some of {few(names)}" if names else "none"
            raise InputError(key, f"no {noun} is called {shown(name)}", name, known)
    missing = [name for name in names if name not in values]
    if missing:
        raise InputError(key, "missing", None, f"a value for each: {few(missing)}")
    with inside(key):
        each = [stack(name, values[name], ()) if finite else np.asarray(values[name], float) for name in names]
        parts = broadcast("", values, *each) if each else []
    return np.stack(parts, axis=-1) if parts else np.zeros(0)
