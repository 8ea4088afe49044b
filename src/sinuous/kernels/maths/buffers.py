"""Arrays cut out of a buffer one after the other: how kernels lay out what they work in."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.core.errors import TypingError
from numba.np.arrayobj import make_array

from sinuous.kernels.compile import intrinsic
from sinuous.kernels.maths.shapes import array_at, sizes_in


def _typed(dtype: Any) -> Callable[..., Any]:
    """What says what `cut` returns, with numbers of such a type of eight bytes, and how it is compiled."""

    def typed(context: Any, buffer: Any, *shape: Any) -> Any:
        if buffer.layout != "C" or buffer.ndim != 1 or buffer.dtype.bitwidth != dtype.bitwidth:
            raise TypingError("cut: the buffer is not a row of numbers of eight bytes")
        part = buffer.copy(ndim=len(shape), dtype=dtype)

        def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            given: Any = make_array(buffer)(context, builder, arguments[0])  # type: ignore[no-untyped-call]
            sizes = sizes_in(context, builder, shape, arguments[1])
            count = sizes[0]
            for size in sizes[1:]:
                count = builder.mul(count, size)
            left = builder.sub(builder.extract_value(given.shape, 0), count)
            first = array_at(context, builder, part, given.data, sizes, given)
            rest = array_at(context, builder, buffer, builder.gep(given.data, [count]), [left], given)
            return context.make_tuple(builder, signature.return_type, (first, rest))

        of: Any = types  # which a type checker does not see
        return of.Tuple((part, buffer))(buffer, of.StarArgTuple.from_types(shape)), build

    return typed


def _cut(buffer: Any, *shape: int) -> tuple[Any, Any]:
    size = math.prod(shape)
    return buffer[:size].reshape(shape), buffer[size:]


def _cut_whole(buffer: Any, *shape: int) -> tuple[Any, Any]:
    part, rest = _cut(buffer, *shape)
    return part.view(np.int64), rest


cut: Any = intrinsic("cut", _typed(types.float64), _cut)
"""`cut(buffer, *shape)` is the beginning of a buffer (w,) as an array of that shape, and the rest of the buffer.

Unchecked: slices and `reshape` of NumPy are several times as much code, and all of it is optimised in each entry.
"""

cut_whole: Any = intrinsic("cut_whole", _typed(types.int64), _cut_whole)
"""The same with an array of int64."""
