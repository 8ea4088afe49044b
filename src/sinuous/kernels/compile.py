"""Compile the kernels with Numba, and cache the machine code by the text of their sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another. Here the directory of
the cache is named by a hash of every kernel's source, so that a change anywhere compiles everything anew, once.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import config as numba_config

from sinuous.caches import places, writable

config: Any = numba_config  # its settings are made at run time, which a type checker does not see

Function = TypeVar("Function", bound=Callable[..., Any])


ALL_CALLABLE = "SINUOUS_ALL_KERNELS_CALLABLE" in os.environ
"""Set for tests, which call every kernel from Python. Wrappers for that take a third of the time of compiling."""

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}, "_nrt": False}
"""Without the GIL; NaN and infinity exact. Of the fast-math flags `contract` alone is on: it allows fused multiply-add
and never changes what NaN does. Kernels own no memory (`_nrt`): counting references to arrays took longer than the
arithmetic. Callers bring the workspace, and no kernel returns an array."""

NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def _sources() -> list[Path]:
    """All files with kernels in them: here, and in the folders of the methods."""
    package = Path(__file__).parents[1]
    return sorted([*(package / "kernels").rglob("*.py"), *(package / "methods").rglob("*.py")])


def _sources_hash() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info} {ALL_CALLABLE}".encode())
    for source in _sources():
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _find_cache() -> Path:
    name = _sources_hash()
    candidates = [Path(__file__).parent / "__pycache__" / name, *places(name)]
    return next((directory for directory in candidates if writable(directory)), candidates[-1])


CACHE = _find_cache()


def entry(function: Function) -> Function:
    """Compile a kernel that Python calls, and cache it on disk with all that it calls."""
    configured = config.CACHE_DIR
    config.CACHE_DIR = str(CACHE)
    try:
        compiled: Function = numba.njit(cache=True, **OPTIONS)(function)
    finally:
        config.CACHE_DIR = configured
    return compiled


def kernel(function: Function) -> Function:
    """Compile a kernel that other kernels call."""
    if ALL_CALLABLE:
        return entry(function)
    options: dict[str, Any] = {**OPTIONS, **NO_WRAPPERS}
    compiled: Function = numba.njit(**options)(function)
    return compiled


def inline(compiled: Function) -> Function:
    """The same kernel, copied into its caller: for the one place of the innermost loop that calls it.

    A call hands over every array by its parts, some hundred numbers; that took longer than the arithmetic.
    """
    options: dict[str, Any] = {**OPTIONS, **NO_WRAPPERS, "forceinline": True}
    copied: Function = numba.njit(**options)(compiled.py_func)  # type: ignore[attr-defined]
    return copied


def closure(function: Function) -> Function:
    """Compile a kernel that is made around another kernel, as a function within a function.

    It is copied into the entries that call it, before they are compiled, and cached with them. By itself it cannot be
    cached: another process would not recognise the kernel that it was made around.
    """
    options: dict[str, Any] = {**OPTIONS, **NO_WRAPPERS, "inline": "always"}
    compiled: Function = numba.njit(**options)(function)
    return compiled


def announce(compiled: Callable[..., Any]) -> None:
    """Say on standard error that the kernels are about to be compiled, when an entry is not in the cache yet."""
    loaded: bool = bool(compiled.signatures)  # type: ignore[attr-defined]
    name = f"{compiled.__module__.rpartition('.')[2]}.{compiled.__name__}"
    if not loaded and not any(CACHE.rglob(f"{name}-*.nbi")):
        print("sinuous: compiling the kernels, once on this machine (about 20 s)", file=sys.stderr, flush=True)  # noqa: T201
