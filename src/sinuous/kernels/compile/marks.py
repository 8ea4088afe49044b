"""What makes kernels of functions: `entry` marks those that Python calls.

What an entry calls is a kernel, too, and needs no mark. A function of a file with kernels (see `sources`) stays the
function that it is: others call it, interpreted, as they call any; Numba is told what is compiled for it when it meets
it.
"""

import functools
import sys
from collections.abc import Callable
from contextlib import nullcontext
from types import FunctionType
from typing import Any, TypeVar

import numba
import numpy as np
from numba import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.extending import _Intrinsic
from numba.extending import typeof_impl

from sinuous.base.progress import counting_work, gc_paused, no_work
from sinuous.kernels.compile.interpreting import IN_PLACE_OF, interpret, makes_functions, plain, written
from sinuous.kernels.compile.sources import COMPILER, read_sources
from sinuous.kernels.compile.store import COPIES, Store
from sinuous.kernels.compile.tiers import MODE, tiered

if COMPILER == "linked":
    from sinuous.kernels.compile.once import KERNELS, call_leanly, compiler

Function = TypeVar("Function", bound=Callable[..., Any])

# Raise `VERSION` in `sources` with these: their text does not count for what is kept.
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
"""Without the GIL; NaN and infinity exact. Of the fast-math flags `contract` alone is on: it allows fused multiply-add
and never changes what NaN does."""

LINKED_OPTIONS: dict[str, Any] = {
    "_nrt": False,
    "forceinline": False,  # if nothing is said, Numba takes over what is said of the first caller
}
"""What Numba's manual does not have. Kernels own no memory (`_nrt`): counting references to arrays took longer than the
arithmetic. Callers bring the workspace, and no kernel returns an array."""

NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def entry(function: Function) -> Function:
    """Let Python call a kernel."""
    return _entry(function)


def entry_around(inner: Any, function: Function) -> Function:
    """Let Python call a kernel that is made around the kernel `inner` as a function within a function.

    It bears the name of the module of `inner`: by that, and by what the file of `inner` imports, its code is found
    again. That file has to import the one in which the function is made.
    """
    function.__module__, function.__qualname__ = inner.__module__, function.__name__
    return _entry(function, inner.__code__.co_filename)


def kernel(function: Function) -> Function:
    """Let kernels call this function, wherever it is: in a file with kernels it needs no mark.

    It has no wrapper for calls of compiled code from Python: that costs time.
    """
    return _inner(function, _original(function), NO_WRAPPERS)


def apart(function: Function) -> Function:
    """The same kernel, never copied into its callers: for the case of a loop that is not the usual one.

    Beside the code of a large case the usual one runs out of registers, and takes up to 1.7 times as long.
    """
    return _inner(function, _original(function), NO_WRAPPERS, "apart")


def shared(function: Function) -> Function:
    """The same kernel as machine code of its own, once for all entries that call it, instead of in each of them.

    For what is large, and called by many, but seldom: what calls it cannot be optimised together with it.
    """
    return _inner(function, _original(function), NO_WRAPPERS, "shared")


def inline(function: Function) -> Function:
    """The same kernel, copied into its caller: for the one place of the innermost loop that calls it.

    A call hands over every array by its parts, some hundred numbers; that took longer than the arithmetic.
    """
    own: Any = _original(function)
    own.__name__, own.__qualname__ = f"{own.__name__}_here", f"{own.__qualname__}_here"
    COPIES[own.__module__, own.__qualname__] = own
    return _inner(own, _original(own), {**NO_WRAPPERS, "forceinline": True})


def interpreted_as(machine: Function) -> Callable[[Function], Function]:
    """Let this function of the same file run in the place of the kernel `machine` where kernels are interpreted."""

    def mark(function: Function) -> Function:
        IN_PLACE_OF[machine] = function  # type: ignore[assignment, index]
        if MODE == "interpreted":
            interpret([machine])  # type: ignore[list-item]
        return function

    return mark


def intrinsic(name: str, typed: Callable[..., Any], python: Callable[..., Any]) -> Any:
    """A function that Numba writes itself, as `typed` says (`numba.extending.intrinsic`), and what it is in Python."""
    made = _WithPython(name, typed, python)
    made._register()
    return made


class _WithPython(_Intrinsic):  # type: ignore[misc]  # which Numba calls final
    def __init__(self, name: str, typed: Callable[..., Any], python: Callable[..., Any]) -> None:
        super().__init__(name, typed)
        self._python = python

    def __call__(self, *arguments: Any) -> Any:
        return self._python(*arguments)


