"""The base of everything that does not change once it is made, and what `repr` and notebooks show of an object."""

import inspect
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import FrozenInstanceError, is_dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from sinuous.base.entrance import import_late

LONGEST = 120
"""Letters of a line."""

FEW, LONG_TEXT = 4, 40
"""Entries of an array or list, and letters of a text or an object, up to which it is shown whole."""


class ShortRepr:
    """Shows the arguments of its constructor that say something, each by the attribute of the same name."""

    __slots__ = ()

    _arguments: ClassVar[Mapping[str, str]] = {}
    """Arguments of the constructor that are kept as an attribute of another name."""

    _asked: ClassVar[frozenset[str]] = frozenset()
    """Arguments that say something wherever they are given: a target that asks for no turn asks for a rotation."""

    def __repr__(self) -> str:
        return call(type(self).__name__, self._shown())

    def _shown(self) -> Iterator[str]:
        """Yield what stands between the parentheses."""
        for name, default in parameters(type(self)):
            value = getattr(self, self._arguments.get(name, name), None)
            if not (value is None if name in self._asked else says_nothing(value, default)):
                yield f"{name}={text(value)}"


_KNOWN: dict[Any, tuple[tuple[str, Any], ...]] = {}
"""Parameters of constructors that were asked for: to look at a signature takes some ten microseconds."""


def parameters(noun: Callable[..., Any]) -> tuple[tuple[str, Any], ...]:
    """Names and defaults of all parameters of a constructor."""
    if noun not in _KNOWN:
        _KNOWN[noun] = tuple((each.name, each.default) for each in inspect.signature(noun).parameters.values())
    return _KNOWN[noun]


def call(name: str, parts: Iterable[str]) -> str:
    """`name(part, part)`, on one line; parts that would make it too long are left out."""
    listed = list(parts)
    line = f"{name}({', '.join(listed)})"
    while listed and len(line) > LONGEST:
        listed.pop()
        line = f"{name}({', '.join([*listed, '...'])})"
    return line


def says_nothing(value: Any, default: Any) -> bool:
    """Whether a value is what an argument is by default: nothing, no limit, no turn."""
    if isinstance(value, np.ndarray):
        return default is None and value.ndim == 2 and np.array_equal(value, np.eye(*value.shape))
    return is_nothing(value) if default is None else value is None or bool(value == default)


def is_nothing(value: Any) -> bool:
    """Whether a value stands for nothing that was given: none, or no limit."""
    if isinstance(value, float | tuple):
        ends = value if isinstance(value, tuple) else (value,)
        return bool(ends) and all(isinstance(end, float) and math.isinf(end) for end in ends)
    return value is None


def text(value: Any) -> str:
    """Show a value: numbers with six digits, long arrays by their shape, long lists by their length."""
    if isinstance(value, str):
        return repr(str(value) if len(value) <= LONG_TEXT else f"{value[: LONG_TEXT - 3]}...")
    if isinstance(value, float | np.floating):
        return f"{value + 0.0:.6g}"
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, tuple | list):
        return "(" + ", ".join(map(text, value)) + ")" if len(value) <= FEW else f"({len(value)} entries)"
    return value.__name__ if inspect.isroutine(value) else _object(value)


def _object(value: Any) -> str:
    shown = str(value) if isinstance(value, np.generic) else repr(value)
    return shown if len(shown) <= LONG_TEXT and "\n" not in shown else f"{type(value).__name__}(...)"


def _array(array: NDArray[Any]) -> str:
    if array.shape == (3, 3) and abs(float(np.linalg.det(array)) - 1.0) < 1e-6:
        return text(tuple(_quaternion(array).round(6).tolist()))
    return text(tuple(array.tolist())) if array.ndim == 1 and array.size <= FEW else " x ".join(map(str, array.shape))


def _quaternion(rotation: NDArray[Any]) -> NDArray[np.float64]:
    """Quaternion (w, x, y, z) of a rotation (3, 3): the eigenvector of largest value (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    matrix = [[a + e + i, h - f, c - g, d - b], [h - f, a - e - i, b + d, c + g]]
    matrix += [[c - g, b + d, e - a - i, f + h], [d - b, c + g, f + h, i - a - e]]
    vector: NDArray[np.float64] = np.linalg.eigh(np.array(matrix))[1][:, -1]
    return -vector if vector[np.flatnonzero(np.abs(vector) > 1e-9)[0]] < 0.0 else vector


class Frozen(ShortRepr):
    """Attributes cannot be set, and arrays stay read-only when they are pickled. A copy is the object itself.

    NumPy forgets in a pickle that an array was read-only. So every array that is unpickled is made read-only, except
    those that kernels read: kernels are compiled for writable arrays alone.
    """

    __slots__ = ()

    _tables: ClassVar[frozenset[str]] = frozenset()
    """Names of the attributes that kernels read."""

    def __setattr__(self, name: str, value: Any) -> None:
        raise FrozenInstanceError(f"cannot set {name!r}: {type(self).__name__} is frozen")

    def __delattr__(self, name: str) -> None:
        raise FrozenInstanceError(f"cannot delete {name!r}: {type(self).__name__} is frozen")

    def _set(self, **values: Any) -> None:
        """Set attributes while the object is made."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def equals(self, other: object) -> bool:
        """Whether `other` is of the same type and says the same, to the last digit. `==` asks for the same object."""
        return type(self) is type(other) and same(self._content(), other._content())

    def _changed(self, values: Mapping[str, Any]) -> Self:
        """Return the same with other values of some parameters: what every `changed` does."""
        attributes = {name: getattr(self, self._arguments.get(name, name), None) for name, _ in parameters(type(self))}
        own = {name: value for name, value in attributes.items() if not is_nothing(value)}
        return type(self)(**{**own, **values})

    def _content(self) -> Mapping[str, Any]:
        """What is compared: by default all attributes that users see, but what was computed of the others and kept."""
        own = type(self)
        return {
            name: value
            for name, value in vars(self).items()
            if not name.startswith("_") and not isinstance(getattr(own, name, None), cached_property)
        }

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __setstate__(self, state: Any) -> None:
        parts: tuple[Mapping[str, Any] | None, ...] = state if isinstance(state, tuple) else (state,)
        for part in parts:  # attributes of the instance, then those in slots
            for name, value in (part or {}).items():
                self._set(**{name: self._restored(name, value)})

    def _restored(self, name: str, value: Any) -> Any:
        """Give an array back the flag that it had."""
        if not isinstance(value, np.ndarray):
            return value
        if name not in self._tables:
            value.flags.writeable = False
        elif not value.flags.writeable:  # unpickled into memory of somebody else
            return value.copy()
        return value


class Noun(Frozen):
    """What a user makes of parameters, and may want with others."""

    __slots__ = ()

    def changed(self, **values: Any) -> Self:
        """Return the same with other values of some parameters."""
        return self._changed(values)


def same(a: Any, b: Any) -> bool:
    """Whether two values say the same: nouns, arrays, mappings, lists and whatever compares by itself."""
    if isinstance(a, Frozen):
        return a.equals(b)
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, tuple | list) and isinstance(b, tuple | list):
        return len(a) == len(b) and all(map(same, a, b))
    if is_dataclass(a) and not isinstance(a, type):
        return type(a) is type(b) and same(vars(a), vars(b))
    return bool(a == b)


class NotebookMixin:
    """Lets a notebook show an object as HTML: a picture and a small table."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """HTML for a notebook."""
        return str(import_late("view.pictures.reports").html(self))
