"""Trees of boxes over primitives of any kind, as kernels walk them, see `sinuous.kernels.fields.trees`."""

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels.tables import LEAF_ITEMS


def tree_of_boxes(centers: Floats, lows: Floats, highs: Floats) -> tuple[NDArray[np.int64], int, Floats]:
    """Order, number of levels, and boxes (2 << levels, 6) of a tree over what has these centers and corners (m, 3)."""
    from sinuous.kernels.fields.trees import arrange  # noqa: PLC0415

    order = np.arange(len(centers))
    arrange(plain(centers), levels_for(len(centers)), order)
    return order, *enclose_in_order(order, lows, highs)


def enclose_in_order(order: NDArray[np.int64], lows: Floats, highs: Floats) -> tuple[int, Floats]:
    """Number of levels, and boxes (2 << levels, 6) of a tree over what is in this order, with these corners (m, 3)."""
    from sinuous.kernels.fields.trees import enclose  # noqa: PLC0415

    levels = levels_for(len(order))
    nodes = np.empty((2 << levels, 6))
    enclose(plain(lows), plain(highs), order, levels, nodes)
    return levels, nodes


def levels_for(count: int) -> int:
    """How many levels a tree over so many primitives has."""
    return max(0, (max(1, -(-count // LEAF_ITEMS)) - 1).bit_length())


def plain(array: Floats) -> Floats:
    """Return an array as the kernels are compiled for: writable, rows one after the other."""
    return np.require(array, np.float64, ["C", "W"])
