"""The queue in buckets, against what it was given."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.maths.buckets import MORE, Buckets, carve, pop, push

BUCKETS, ITEMS, LOW, HIGH = 8, 40, -1.0, 3.0
WIDTH = (HIGH - LOW) / BUCKETS

PRIORITIES = st.floats(-2.0, 4.0)


def empty(low: float = LOW, high: float = HIGH) -> Buckets:
    """An empty queue; kernels do not return arrays to Python, so they are laid out here as `carve` does it."""
    buffer = np.full(BUCKETS + 2 * ITEMS + MORE, 77)
    carve(buffer, BUCKETS, low, high)
    first, after, items, state = np.split(buffer, [BUCKETS, BUCKETS + ITEMS, BUCKETS + 2 * ITEMS])
    return Buckets(first, after, items, state, low, BUCKETS / (high - low) if high > low else 0.0)


def bucket(priority: float) -> int:
    """Number of the bucket of a priority."""
    return int(min(max(0.0, (priority - LOW) / WIDTH), BUCKETS - 1))


@given(steps=st.lists(st.none() | PRIORITIES, max_size=120))
def test_pushing_and_popping_in_turn_gives_one_of_the_first_bucket(steps: list[float | None]) -> None:
    """The one that came last; and links are used again."""
    queue = empty()
    told: list[tuple[int, int]] = []
    for number, priority in enumerate(steps):
        if priority is not None:
            put = push(queue, priority, number)
            assert put == (len(told) < ITEMS)
            told += [(bucket(priority), -number)] if put else []
        elif told:
            told.sort()
            assert pop(queue) == -told.pop(0)[1]
        else:
            assert pop(queue) == -1
