"""Entrances of packages: public names are imported when they are first used, so `import sinuous` costs next to nothing.

What a package offers stands in its `__init__.py`, by the module that it is in; the stub beside it says the same to type
checkers. Names and modules that have moved go on working, and warn.

A room imports only from rooms that docs/design.md lists before it, also for types. A method of a noun that needs a
later one, as `robot.to_urdf()` needs an exporter, imports it when it is called, by `import_late`; its types come from
the front door, `sinuous`.
"""

import sys
import warnings
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import MethodType
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from importlib.abc import Loader


def entrance(
    package: str, homes: Mapping[str, str], packages: str = "", moved: Mapping[str, str] | None = None
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package.

    Parameters
    ----------
    package : str
    homes : mapping of str to str
        Public names, separated by blanks, by the module that has them.
    packages : str
        Packages within it that are public as a whole.
    moved : mapping of str to str, optional
        Names that were public here, by the package that they are in now.
    """
    of_name = {name: home for home, names in homes.items() for name in names.split()}
    new_home = {name: home for home, names in (moved or {}).items() for name in names.split()}
    inner = packages.split()

    def meant(name: str) -> str:
        hint = None if name.startswith("_") else import_module("sinuous.base.errors").guessed(name, [*of_name, *inner])
        return f"; {hint}" if hint else ""

    def resolve(name: str) -> Any:
        if name in inner:
            return import_module(f"{package}.{name}")
        if name in new_home:
            warn_moved(f"{package}.{name}", f"{new_home[name]}.{name}", 2)
            return getattr(import_module(new_home[name]), name)
        if name not in of_name:
            raise AttributeError(f"module {package!r} has no attribute {name!r}" + meant(name))
        value = getattr(import_module(of_name[name]), name)
        import_module("sinuous.base.signatures").make_readable(value)
        value = import_module("sinuous.base.errors").explain_keywords(value)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *of_name, *inner})

    return resolve, names, list(of_name)


def warn_moved(old: str, new: str, level: int) -> None:
    """Say by a `DeprecationWarning` where something is now; `level` as in `warnings.warn`."""
    warnings.warn(f"{old} is {new} now", DeprecationWarning, stacklevel=level + 1)


class Renamed:
    """An attribute that goes on working under its old name, with a warning."""

    def __init__(self, new: str) -> None:
        self._new = new

    def __set_name__(self, owner: type, name: str) -> None:
        self._old = f"{owner.__name__}.{name}"

    def __get__(self, instance: Any, owner: type) -> Any:
        found = getattr(owner if instance is None else instance, self._new)
        if instance is None and not isinstance(found, MethodType):  # somebody looks at the class
            return self
        place = "private" if self._new.startswith("_") else f"{owner.__name__}.{self._new}"
        warn_moved(self._old, place, 2)
        return found


class MovedModules:
    """Finds modules under names that they had before: `import sinuous.robot.rates` imports `sinuous.model.rates`.

    Parameters
    ----------
    moved : mapping of str to str
        New names of packages and modules by old ones.
    """

    def __init__(self, moved: Mapping[str, str]) -> None:
        self._moved = moved

    def find_spec(self, name: str, path: Iterable[str] | None = None, target: Any = None) -> ModuleSpec | None:
        """Find a module that has moved, by itself or within a package that has."""
        inner, parts, loader = "", name, cast("Loader", self)
        while "." in parts:
            if parts in self._moved:
                return ModuleSpec(name, loader, loader_state=self._moved[parts] + inner)
            parts, _, last = parts.rpartition(".")
            inner = f".{last}{inner}"
        return None

    def create_module(self, spec: ModuleSpec) -> None:
        """Let the usual empty module be made, which `exec_module` replaces."""

    def exec_module(self, module: Any) -> None:
        """Put the module in its new place into the old one."""
        old, new = module.__name__, module.__spec__.loader_state
        warn_moved(old, new, 2)
        sys.modules[old] = import_module(new)


def import_late(module: str) -> Any:
    """Return a module of the package by its name without `sinuous.`, imported now."""
    return import_module(f"sinuous.{module}")
