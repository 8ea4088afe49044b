"""Which files the code of a kernel depends on, and hashes of them.

What hangs together with machine code is what was imported, not what lies on the disk by now: somebody may switch to
another branch while a program runs. So all sources are read when the first kernel is imported, and code is kept, or
taken from the store, only if the files that it depends on are still those.
"""

import hashlib
import os
import platform
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite
import numba
from numba.core import config

PACKAGE = Path(__file__).parents[2]

VERSION = 3
"""Of how kernels are compiled, and of what is kept: raise it with `OPTIONS` of `marks`, with `once`, and
with the format of `store`. The text of these files does not count."""

TRIED = ("0.62", "0.63", "0.64", "0.65", "0.66", "0.67", "0.68")
"""Versions of Numba that `once` was tried with."""

COMPILERS = ("linked", "numba")

COMPILER = os.environ.get("SINUOUS_COMPILER") or ("linked" if numba.__version__.startswith(TRIED) else "numba")
"""How entries are compiled: linked and optimised once (`once`), or as Numba does by itself."""

if COMPILER not in COMPILERS:
    raise ValueError(f"unknown SINUOUS_COMPILER {COMPILER!r}; expected one of {', '.join(COMPILERS)}")

SETTINGS = ("OPT", "SLP_VECTORIZE", "LOOP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "USING_SVML", "DIVMOD_OPT")
"""Settings of Numba that change what it makes of sources."""

NAME_LENGTH = 16
"""Letters of a hash that names something."""

IMPORT = re.compile(r"^[ \t]*(?:from (sinuous[\w.]*) import (\([^)]*\)|[^\n#]*)|import (sinuous[\w.]*))", re.MULTILINE)
"""An import of a module of the package, wherever it stands in a file."""


class KernelFile(NamedTuple):
    """A file with kernels in it.

    Attributes
    ----------
    file : Path
    text : bytes
    state : tuple of int
        Which file it was, how large, and when it was changed last (ns).
    """

    file: Path
    text: bytes
    state: tuple[int, ...]


def sources() -> list[Path]:
    """All files with kernels in them, here and in the folders of the methods, but for those that say how to compile."""
    kernels = PACKAGE / "kernels"
    files = [*kernels.rglob("*.py"), *(PACKAGE / "methods").rglob("*.py")]
    return sorted(file for file in files if file.parent != kernels / "compile")


@cache
def sources_hash() -> str:
    """Hash of all sources, and of what compiles them."""
    return _hash([compilers(), *(source.text for source in read_sources().values())])


@cache
def stamp_of(file: str) -> str:
    """Hash of what the code of a function in this file depends on: what compiles it, the file, and all that it imports.

    Of a file that is not among the sources nobody knows what it imports, so that all sources count.
    """
    found = read_sources()
    module = _module(Path(file))
    if module not in found:
        own = Path(file).read_bytes() if Path(file).is_file() else b""
        return _hash([sources_hash().encode(), own])
    return _hash([compilers(), *(found[name].text for name in sorted(reached_from(module)))])


def unchanged(file: str) -> bool:
    """Say whether all files that a function in this file depends on are those that were read."""
    found, module = read_sources(), _module(Path(file))
    return all(_state_of(found[name].file) == found[name].state for name in _reached(module))


def text_of(file: str) -> bytes:
    """Text of a source as it was read; of another file, as it is now; nothing where there is none."""
    found = read_sources().get(_module(Path(file)))
    if found is not None:
        return found.text
    return Path(file).read_bytes() if Path(file).is_file() else b""


def reached_from(module: str) -> set[str]:
    """Return the names of a module with kernels, of those that it imports, of those that these import, and so on."""
    found, due = {module}, [module]
    while due:
        new = imported_by(due.pop()) - found
        found |= new
        due += new
    return found


@cache
def imported_by(module: str) -> set[str]:
    """Return the names of the modules with kernels that one of them imports, with the packages that they are in."""
    texts = read_sources()
    found: set[str] = set()
    for home, names, alone in IMPORT.findall(texts[module].text.decode()):
        imported = home or alone
        parts = imported.split(".")
        found.update(".".join(parts[:i]) for i in range(2, len(parts) + 1))
        found.update(f"{imported}.{name}" for name in re.findall(r"\w+", names))
    return found & texts.keys()


def compilers() -> bytes:
    """Versions and settings of what makes code of sources; of Python what compiled code sees of it."""
    python = f"{platform.python_implementation()} {sys.version_info[:2]} {getattr(sys, 'abiflags', '')}"
    numba_settings: Any = config  # made at run time
    settings = [getattr(numba_settings, name, None) for name in SETTINGS]
    version = VERSION if COMPILER == "linked" else f"{VERSION} {COMPILER}"
    return f"{version} {numba.__version__} {llvmlite.__version__} {python} {settings}".encode()


@cache
def read_sources() -> dict[str, KernelFile]:
    """Read all sources, by the names of their modules."""
    return {_module(file): KernelFile(file, file.read_bytes(), _state_of(file)) for file in sources()}


@cache
def _reached(module: str) -> tuple[str, ...]:
    """Names of the modules that count for one: all, where it is none of them."""
    return tuple(reached_from(module)) if module in read_sources() else tuple(read_sources())


def _module(file: Path) -> str:
    """Name of the module in a file of the package, or of the package that its `__init__` stands for."""
    if not file.is_relative_to(PACKAGE):
        return ""
    return ".".join(("sinuous", *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")


def _state_of(file: Path) -> tuple[int, ...]:
    try:
        found = os.stat(file)
    except OSError:
        return ()
    return found.st_ino, found.st_size, found.st_mtime_ns


def _hash(parts: list[bytes]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:NAME_LENGTH]


read_sources()
