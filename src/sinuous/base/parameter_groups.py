"""Groups of parameters that something is derived by, under their names."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Batch, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr

Name = TypeVar("Name", bound=str)
Value = TypeVar("Value")

TWIST = ("omega_x", "omega_y", "omega_z", "v_x", "v_y", "v_z")
"""What the six parameters of a small motion are called."""


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


class Column(NamedTuple):
    """One parameter: what it is called, its scale, and how a question looks after it has changed by `h`."""

    name: str
    scale: float
    changed: Any


class ByGroups(ShortRepr, Generic[Name]):
    """Derivatives of one array by groups of parameters, and the products with them.

    Parameters
    ----------
    columns : mapping of str to sequence of Column
        The parameters of each group that was asked for.
    derived : mapping of str to ndarray (..., p)
    regular : bool
    """

    def __init__(self, columns: Mapping[Name, Sequence[Column]], derived: Mapping[Name, Floats], regular: bool) -> None:
        self.wrt, self.regular = tuple(columns), regular
        self._columns, self._derived = columns, derived

    def labels(self, name: Name) -> tuple[str, ...]:
        """What the columns of a group are called."""
        check_asked(name, self.wrt)
        return tuple(column.name for column in self._columns[name])

    def vjp(self, cotangent: Batch) -> dict[Name, Floats]:
        """Derivatives (p,) by each group of the sum of the array times a cotangent of its shape.

        Raises
        ------
        InputError
            When it has another shape.
        """
        given = checks.array("cotangent", cotangent, self._shape)
        return {name: np.tensordot(given, self._derived[name], given.ndim) for name in self.wrt}

    def jvp(self, tangent: Vector | Mapping[Name, Vector]) -> Floats:
        """Motion of the array when the parameters begin to move along `tangent`; see `Derivative.jvp`.

        Raises
        ------
        InputError
            When a name was not asked for, or a tangent has another shape.
        """
        moved = np.zeros(self._shape)
        for name, value in read_tangent(tangent, self.wrt).items():
            moved += self._derived[name] @ checks.array(f"tangent[{name!r}]", value, (len(self._columns[name]),))
        return moved

    @property
    def _shape(self) -> tuple[int, ...]:
        return self._derived[self.wrt[0]].shape[:-1]

    def _shown(self) -> Iterator[str]:
        yield ", ".join(self.wrt)
        yield "regular" if self.regular else "kink"
