"""Where compiled kernels are kept: one file for each kernel and signature, in a folder named by a hash of all sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another; and two processes that
compile one function for two signatures at once may give both the same file. Here the name of a file tells all that it
depends on, every source that is imported among it; it comes to be by renaming, and is read only if it is what was
written. What a change of the sources does not concern is taken over from the folders of earlier ones.
"""

import contextlib
import hashlib
import os
import pickle
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core import serialize
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult

from sinuous.caches import places, writable
from sinuous.kernels.compiling.once import Part, as_part
from sinuous.kernels.compiling.sources import NAME_LENGTH, PACKAGE, sources_hash, stamp_of

KEPT_DAYS = 7
"""How long a cache is kept that nobody uses."""

DIGEST_SIZE = hashlib.sha256().digest_size


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
    for old in caches_in(folder):
        with contextlib.suppress(OSError):
            if time.time() - old.stat().st_mtime > KEPT_DAYS * 86400:
                shutil.rmtree(old, ignore_errors=True)


def caches_in(folder: Path) -> list[Path]:
    """List what is named as caches are, in a folder that others may use too."""
    return list(folder.glob("[0-9a-f]" * NAME_LENGTH))


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
    file : str, optional
        On which the code depends, with all that it imports; by default the file of the function.

    Attributes
    ----------
    name : str
        Of the function, the same in every process.
    """

    def __init__(self, function: Callable[..., Any], kind: str, file: str | None = None) -> None:
        self._function, self._folder = function, CACHE
        stamp = stamp_of(file or function.__code__.co_filename)
        told = f"{kind} {function.__module__} {function.__qualname__} {stamp}"
        self.name = f"{kind}{hashlib.sha256(told.encode()).hexdigest()[:NAME_LENGTH]}"

    @property
    def cache_path(self) -> str:
        """Where the files are."""
        return str(self._folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the code for a signature with all that it calls, or `None` where it is not there as it was written."""
        written = self._read(self._path(signature, context.codegen()))
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
        _keep(self._path(signature, result.codegen), hashlib.sha256(data).digest() + data)

    def _read(self, path: Path) -> bytes:
        """Return what was written under this name, or nothing; what an earlier folder has is taken over."""
        with contextlib.suppress(OSError):
            return path.read_bytes()
        for older in caches_in(path.parent.parent):
            with contextlib.suppress(OSError):
                written = (older / path.name).read_bytes()
                _keep(path, written)
                return written
        return b""

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


def _keep(path: Path, data: bytes) -> None:
    """Write a file, where that can be done."""
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        _write(path, data)


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
