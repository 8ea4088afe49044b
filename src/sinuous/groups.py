"""Groups of parameters that something is derived by, under their names."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

from sinuous.errors import InputError

Name = TypeVar("Name", bound=str)
Value = TypeVar("Value")


def read_names(wrt: Any, known: Iterable[str]) -> tuple[Any, ...]:
    """Check names of groups of parameters: one, or several.

    Raises
    ------
    InputError
    """
    listed = (wrt,) if isinstance(wrt, str) else tuple(wrt) if isinstance(wrt, Iterable) else (wrt,)
    for name in listed:
        if not isinstance(name, str) or name not in known:
            raise InputError("wrt", "", name, f"one of {', '.join(known)}")
    if not listed:
        raise InputError("wrt", "names nothing", wrt, f"some of {', '.join(known)}")
    return tuple(dict.fromkeys(listed))


def read_tangent(tangent: Any, wrt: Sequence[Name]) -> Mapping[Name, Any]:
    """Return arrays by the names of groups; an array alone is that of the one group that was asked for.

    Raises
    ------
    InputError
        When a name was not asked for, or an array stands alone for several.
    """
    if not isinstance(tangent, Mapping):
        if len(wrt) > 1:
            raise InputError("tangent", "", tangent, f"a mapping of some of {', '.join(wrt)} to arrays")
        return {wrt[0]: tangent}
    for name in tangent:
        check_asked(name, wrt)
    return tangent


def check_asked(name: Any, wrt: Sequence[str]) -> None:
    """Refuse a group that was not asked for.

    Raises
    ------
    InputError
    """
    if name not in wrt:
        raise InputError("wrt", "was not asked for", name, f"one of {', '.join(wrt)}")


class PerGroup(Mapping[Name, Value]):
    """What is computed for a group of parameters when it is first asked for."""

    def __init__(self, names: Sequence[Name], compute: Callable[[Name], Value]) -> None:
        self._names, self._compute, self._known = names, compute, dict[Name, Value]()

    def __getitem__(self, name: Name) -> Value:
        check_asked(name, self._names)
        if name not in self._known:
            self._known[name] = self._compute(name)
        return self._known[name]

    def __iter__(self) -> Iterator[Name]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
