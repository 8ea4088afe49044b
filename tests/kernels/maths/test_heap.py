"""The binary heap, against Python's own."""

import heapq

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.maths.heap import pop, push

PRIORITIES = st.floats(allow_nan=False, allow_infinity=False)


@given(steps=st.lists(st.none() | PRIORITIES, max_size=80))
def test_pushing_and_popping_in_turn_is_as_with_heapq(steps: list[float | None]) -> None:
    keys, items, size = np.empty(80), np.empty(80, np.int32), 0
    told: list[float] = []
    given: list[float] = []
    for number, priority in enumerate(steps):
        given.append(0.0 if priority is None else priority)
        if priority is not None:
            size = push(keys, items, size, priority, number)
            heapq.heappush(told, priority)
        elif told:
            item, size = pop(keys, items, size)
            assert given[item] == heapq.heappop(told)
        assert size == len(told)
