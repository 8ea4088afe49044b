"""Where compiled kernels are kept: one folder for a user and a machine, a file for each kernel and signature.

Numba's own cache looks at one file only and misses a change in a callee that lives in another; and two processes that
compile one function for two signatures at once may give both the same file. Here the name of a file tells all that it
depends on: every source that is imported, what compiled it (`sources`), and what processor it was compiled for. It
comes to be by renaming, and is read only if it is what was written. So checkouts and environments share one store.
"""

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from numba import typeof
from numba.core import serialize
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult

from sinuous.base.system import places, writable
from sinuous.kernels.compile.locks import locked
from sinuous.kernels.compile.sources import COMPILER, NAME_LENGTH, sources_hash, stamp_of, unchanged
from sinuous.kernels.compile.targets import Processor, shipped

if COMPILER == "linked":
    from sinuous.kernels.compile.once import LIBRARIES, LoweredKernel, Whole, as_was

MAY_FAIL = () if COMPILER == "linked" else (Exception,)
"""What a Numba that was not tried may do: then its code is not kept."""

KEPT_DAYS = 30
"""How long a file is kept that nobody uses."""

MOST_BYTES = 1_000_000_000
"""Size of the store; beyond that, what was used longest ago goes first."""

DAY = 86400
"""Seconds between two looks whether files are old; and between two notes that one is used."""

PART, CODE = ".part", ".code"
"""What the names of files end in: of kernels that others link, and of machine code."""

DIGEST_SIZE = hashlib.sha256().digest_size


def find_cache() -> Path:
    """Return the folder of the store: the first place that can be written to."""
    candidates = places("kernels")
    for directory in candidates:
        if writable(directory):
            return directory
    return candidates[0]


CACHE = find_cache()

COPIES: dict[tuple[str, str], Callable[..., Any]] = {}
"""Kernels that are copied into their callers, by module and qualified name: their own files do not have them."""

ENTRIES: dict[tuple[str, str], Any] = {}
"""Entries by module and qualified name: what a helper is asked to compile."""


