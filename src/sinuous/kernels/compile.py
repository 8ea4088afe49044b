"""Compile the kernels with Numba, and cache the machine code by the text of their sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another. Here the directory of
the cache is named by a hash of every kernel's source, so that a change anywhere compiles everything anew, once. All
kernels are cached, not entries alone: an entry that is compiled later finds there what it calls.
"""

import contextlib
import gc
import hashlib
import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import config as numba_config

from sinuous.caches import places, writable

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
        collecting = gc.isenabled()
        gc.disable()
        try:
            return compile_it(signature)
        finally:
            if collecting:
                gc.enable()

    compiled.compile = compile_quickly
    return compiled


def entry(function: Function) -> Function:
    """Compile a kernel that Python calls."""
    return _cached(function, CACHE, {"no_cfunc_wrapper": True})


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


def announce(compiled: Callable[..., Any]) -> None:
    """Say on standard error that the kernels are about to be compiled, when an entry is not in the cache yet.

    It is said once a process, and for all that a solve may need.
    """
    loaded: bool = bool(compiled.signatures)  # type: ignore[attr-defined]
    *_, folder, module = compiled.__module__.split(".")
    if not loaded and not _announced and not any(CACHE.glob(f"{folder}_*/{module}.{compiled.__name__}-*.nbi")):
        _announced.append(module)
        print(NOTICE, file=sys.stderr, flush=True)  # noqa: T201


NOTICE = "sinuous: compiling the kernels, once on this machine (about 20 s, among obstacles about 40 s)"

_announced: list[str] = []
