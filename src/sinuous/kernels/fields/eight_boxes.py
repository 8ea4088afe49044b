"""Distances of a point to eight boxes at once, in the registers of the processor that hold several numbers.

Numba's loops over eight are unrolled, not vectorised, and a walk in a tree waits for each of its decisions: so this is
written as LLVM takes it. Processors with narrower registers take two or four for the eight.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.np.arrayobj import make_array

from sinuous.kernels.compile import intrinsic
from sinuous.kernels.maths.vectors import Array, Vec

EIGHT = 8
BLOCK = 6 * EIGHT
"""Numbers of eight boxes: the low x of all, then y and z, and the high ones."""

_WHOLE, _LANE = ir.IntType(64), ir.IntType(32)
_REALS, _KEYS, _LANES = (ir.VectorType(own, EIGHT) for own in (ir.DoubleType(), _WHOLE, _LANE))


def _in_python(store: Array, at: int, p: Vec, best: float, among: int) -> tuple[int, int]:
    low, high = store[at : at + BLOCK].reshape(2, 3, EIGHT)
    place = np.array(p)[:, None]
    squares = (np.maximum(np.maximum(low - place, place - high), 0.0) ** 2).sum(axis=0)
    asked = among >> np.arange(EIGHT) & 1 == 1
    return int(((asked & (squares < best)) << np.arange(EIGHT)).sum()), int(np.where(asked, squares, np.inf).argmin())


def _typed(context: Any, store: Any, at: Any, p: Any, best: Any, among: Any) -> Any:
    """Say what `nearest_of_eight` returns, and how it is compiled."""

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = make_array(store)(context, builder, arguments[0]).data  # type: ignore[no-untyped-call]

        def load(k: int) -> Any:
            place = builder.gep(data, [builder.add(arguments[1], ir.Constant(_WHOLE, EIGHT * k))])
            return builder.load(builder.bitcast(place, _REALS.as_pointer()), align=8)

        def spread(value: Any) -> Any:
            first = builder.insert_element(ir.Constant(_REALS, ir.Undefined), value, ir.Constant(_LANE, 0))
            return builder.shuffle_vector(first, first, ir.Constant(_LANES, [0] * EIGHT))

        def most(a: Any, b: Any) -> Any:
            return builder.select(builder.fcmp_ordered(">", a, b), a, b)

        squares = zero = ir.Constant(_REALS, [0.0] * EIGHT)
        for axis in range(3):
            x = spread(builder.extract_value(arguments[2], axis))
            beyond = most(most(builder.fsub(load(axis), x), builder.fsub(x, load(axis + 3))), zero)
            squares = builder.fadd(squares, builder.fmul(beyond, beyond))
        asked = builder.bitcast(builder.trunc(arguments[4], ir.IntType(8)), ir.VectorType(ir.IntType(1), EIGHT))
        nearer = builder.and_(asked, builder.fcmp_ordered("<", squares, spread(arguments[3])))
        found = builder.zext(builder.bitcast(nearer, ir.IntType(8)), _WHOLE)
        # Numbers that are not negative are in the order of their bits. The last three of these say which box it is.
        keys = builder.and_(builder.bitcast(squares, _KEYS), ir.Constant(_KEYS, [~7] * EIGHT))
        keys = builder.or_(keys, ir.Constant(_KEYS, list(range(EIGHT))))
        keys = builder.select(asked, keys, ir.Constant(_KEYS, [2**63 - 1] * EIGHT))
        for turn in (4, 2, 1):
            others = builder.shuffle_vector(keys, keys, ir.Constant(_LANES, [(k + turn) % EIGHT for k in range(EIGHT)]))
            keys = builder.select(builder.icmp_signed("<", keys, others), keys, others)
        nearest = builder.and_(builder.extract_element(keys, ir.Constant(_LANE, 0)), ir.Constant(_WHOLE, EIGHT - 1))
        return context.make_tuple(builder, signature.return_type, [found, nearest])

    pair: Any = types.UniTuple(types.int64, 2)  # type: ignore[no-untyped-call]
    return pair(store, at, p, best, among), build


nearest_of_eight: Any = intrinsic("nearest_of_eight", _typed, _in_python)
"""`nearest_of_eight(store, at, p, best, among)`: of the eight boxes at `at`, those that the bits of `among` name.

Returns bits of those whose distance to the point `p` has a square less than `best`, and the number of the nearest.
"""
