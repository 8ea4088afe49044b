"""Where compiled kernels are kept: one file for each kernel and signature, in a folder named by a hash of all sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another; and two processes that
compile one function for two signatures at once may give both the same file. Here a change anywhere compiles everything
anew, once; the name of a file tells all that it depends on; it comes to be by renaming, and is read only if it is what
was written.
"""

import contextlib
import hashlib
import os
import pickle
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core import serialize
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult

from sinuous.caches import places, writable
from sinuous.kernels.compiling.once import Part, as_part

PACKAGE = Path(__file__).parents[2]

NAME_LENGTH = 16
"""Letters of the name of a cache."""

KEPT_DAYS = 7
"""How long a cache is kept that nobody uses."""

DIGEST_SIZE = hashlib.sha256().digest_size


def sources() -> list[Path]:
    """All files with kernels in them: here, and in the folders of the methods."""
    return sorted([*(PACKAGE / "kernels").rglob("*.py"), *(PACKAGE / "methods").rglob("*.py")])


def sources_hash() -> str:
    """Name of the cache: a hash of all sources, and of what compiles them."""
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__} {sys.version_info}".encode())
    for source in sources():
        digest.update(source.read_bytes())
    return digest.hexdigest()[:NAME_LENGTH]


def find_cache() -> Path:
    """Return the folder of the cache, made if it was not there: beside the sources, where that can be written to."""
    name = sources_hash()
    candidates = [PACKAGE / "kernels" / "__pycache__" / name, *places(name)]
    for directory in candidates:
        fresh = not directory.is_dir()
        if writable(directory):
            with contextlib.suppress(OSError):
                os.utime(directory)
            if fresh:
                remove_old(directory.parent)
            return directory
    return candidates[-1]


def remove_old(folder: Path) -> None:
    """Remove the caches in a folder that no process has begun to use for `KEPT_DAYS`: of other versions of the sources.

    Not younger ones: other environments of the same user share the folder, and a running process writes into its own.
    """
    for old in folder.iterdir():
        named = len(old.name) == NAME_LENGTH and set(old.name) <= set("0123456789abcdef")
        with contextlib.suppress(OSError):
            if named and time.time() - old.stat().st_mtime > KEPT_DAYS * 86400:
                shutil.rmtree(old, ignore_errors=True)


CACHE = find_cache()

KERNELS: dict[tuple[str, str], Any] = {}
"""Inner kernels by module and qualified name: what a kernel that is read from the disk calls."""


class Store(NullCache):
    """The compiled code of one function on disk, in the place of Numba's cache.

    Parameters
    ----------
    function : callable
    kind : str
        Of the code: a kernel is kept apart from an entry that is made of the same function.

    Attributes
    ----------
    name : str
        Of the function, the same in every process.
    """

    def __init__(self, function: Callable[..., Any], kind: str) -> None:
        self._function, self._folder = function, CACHE
        told = f"{self._folder.name} {kind} {function.__module__} {function.__qualname__} {_stamp(function)}"
        self.name = f"{kind}{hashlib.sha256(told.encode()).hexdigest()[:NAME_LENGTH]}"

    @property
    def cache_path(self) -> str:
        """Where the files are."""
        return str(self._folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the code for a signature with all that it calls, or `None` where it is not there as it was written."""
        try:
            written = self._path(signature, context.codegen()).read_bytes()
        except OSError:
            return None
        digest, data = written[:DIGEST_SIZE], written[DIGEST_SIZE:]
        if hashlib.sha256(data).digest() != digest:
            return None
        context.refresh()
        called, reduced = pickle.loads(data)
        parts = [_part(*one) for one in called or ()]
        if None in parts:
            return None
        result = CompileResult._rebuild(context, *reduced)
        if called is not None:
            as_part(result.library, parts)
            self._sign(result)
        return result

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the code for a signature, where that can be done."""
        library = result.library
        called = None
        if isinstance(library, Part):
            self._sign(result)
            called = [getattr(part, "origin", None) for part in library.parts]
        if library.has_dynamic_globals or None in (called or ()):
            return
        data = serialize.dumps((called, result._reduce()))
        path = self._path(signature, result.codegen)
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            _write(path, hashlib.sha256(data).digest() + data)

    def _path(self, signature: Any, codegen: Any) -> Path:
        told = f"{self.name} {signature} {codegen.magic_tuple()}"
        digest = hashlib.sha256(told.encode()).hexdigest()[: 2 * NAME_LENGTH]
        return self._folder / f"{self._function.__name__}.{digest}.code"

    def _sign(self, result: Any) -> None:
        """Write on a part by which name others find it again."""
        function = self._function
        named = function.__module__, function.__qualname__
        result.library.origin = (*named, result.signature.args, result.fndesc.mangled_name)


def _part(module: str, name: str, types: tuple[Any, ...], symbol: str) -> Any:
    """Code of an inner kernel for these types, under this symbol; `None` where there is no such kernel."""
    kernel = KERNELS.get((module, name))
    if kernel is None:
        return None
    kernel.compile(types)
    found = kernel.overloads[types]
    return found.library if found.fndesc.mangled_name == symbol else None


def _stamp(function: Callable[..., Any]) -> str:
    """Hash of the file of a function that is not among the sources, which the name of the cache does not cover."""
    file = Path(function.__code__.co_filename)
    return "" if file.is_relative_to(PACKAGE) else _hash_of(file)


@cache
def _hash_of(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def _write(path: Path, data: bytes) -> None:
    """Write a file that is there in full or not at all."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f"{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
