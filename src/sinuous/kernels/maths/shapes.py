"""Arrays cut out of a buffer: the shape that a part of it has."""

from typing import Any

from numba import types
from numba.core.errors import TypingError
from numba.np.arrayobj import make_array, populate_array
from numba.np.unsafe.ndarray import to_fixed_tuple

from sinuous.kernels.compile import intrinsic


def _typed(context: Any, array: Any, shape: Any) -> Any:
    """Say what `shaped` returns, and how it is compiled."""
    if array.layout != "C":
        raise TypingError("shaped: the array is not contiguous")
    result = array.copy(ndim=len(shape))

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        given: Any = make_array(array)(context, builder, arguments[0])  # type: ignore[no-untyped-call]
        made: Any = make_array(result)(context, builder)  # type: ignore[no-untyped-call]
        sizes = [
            context.cast(builder, builder.extract_value(arguments[1], i), each, types.intp)
            for i, each in enumerate(shape)
        ]
        strides = [given.itemsize]
        for size in sizes[:0:-1]:
            strides.insert(0, builder.mul(size, strides[0]))
        parts = {name: getattr(given, name) for name in ("data", "itemsize", "meminfo", "parent")}
        populate_array(made, shape=sizes, strides=strides, **parts)  # type: ignore[no-untyped-call]
        return made._getvalue()

    return result(array, shape), build


shaped: Any = intrinsic("shaped", _typed, lambda array, shape: array.reshape(shape))
"""`shaped(array, shape)` is `array.reshape(shape)` of a contiguous array that is as large as the shape, unchecked.

NumPy's calls a function that compiled code cannot check into: some 12 ns, and a solve lays out some 25 arrays.
"""

first_of: Any = intrinsic("first_of", to_fixed_tuple._defn, lambda array, count: tuple(array[:count]))
"""`first_of(array, count)` is a tuple of the first numbers of an array, as many as a constant says."""
