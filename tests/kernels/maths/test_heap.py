"""The binary heap, against Python's own."""

import heapq
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.maths.heap import pop, push

PRIORITIES = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize("width", [np.int32, np.int64])
@given(priorities=st.lists(PRIORITIES | st.sampled_from([0.0, 1.0]), max_size=60))
def test_items_come_out_by_priority(width: Any, priorities: list[float]) -> None:
    keys, items, size = np.empty(60), np.empty(60, width), 0
    for item, priority in enumerate(priorities):
        size = push(keys, items, size, priority, item)
    assert size == len(priorities)
    out = []
    while size:
        item, size = pop(keys, items, size)
        out.append(item)
    assert sorted(out) == list(range(len(priorities)))
    assert [priorities[i] for i in out] == sorted(priorities)


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
