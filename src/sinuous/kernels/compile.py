"""Compile the kernels with Numba, and cache the machine code by the text of their sources.

Numba's own cache looks at one file only and misses a change in a callee that lives in another. Here the directory of the
cache is named by a hash of every kernel's source, so that a change anywhere compiles everything anew, once.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import config as numba_config

config: Any = numba_config  # its settings are made at run time, which a type checker does not see

Function = TypeVar("Function", bound=Callable[..., Any])


OPTIONS: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
    "_nrt": False,
}


def _sources_hash() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info}".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _user_cache() -> Path:
    if "XDG_CACHE_HOME" in os.environ:
        return Path(os.environ["XDG_CACHE_HOME"])
    return Path.home() / ".cache"


def _writable(directory: Path) -> bool:
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            return True
    except OSError:
        return False


def _find_cache() -> Path:
    name = _sources_hash()
    candidates = [
        Path(__file__).parent / "__pycache__" / name,
        _user_cache() / "sinuous" / name,
        Path(tempfile.gettempdir()) / f"sinuous-{os.getuid() if hasattr(os, 'getuid') else 0}" / name,
    ]
    return next((directory for directory in candidates if _writable(directory)), candidates[-1])


CACHE = _find_cache()


def kernel(function: Function) -> Function:
    """Compile `function` in nopython mode: without the GIL, with NaN and infinity exact, cached on disk.

    Of the fast-math flags `contract` alone is on: it allows fused multiply-add and never changes what NaN does. Kernels own no
    memory (`_nrt=False`): counting references to arrays took longer than the arithmetic. Callers bring the workspace.
    """
    configured = config.CACHE_DIR
    config.CACHE_DIR = str(CACHE)
    try:
        compiled: Function = numba.njit(**OPTIONS)(function)
    finally:
        config.CACHE_DIR = configured
    return compiled


def announce(entry: Callable[..., Any]) -> None:
    """Say on standard error that the kernels are about to be compiled, when `entry` is not in the cache yet."""
    if not any(CACHE.rglob(f"*.{entry.__name__}-*.nbi")):
        print("sinuous: compiling the kernels, once on this machine (about 20 s)", file=sys.stderr, flush=True)  # noqa: T201


def inline(compiled: Function) -> Function:
    """The same kernel, copied into its caller: for the one place of the innermost loop that calls it.

    A call hands over every array by its parts, some hundred numbers; that took longer than the arithmetic.
    """
    options = {**OPTIONS, "cache": False, "forceinline": True}
    copied: Function = numba.njit(**options)(compiled.py_func)  # type: ignore[attr-defined]
    return copied
