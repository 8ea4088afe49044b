"""Compile the kernels with Numba, and cache the machine code by the text of their sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another. Here the directory of
the cache is named by a hash of every kernel's source, so that a change anywhere compiles everything anew, once. All
kernels are cached, not entries alone: an entry that is compiled later finds there what it calls.
"""

import contextlib
import hashlib
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numba
from numba import types
from numba.core import config as numba_config

from sinuous.caches import places, writable
from sinuous.garbage import uncollected

config: Any = numba_config  # its settings are made at run time, which a type checker does not see

Function = TypeVar("Function", bound=Callable[..., Any])


OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}, "_nrt": False}
"""Without the GIL; NaN and infinity exact. Of the fast-math flags `contract` alone is on: it allows fused multiply-add
and never changes what NaN does. Kernels own no memory (`_nrt`): counting references to arrays took longer than the
arithmetic. Callers bring the workspace, and no kernel returns an array."""

NAME_LENGTH = 16
"""Letters of the name of a cache."""

KEPT_DAYS = 7
"""How long a cache is kept that nobody uses."""

INNER = "inner"
"""Folder in the cache for kernels without wrappers: Python would crash if it found one of them in the place of the same
kernel with them."""

NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def _sources() -> list[Path]:
    """All files with kernels in them: here, and in the folders of the methods."""
    package = Path(__file__).parents[1]
    return sorted([*(package / "kernels").rglob("*.py"), *(package / "methods").rglob("*.py")])


def _sources_hash() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info}".encode())
    for source in _sources():
        digest.update(source.read_bytes())
    return digest.hexdigest()[:NAME_LENGTH]


def _find_cache() -> Path:
    name = _sources_hash()
    candidates = [Path(__file__).parent / "__pycache__" / name, *places(name)]
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


CACHE = _find_cache()


def _cached(function: Function, folder: Path, options: dict[str, Any]) -> Function:
    """Compile a function, and cache it in a folder."""
    configured = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        compiled: Function = numba.njit(cache=True, **OPTIONS, **options)(function)
    finally:
        config.CACHE_DIR = configured
    return _quickened(compiled)


def _quickened(compiled: Any) -> Any:
    """Let a function be compiled once for all whole numbers, not for each constant; and without collecting garbage."""
    compile_it = compiled.compile

    def compile_quickly(signature: Any) -> Any:
        if isinstance(signature, tuple):
            signature = tuple(types.unliteral(each) for each in signature)  # type: ignore[no-untyped-call]
        with uncollected():
            return compile_it(signature)

    compiled.compile = compile_quickly
    return compiled


def entry(function: Function) -> Function:
    """Compile a kernel that Python calls."""
    compiled: Function = _telling(_cached(function, CACHE, {"no_cfunc_wrapper": True}))
    return compiled


def kernel(function: Function) -> Function:
    """Compile a kernel that other kernels call. It cannot be called from Python: the wrapper for that costs time."""
    return _cached(function, CACHE / INNER, NO_WRAPPERS)


def inline(compiled: Function) -> Function:
    """The same kernel, copied into its caller: for the one place of the innermost loop that calls it.

    A call hands over every array by its parts, some hundred numbers; that took longer than the arithmetic.
    """
    options: dict[str, Any] = {**OPTIONS, **NO_WRAPPERS, "forceinline": True}
    copied: Any = numba.njit(**options)(compiled.py_func)  # type: ignore[attr-defined]
    return _quickened(copied)


def closure(function: Function) -> Function:
    """Compile a kernel that is made around another kernel, as a function within a function.

    It is copied into the entries that call it, before they are compiled, and cached with them. By itself it cannot be
    cached: another process would not recognise the kernel that it was made around.
    """
    options: dict[str, Any] = {**OPTIONS, **NO_WRAPPERS, "inline": "always"}
    compiled: Function = numba.njit(**options)(function)
    return compiled


class Piece(NamedTuple):
    """Entries that are compiled for one purpose.

    Attributes
    ----------
    what : str
        The purpose, in the words of the user.
    seconds : int
        About how long compiling takes, on two cores that nobody else uses, after what stands before it in `PIECES`.
    entries : tuple of str
        Module within the package, and name.
    """

    what: str
    seconds: int
    entries: tuple[str, ...]


PIECES = (
    Piece("single solves", 50, ("kernels.solve.search.search",)),
    Piece(
        "routes among obstacles",
        25,
        (
            "kernels.fitting.query.route_query",
            "kernels.freespace.find.find_routes",
            "kernels.freespace.lengthen.lengthen_route",
            "kernels.fitting.fit.fit_route",
        ),
    ),
    Piece("batches of solves", 4, ("kernels.solve.search.search_many",)),
    Piece("preferences", 9, ("kernels.solve.preferences.prefer",)),
    Piece(
        "kinematics",
        1,
        tuple(f"kernels.chain.batch.{name}" for name in ("frames_of", "points_of", "jacobians_of")),
    ),
    Piece(
        "distances",
        3,
        (
            "kernels.fields.distances.many",
            "kernels.fields.distances.least_gap",
            "kernels.fields.trees.arrange",
            "kernels.fields.trees.enclose",
            "kernels.fields.solids.enclose",
            "kernels.fields.solids.sample",
        ),
    ),
    Piece(
        "classes of routes",
        6,
        tuple(f"kernels.freespace.homotopy.{name}" for name in ("draw_tight", "deforms", "halfway", "see")),
    ),
    Piece("the method opti_path", 25, ("methods.opti_path.search.search", "methods.opti_path.potential.sample")),
    Piece("the method dls", 6, ("methods.dls.search.search",)),
    Piece("the methods fabrikc and fabrikx", 8, ("methods.fabrik.search.search",)),
    Piece("the method slinki", 10, ("methods.slinki.search.search",)),
    Piece("the method fabrik_avoid", 6, ("methods.fabrik_avoid.search.search",)),
    Piece("the method monte_carlo", 6, ("methods.monte_carlo.search.search",)),
)
"""All that is compiled, what most users need first."""

SHORT = 2
"""Seconds from which on a person should know what takes so long."""


def _telling(compiled: Any) -> Any:
    """Let an entry tell when it is about to be compiled: when Numba has asked the cache for it in vain."""
    piece = next((piece for piece in PIECES if name_of(compiled) in piece.entries), None)
    load = compiled._cache.load_overload

    def load_or_tell(signature: Any, context: Any) -> Any:
        found = load(signature, context)
        if found is None and piece is not None and piece not in _told:
            _told.append(piece)
            _tellers[-1](piece)
        return found

    compiled._cache.load_overload = load_or_tell
    return compiled


def name_of(compiled: Any) -> str:
    """Name of an entry as `PIECES` has it."""
    return f"{compiled.__module__.partition('.')[2]}.{compiled.__name__}"


def _print(piece: Piece) -> None:
    """Say on standard error what is about to be compiled, and how long that takes."""
    if piece.seconds > SHORT:
        hint = "; 'sinuous warm' compiles everything ahead" if len(_told) == 1 else ""
        text = f"sinuous: compiling {piece.what}, once on this machine (about {piece.seconds} s){hint}"
        print(text, file=sys.stderr, flush=True)  # noqa: T201


@contextlib.contextmanager
def told_to(teller: Callable[[Piece], None]) -> Iterator[None]:
    """Call `teller` with each piece that is about to be compiled, instead of saying it on standard error."""
    _tellers.append(teller)
    try:
        yield
    finally:
        _tellers.pop()


_told: list[Piece] = []
_tellers: list[Callable[[Piece], None]] = [_print]
