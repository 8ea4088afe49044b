"""From a noun to a mapping: the arguments that make an equal noun, as they stand in a file."""

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.frozen import Frozen

MOST_WHOLE = 2**53
"""Below this, floats without a fraction are written as whole numbers."""


def described(noun: Frozen) -> dict[str, Any]:
    """Return the arguments of a noun's constructor as plain values, without those that have their defaults.

    The value of an argument is the attribute of the same name, or the one that `Frozen._arguments` names.
    """
    result = {}
    for name, parameter in inspect.signature(type(noun)).parameters.items():
        value = getattr(noun, noun._arguments.get(name, name), None)
        value = _TURNS[name](value) if name in _TURNS and name not in noun._asked else plain(value)
        default = None if parameter.default is parameter.empty else plain(parameter.default)
        nothing = value is None or (value == [] and default is None)
        if not nothing and value != default:
            result[name] = value
    return result


def plain(value: Any) -> Any:
    """Return a value as dict, list, str, int, float, bool or None; what says nothing (no limit) is None."""
    if isinstance(value, Frozen):
        return described(value)
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, tuple | list):
        return _listed([plain(entry) for entry in value])
    if isinstance(value, float):
        return _number(value)
    return value


def _number(value: float) -> int | float | None:
    if math.isinf(value):
        return None
    signed_zero = value == 0.0 and math.copysign(1.0, value) < 0.0
    return int(value) if value.is_integer() and abs(value) < MOST_WHOLE and not signed_zero else value


def _listed(entries: list[Any]) -> list[Any] | None:
    return None if entries and all(entry is None for entry in entries) else entries


def pose_arguments(pose: Floats) -> dict[str, Any] | None:
    """Write a pose (4, 4) as `position` and `rotation`, without those that change nothing; None without both."""
    parts = {"position": plain(pose[:3, 3]) if pose[:3, 3].any() else None, "rotation": _rotation(pose[:3, :3])}
    return {key: value for key, value in parts.items() if value is not None} or None


def _rotation(matrix: Floats | None) -> Any:
    return None if matrix is None or np.array_equal(matrix, np.eye(3)) else plain(matrix)


_TURNS: dict[str, Callable[[Any], Any]] = {"rotation": _rotation, "base": pose_arguments, "tool": pose_arguments}
"""Arguments that are a rotation or a pose."""


def counted(parts: list[dict[str, Any]]) -> dict[str, Any] | list[dict[str, Any]]:
    """Put equal neighbours together, with their `count`; a single entry stands alone."""
    runs: list[tuple[int, dict[str, Any]]] = []
    for part in parts:
        if runs and runs[-1][1] == part:
            runs[-1] = runs[-1][0] + 1, part
        else:
            runs.append((1, part))
    listed = [part if count == 1 else {"count": count, **part} for count, part in runs]
    return listed[0] if len(listed) == 1 else listed