def _entry(function: Any, file: str | None = None) -> Any:
    if MODE == "interpreted":
        interpret([function])
        return interpreted(function)
    compiled = _stored(_original(function), "entry", {"no_cfunc_wrapper": True}, file)
    compiled.interpreted = interpreted(function)
    _functions.append(function)
    return tiered(compiled, compiled.interpreted)


def _inner(function: Any, original: Any, options: dict[str, Any], kind: str = "inner") -> Any:
    _compiled[function] = functools.cache(lambda: _stored(original, kind, options))
    if MODE == "interpreted":
        interpret([function])
    else:
        _functions.append(function)
    return function


def interpreted(function: Any) -> Any:
    """Let Python call a kernel as what it is, until `end` says that it is to be abandoned (`base.work_time`)."""

    @functools.wraps(function)
    def call(*arguments: Any, end: Callable[[], bool] = lambda: False) -> Any:
        interpret_all()
        with np.errstate(all="ignore"), counting_work(end):
            return plain(function(*arguments))

    return call


def interpret_all() -> None:
    """Let all kernels of files that were imported, and all that are marked, run as Python where Python calls them."""
    for name in read_sources().keys() - _interpreted:
        module: Any = sys.modules.get(name)
        if module is not None and not getattr(module.__spec__, "_initializing", False):
            _interpreted.add(name)
            own = (each for each in vars(module).values() if isinstance(each, FunctionType))
            _functions.extend(each for each in own if each.__module__ == name and not makes_functions(each))
    if _functions:
        with no_work():
            interpret(_functions)
        _functions.clear()


_functions: list[FunctionType] = []
"""Entries and marked kernels that nobody has interpreted yet."""

_interpreted: set[str] = set()
"""Files with kernels whose functions were interpreted, by the names of their modules."""

_compiled: dict[Any, Callable[[], Any]] = {}
"""What is compiled for each inner kernel, made when Numba meets it."""


def compiled_form(function: Any) -> Any:
    """Return what Numba compiles for an inner kernel."""
    if function not in _compiled:
        kernel(function)
    return _compiled[function]()


@typeof_impl.register(FunctionType)
def _type_of(function: Any, context: Any) -> Any:
    """Tell Numba what is compiled for an inner kernel; of other functions what it says itself."""
    if function in _compiled or function.__module__ in read_sources():
        return types.Dispatcher(compiled_form(function))
    return typeof_impl.dispatch(object)(function, context)


def _original(function: Any) -> Any:
    """Copy a function: what is compiled stays as it is written when the function is interpreted."""
    own = FunctionType(
        written(function), function.__globals__, function.__name__, function.__defaults__, function.__closure__
    )
    own.__module__, own.__qualname__, own.__doc__ = function.__module__, function.__qualname__, function.__doc__
    return own


def _stored(function: Any, kind: str, options: dict[str, Any], file: str | None = None) -> Any:
    """Compile a function, and keep its code on disk as what depends on this file and its imports.

    The `kind` is one of `once.LIBRARIES`, and `options` are for linked code alone. By default the file is that of the
    function. What is made around something else is kept only when a file is named.
    """
    store = None if function.__closure__ and file is None else Store(function, kind, file)
    chosen = OPTIONS
    if COMPILER == "linked":
        pipeline = compiler(kind, None if store is None else store.name)
        chosen = {**OPTIONS, **LINKED_OPTIONS, **options, "pipeline_class": pipeline}
    compiled: Any = numba.njit(**chosen)(function)
    if store is not None:
        compiled._cache = store
    return _quickened(compiled, store)


def _quickened(compiled: Any, store: Store | None) -> Any:
    """Let a function be compiled once for all whole numbers, not for each constant; and without collecting garbage.

    Numba's lock comes first: of the threads of a process one alone may wait for other processes.
    """
    compile_it = compiled.compile

    def compile_quickly(signature: Any) -> Any:
        if isinstance(signature, tuple):
            signature = tuple(types.unliteral(each) for each in signature)
        if signature in compiled.overloads:
            return compiled.overloads[signature].entry_point
        alone = store.alone(signature, compiled.targetctx.codegen()) if store else nullcontext()
        with no_work(), gc_paused(), global_compiler_lock, alone:
            found = compile_it(signature)
            if COMPILER == "linked":
                result = next(one for one in compiled.overloads.values() if one.entry_point is found)
                if isinstance(result.library, KERNELS):
                    call_leanly(compiled.targetctx, result)
            return found

    compiled.compile = compile_quickly
    return compiled
