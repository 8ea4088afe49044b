"""Entrances of packages: public names are imported when they are first used, so `import sinuous` costs next to nothing.

What a package offers stands in its `__init__.py`, by the module that it is in; the stub beside it says the same to type
checkers. Names that have moved go on working, and warn.

Doors of nouns lead to rooms that import them: `robot.to_urdf()` calls an exporter that the robot does not import.
A room imports only from rooms that docs/design.md lists before it, also for types. A method that is a door names the
module that does its work, which is imported when the method is called; its types come from the front door, `sinuous`.
"""

import sys
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


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

    def resolve(name: str) -> Any:
        if name in inner:
            return import_module(f"{package}.{name}")
        if name in new_home:
            warnings.warn(f"{package}.{name} is {new_home[name]}.{name} now", DeprecationWarning, stacklevel=2)
            return getattr(import_module(new_home[name]), name)
        if name not in of_name:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(of_name[name]), name)
        import_module("sinuous.base.signatures").make_readable(value)
        value = import_module("sinuous.base.errors").explain_keywords(value)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *of_name, *inner})

    return resolve, names, list(of_name)


def door(module: str) -> Any:
    """Return a module of the package by its name without `sinuous.`, imported now."""
    return import_module(f"sinuous.{module}")
