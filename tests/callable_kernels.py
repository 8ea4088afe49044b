"""Inner kernels that Python can call, for tests.

Users have wrappers for entries alone. Here every inner kernel is behind a `Callable`. Other kernels call the same
kernel as they do for users, from the same cache on disk; a second one, with wrappers, is compiled when Python calls it.
"""

from typing import Any

import numpy as np
from numba import types
from numba.extending import typeof_impl

from sinuous import work_time
from sinuous.kernels import compile as compiling


class Callable:
    """An inner kernel: to kernels, what it is; to Python, an entry.

    Parameters
    ----------
    function : callable
        The inner kernel.
    """

    def __init__(self, function: Any) -> None:
        self.py_func = function
        self.__module__ = function.__module__  # an entry that is made around it is kept under this name
        self.__code__ = function.__code__
        self._entry: Any = None

    def __call__(self, *arguments: Any) -> Any:
        if work_time.interpreting():
            return self.py_func(*arguments)
        if self._entry is None:
            self._entry = compiling.entry(self.py_func)
        return self._entry(*map(_writable, arguments))

    @property
    def compiled(self) -> Any:
        """What Numba compiles for other kernels."""
        return compiling.compiled_form(self.py_func)


def _writable(value: Any) -> Any:
    """Copy an array that is read-only: for it the kernel, and all that it calls, would be compiled once more."""
    if isinstance(value, np.ndarray):
        return value if value.flags.writeable else value.copy()
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*map(_writable, value))
    return value


def install() -> None:
    """Have all kernels that are made from now on behind a `Callable`."""
    kernel, inline = compiling.kernel, compiling.inline
    compiling.kernel = lambda function: Callable(kernel(function))  # type: ignore[assignment, return-value]
    compiling.inline = lambda function: inline(function.py_func)  # type: ignore[attr-defined]

    @typeof_impl.register(Callable)
    def type_of(value: Callable, context: Any) -> types.Dispatcher:
        return types.Dispatcher(value.compiled)
