"""Arrays cut out of a buffer: the shape that a part of it has."""

from typing import Any

from numba import types
from numba.core.errors import TypingError
from numba.np.arrayobj import make_array, populate_array
from numba.np.unsafe.ndarray import to_fixed_tuple

from sinuous.kernels.compile import intrinsic


def sizes_in(context: Any, builder: Any, shape: Any, given: Any) -> list[Any]:
    """The numbers of a tuple of these types of whole numbers, each as an index."""
    return [context.cast(builder, builder.extract_value(given, i), each, types.intp) for i, each in enumerate(shape)]


def array_at(context: Any, builder: Any, kind: Any, data: Any, sizes: list[Any], whole: Any) -> Any:
    """The contiguous array of such a type and size that begins at `data`, within the array `whole`."""
    made: Any = make_array(kind)(context, builder)  # type: ignore[no-untyped-call]
    strides = [whole.itemsize]
    for size in sizes[:0:-1]:
        strides.insert(0, builder.mul(size, strides[0]))
    kept = {name: getattr(whole, name) for name in ("itemsize", "meminfo", "parent")}
    data = builder.bitcast(data, made.data.type)
    populate_array(made, data=data, shape=sizes, strides=strides, **kept)  # type: ignore[no-untyped-call]
    return made._getvalue()


def _typed(context: Any, array: Any, shape: Any) -> Any:
    """Say what `shaped` returns, and how it is compiled."""
    if array.layout != "C":
        raise TypingError("shaped: the array is not contiguous")
    result = array.copy(ndim=len(shape))

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        given: Any = make_array(array)(context, builder, arguments[0])  # type: ignore[no-untyped-call]
        sizes = sizes_in(context, builder, shape, arguments[1])
        return array_at(context, builder, result, given.data, sizes, given)

    return result(array, shape), build


shaped: Any = intrinsic("shaped", _typed, lambda array, shape: array.reshape(shape))
"""`shaped(array, shape)` is `array.reshape(shape)` of a contiguous array that is as large as the shape, unchecked.

NumPy's calls a function that compiled code cannot check into: some 12 ns, and a solve lays out some 25 arrays.
"""

first_of: Any = intrinsic("first_of", to_fixed_tuple._defn, lambda array, count: tuple(array[:count]))
"""`first_of(array, count)` is a tuple of the first numbers of an array, as many as a constant says."""