def begun() -> bool:
    """Say whether an entry of these sources has been compiled: then most of what entries share has been, too."""
    return (CACHE / f"{sources_hash()}.begun").exists()


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
    module, called : str
        Where the function is found in Python.
    """

    def __init__(self, function: Callable[..., Any], kind: str, file: str | None = None) -> None:
        self._function, self._folder, self._kind = function, CACHE, kind
        self._machine_code = COMPILER == "numba" or issubclass(LIBRARIES[kind], Whole)
        self._file = file or function.__code__.co_filename
        self.module, self.called = function.__module__, function.__qualname__
        told = f"{kind} {self.module} {self.called} {stamp_of(self._file)}"
        self.name = f"{kind}{hashlib.sha256(told.encode()).hexdigest()[:NAME_LENGTH]}"

    @property
    def cache_path(self) -> str:
        """Where the files are."""
        return str(self._folder)

    def usable(self) -> bool:
        """Say whether other processes would find here what they compile for this one."""
        return unchanged(self._file) and os.access(self._folder, os.W_OK)

    @contextlib.contextmanager
    def alone(self, signature: Any, codegen: Any) -> Iterator[None]:
        """Let no other process compile this meanwhile; wait for one that does."""
        path = self.path(signature, codegen)
        if self.find(signature, codegen).exists():
            yield
        else:
            with locked(self._folder / "lock", path.name):
                yield

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the code for a signature with all that it calls, or `None` where it is not there as it was written."""
        with contextlib.suppress(*MAY_FAIL):
            return self._load(signature, context)
        return None

    def _load(self, signature: Any, context: Any) -> Any:
        path = self.find(signature, context.codegen())
        data = _read(path) if unchanged(self._file) else None
        if data is None:
            return None
        called, reduced = pickle.loads(data)
        parts = [_part(*one) for one in called or ()]
        if None in parts:
            return None
        if COMPILER == "numba":
            context.refresh()  # as its own cache does: code of its own calls what is registered then
        result = CompileResult._rebuild(context, *reduced)
        if called is not None:
            as_was(result.library, self._kind, parts)
            self._sign(result)
        return result

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the code for a signature, where that can be done."""
        with contextlib.suppress(*MAY_FAIL):
            self._save(signature, result)

    def _save(self, signature: Any, result: Any) -> None:
        library = result.library
        called = None
        if COMPILER == "linked" and isinstance(library, LoweredKernel | Whole):
            self._sign(result)
            called = [getattr(part, "origin", None) for part in library.parts]
        if library.has_dynamic_globals or None in (called or ()):
            return
        if not unchanged(self._file):
            tell("sources were changed while this program ran; what it compiles of them is not kept")
            return
        data = serialize.dumps((called, result._reduce()))
        _keep(self.path(signature, result.codegen), hashlib.sha256(data).digest() + data)
        if self._kind == "entry":
            with contextlib.suppress(OSError):
                (self._folder / f"{sources_hash()}.begun").touch()

    def find(self, signature: Any, codegen: Any) -> Path:
        """File of the code for a signature, where there is one, also among what is shipped; else where it would be."""
        own = self.path(signature, codegen)
        if self._machine_code and not own.exists():
            for folder, target in shipped():
                path = folder / self._file_name(signature, target)
                if path.exists():
                    return path
        return own

    def path(self, signature: Any, codegen: Any) -> Path:
        """File in the store of the code for a signature, for this processor."""
        return self._folder / self._file_name(signature, _processor_of(codegen))

    def _file_name(self, signature: Any, target: Processor) -> str:
        """Name of a file; what is linked by others is the same for all processors, only the rest is machine code."""
        suffix, processor = (CODE, [target.cpu, target.features]) if self._machine_code else (PART, "")
        told = f"{self.name} {signature} {target.triple} {processor}"
        return f"{self._function.__name__}.{hashlib.sha256(told.encode()).hexdigest()[: 2 * NAME_LENGTH]}{suffix}"

    def _sign(self, result: Any) -> None:
        """Write on a part by which name others find it again."""
        function = self._function
        named = function.__module__, function.__qualname__
        result.library.origin = (*named, result.signature.args, result.fndesc.mangled_name)


@cache
def _processor_of(codegen: Any) -> Processor:
    """Return what machine code is made for; LLVM takes a while to tell."""
    return Processor(*codegen.magic_tuple())


def tell(text: str) -> None:
    """Say something on standard error, once in a process."""
    if text not in _told:
        _told.add(text)
        print(f"sinuous: {text}", file=sys.stderr, flush=True)  # noqa: T201


_told: set[str] = set()


def clear(folder: Path) -> int:
    """Remove all files of a store; return how many kernels there were."""
    count = 0
    for _, _, file in list(_files_in(folder)):
        with contextlib.suppress(OSError):
            file.unlink()
            count += file.suffix in (PART, CODE)
    return count


def size_of(folder: Path) -> tuple[int, int]:
    """Count the files of a store, and their bytes."""
    sizes = [size for _, size, _ in _files_in(folder)]
    return len(sizes), sum(sizes)


def remove_old(folder: Path, most: int = MOST_BYTES) -> None:
    """Remove the files that nobody has used for `KEPT_DAYS`, and of the rest the oldest, until so much is left."""
    total = 0
    for used, size, file in sorted(_files_in(folder), key=lambda one: -one[0]):
        total += size
        if total > most or used < time.time() - KEPT_DAYS * DAY:
            with contextlib.suppress(OSError):
                file.unlink()


def _files_in(folder: Path) -> Iterator[tuple[float, int, Path]]:
    """When each file was used, its size, and where it is; also what a process left that was killed as it wrote."""
    for file in (*folder.glob(f"*{CODE}*"), *folder.glob(f"*{PART}*"), *folder.glob("*.begun")):
        with contextlib.suppress(OSError):
            found = file.stat()
            yield found.st_mtime, found.st_size, file


def _part(module: str, name: str, types: tuple[Any, ...], symbol: str) -> Any:
    """Code of an inner kernel for these types, under this symbol; `None` where there is no such kernel."""
    function = COPIES.get((module, name)) or getattr(sys.modules.get(module), name, None)
    if function is None:
        return None
    kernel = typeof(function).dispatcher
    kernel.compile(types)
    found = kernel.overloads[types]
    return found.library if found.fndesc.mangled_name == symbol else None


def _read(path: Path) -> bytes | None:
    """Return what was written under this name, and note that it is used; `None` where it is not whole, or not there."""
    try:
        written = path.read_bytes()
        if time.time() - path.stat().st_mtime > DAY:
            with contextlib.suppress(OSError):  # what is shipped may not be written to
                os.utime(path)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        tell(f"compiled code cannot be read from {path.parent}: {error.strerror}")
        return None
    digest, data = written[:DIGEST_SIZE], written[DIGEST_SIZE:]
    if hashlib.sha256(data).digest() != digest:
        tell(f"{path} is damaged, and compiled again")
        return None
    return data


def _keep(path: Path, data: bytes) -> None:
    """Write a file, where that can be done, and once a day look for old ones."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _write(path, data)
        swept = path.parent / "swept"
        if not swept.exists() or time.time() - swept.stat().st_mtime > DAY:
            swept.touch()
            remove_old(path.parent)
    except OSError as error:
        tell(f"compiled code cannot be kept in {path.parent}: {error.strerror}")


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
