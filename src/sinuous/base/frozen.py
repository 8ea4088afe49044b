"""The base of everything that does not change once it is made."""

from collections.abc import Mapping
from dataclasses import FrozenInstanceError
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from sinuous.base.reprs import ShortRepr, is_nothing, parameters


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
    return bool(a == b)
