"""What an object is, in one line: what `repr` shows."""

import inspect
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

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
