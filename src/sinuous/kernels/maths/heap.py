"""A binary min-heap in two arrays: priorities, and the numbers of the items that have them.

`priority` (m,) float64 and `items` (m,), integers of any width, are filled from the front; the caller keeps the size.
An item may be in the heap several times, with different priorities.
"""

import numpy as np

from sinuous.kernels.maths.vectors import Array


def push(priority: Array, items: Array, size: int, urgency: float, item: int) -> int:
    """Put in an item with the priority `urgency`; there must be a place for it. Returns the new size."""
    at = size
    while at > 0:
        up = (at - 1) >> 1
        if priority[up] <= urgency:
            break
        priority[at], items[at] = priority[up], items[up]
        at = up
    priority[at], items[at] = urgency, item
    return size + 1


def pop(priority: Array, items: Array, size: int) -> tuple[int, int]:
    """Take out an item of the least priority; there must be one. Returns the item and the new size."""
    top = int(np.int64(items[0]))
    size -= 1
    urgency, item = priority[size], items[size]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= size:
            break
        if child + 1 < size and priority[child + 1] < priority[child]:
            child += 1
        if priority[child] >= urgency:
            break
        priority[at], items[at] = priority[child], items[child]
        at = child
    priority[at], items[at] = urgency, item
    return top, size
