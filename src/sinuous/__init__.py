"""Inverse kinematics and motion of continuum robots among obstacles.

Names are imported when they are first used, so that `import sinuous` costs next to nothing. Those that users type, and
their modules, are listed in the stub beside this file, which type checkers read, too. The options of methods are in
`sinuous.methods`; classes that are only returned are in their modules, like `sinuous.model.rates.Changes`.
"""

import pathlib
import re
from importlib import import_module
from typing import Any

from sinuous.base.notebook import NotebookMixin

__version__ = "0.2.0"

_STUB = pathlib.Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_HOME = {name: home for home, name in re.findall(r"^from (sinuous\.\S+) import (\w+)", _STUB, re.MULTILINE)}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    if name in ("files", "methods"):
        return import_module(f"sinuous.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'sinuous' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    import_module("sinuous.base.signatures").make_readable(value)
    globals()[name] = value
    return value


def _html(noun: Any) -> str:
    return import_module("sinuous.view.pictures.html").html(noun)


NotebookMixin._html_renderer = _html


def __dir__() -> list[str]:
    return sorted([*__all__, "files", "methods"])
