"""A priority queue in buckets: quicker than a heap, where it does not matter which of nearly equal items comes first.

Each bucket is a chain of items whose priorities differ by no more than its width; the last one that was put in comes
out first. What is beyond the last bucket is in the last.
"""

from collections import namedtuple

import numpy as np

from sinuous.kernels.maths.vectors import Array

Buckets = namedtuple("Buckets", ["first", "after", "items", "state", "low", "per"])
"""Of every bucket the link (b,) that its chain begins with; of every link the one after it (m,) and its item (m,); and
where the queue is (3,), see below: all int64, links -1 where there is none. The bucket of a priority x is number
`per * (x - low)`."""

FIRST_FILLED, SPARE, NEW = range(3)
"""No bucket before this one has an item; the first link of the chain of those that are free again; and how many links
were ever used."""

MORE = 3
"""Numbers that a queue takes beside one for each bucket and two for each item."""


def carve(buffer: Array, buckets: int, low: float, high: float) -> Buckets:
    """Lay out an empty queue of so many buckets in `buffer` (n,) int64: for priorities from `low` to `high`, mostly."""
    items = (buffer.shape[0] - buckets - MORE) // 2
    first, after = buffer[:buckets], buffer[buckets : buckets + items]
    for i in range(buckets):
        first[i] = -1
    state = buffer[buckets + 2 * items :]
    state[FIRST_FILLED], state[SPARE], state[NEW] = buckets, -1, 0
    per = buckets / (high - low) if high > low else 0.0
    return Buckets(first, after, buffer[buckets + items : buckets + 2 * items], state, low, per)


def push(queue: Buckets, priority: float, item: int) -> bool:
    """Put in an item; False where there is no room."""
    state, link = queue.state, queue.state[SPARE]
    if link >= 0:
        state[SPARE] = queue.after[link]
    elif state[NEW] < queue.items.shape[0]:
        link = state[NEW]
        state[NEW] += 1
    else:
        return False
    bucket = np.int64(min(max(0.0, (priority - queue.low) * queue.per), queue.first.shape[0] - 1.0))
    queue.items[link], queue.after[link] = item, queue.first[bucket]
    queue.first[bucket] = link
    state[FIRST_FILLED] = min(state[FIRST_FILLED], bucket)
    return True


def pop(queue: Buckets) -> int:
    """Take out an item of the first bucket that has one; -1: there is none."""
    state, count = queue.state, queue.first.shape[0]
    while state[FIRST_FILLED] < count and queue.first[state[FIRST_FILLED]] < 0:
        state[FIRST_FILLED] += 1
    if state[FIRST_FILLED] == count:
        return -1
    link = queue.first[state[FIRST_FILLED]]
    queue.first[state[FIRST_FILLED]] = queue.after[link]
    queue.after[link] = state[SPARE]
    state[SPARE] = link
    return int(queue.items[link])
