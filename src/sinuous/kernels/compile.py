"""The decorators that compile kernels with Numba: `entry` for what Python calls, `kernel` for what kernels call."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba import types

from sinuous.gc_pause import gc_paused
from sinuous.kernels.compiling import once
from sinuous.kernels.compiling.pieces import telling
from sinuous.kernels.compiling.store import KERNELS, Store

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}, "_nrt": False}
"""Without the GIL; NaN and infinity exact. Of the fast-math flags `contract` alone is on: it allows fused multiply-add
and never changes what NaN does. Kernels own no memory (`_nrt`): counting references to arrays took longer than the
arithmetic. Callers bring the workspace, and no kernel returns an array."""

NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def entry(function: Function) -> Function:
    """Compile a kernel that Python calls."""
    compiled: Function = telling(_stored(function, "entry", once.Whole, {"no_cfunc_wrapper": True}))
    return compiled


def entry_around(inner: Any, function: Function) -> Function:
    """Compile a kernel that Python calls, and that is made around the kernel `inner` as a function within a function.

    It bears the name of the module of `inner`: by that, and by what the file of `inner` imports, its code is found
    again. That file has to import the one in which the function is made.
    """
    function.__module__, function.__qualname__ = inner.__module__, function.__name__
    file = inner.py_func.__code__.co_filename
    compiled: Function = telling(_stored(function, "entry", once.Whole, {"no_cfunc_wrapper": True}, file))
    return compiled


def kernel(function: Function) -> Function:
    """Compile a kernel that other kernels call. It cannot be called from Python: the wrapper for that costs time."""
    compiled = _stored(function, "inner", once.Part, NO_WRAPPERS)
    KERNELS[function.__module__, function.__qualname__] = compiled
    return compiled


def inline(compiled: Function) -> Function:
    """The same kernel, copied into its caller: for the one place of the innermost loop that calls it.

    A call hands over every array by its parts, some hundred numbers; that took longer than the arithmetic.
    """
    function: Any = compiled.py_func  # type: ignore[attr-defined]
    own = type(function)(function.__code__, function.__globals__, f"{function.__name__}_here")
    own.__module__, own.__qualname__ = function.__module__, f"{function.__qualname__}_here"
    copied = _stored(own, "inner", once.Part, {**NO_WRAPPERS, "forceinline": True})
    KERNELS[own.__module__, own.__qualname__] = copied
    return copied


def _stored(function: Function, kind: str, library: Any, options: dict[str, Any], file: str | None = None) -> Any:
    """Compile a function into such a library, and keep its code on disk as what depends on this file and its imports.

    By default that is the file of the function. What is made around something else is kept only when a file is named.
    """
    store = None if function.__closure__ and file is None else Store(function, kind, file)
    chosen = {**OPTIONS, **options}
    if once.tried():
        chosen["pipeline_class"] = once.compiler(library, None if store is None else store.name)
    compiled: Any = numba.njit(**chosen)(function)
    if store is not None:
        compiled._cache = store
    return _quickened(compiled)


def _quickened(compiled: Any) -> Any:
    """Let a function be compiled once for all whole numbers, not for each constant; and without collecting garbage."""
    compile_it = compiled.compile

    def compile_quickly(signature: Any) -> Any:
        if isinstance(signature, tuple):
            signature = tuple(types.unliteral(each) for each in signature)  # type: ignore[no-untyped-call]
        with gc_paused():
            return compile_it(signature)

    compiled.compile = compile_quickly
    return compiled
