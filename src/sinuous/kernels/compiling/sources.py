"""Which files the code of a kernel depends on, and hashes of them."""

import hashlib
import re
import sys
from functools import cache
from pathlib import Path

import llvmlite
import numba

PACKAGE = Path(__file__).parents[2]

NAME_LENGTH = 16
"""Letters of a hash that names something."""

IMPORT = re.compile(r"^[ \t]*(?:from (sinuous[\w.]*) import (\([^)]*\)|[^\n#]*)|import (sinuous[\w.]*))", re.MULTILINE)
"""An import of a module of the package, wherever it stands in a file."""


def sources() -> list[Path]:
    """All files with kernels in them: here, and in the folders of the methods."""
    return sorted([*(PACKAGE / "kernels").rglob("*.py"), *(PACKAGE / "methods").rglob("*.py")])


@cache
def sources_hash() -> str:
    """Hash of all sources, and of what compiles them."""
    return _hash([compilers(), *(source.read_bytes() for source in sources())])


@cache
def stamp_of(file: str) -> str:
    """Hash of what the code of a function in this file depends on: what compiles it, the file, and all that it imports.

    Of a file that is not among the sources nobody knows what it imports, so that all sources count.
    """
    texts = _texts()
    module = _module(Path(file))
    if module not in texts:
        own = Path(file).read_bytes() if Path(file).is_file() else b""
        return _hash([sources_hash().encode(), own])
    return _hash([compilers(), *(texts[name] for name in sorted(reached_from(module)))])


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
    texts = _texts()
    found: set[str] = set()
    for home, names, alone in IMPORT.findall(texts[module].decode()):
        imported = home or alone
        parts = imported.split(".")
        found.update(".".join(parts[:i]) for i in range(2, len(parts) + 1))
        found.update(f"{imported}.{name}" for name in re.findall(r"\w+", names))
    return found & texts.keys()


def compilers() -> bytes:
    """Versions of what makes code of sources."""
    return f"{numba.__version__} {llvmlite.__version__} {sys.version_info}".encode()


def _module(file: Path) -> str:
    """Name of the module in a file of the package, or of the package that its `__init__` stands for."""
    if not file.is_relative_to(PACKAGE):
        return ""
    return ".".join(("sinuous", *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")


@cache
def _texts() -> dict[str, bytes]:
    return {_module(source): source.read_bytes() for source in sources()}


def _hash(parts: list[bytes]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:NAME_LENGTH]
