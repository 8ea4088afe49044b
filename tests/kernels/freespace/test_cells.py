"""The table of cells, against a dictionary; and the memory that a search works in."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sinuous.kernels.freespace import cells
from tests.kernels.freespace.places import memory

NUMBER = st.integers(-cells.OFFSET + 1, cells.OFFSET - 1)


@given(numbers=st.tuples(NUMBER, NUMBER, NUMBER))
def test_a_key_tells_the_numbers_of_its_cell(numbers: tuple[int, int, int]) -> None:
    key = cells.key_of(*numbers)
    assert key > 0
    assert cells.numbers_of(key) == numbers


@settings(max_examples=40)
@given(wanted=st.lists(st.tuples(*[st.integers(-6, 6)] * 3), max_size=63))
def test_the_table_is_as_a_dictionary(wanted: list[tuple[int, int, int]]) -> None:
    work = memory(64)
    table, side = work.table, work.side
    told: dict[int, float] = {}
    for i, numbers in enumerate(wanted):
        key = cells.key_of(*numbers)
        slot = cells.find_slot(table, key)
        if key in told:
            assert table.keys[slot] == key
            assert table.distance[slot] == told[key]
        else:
            assert table.keys[slot] == 0
            cells.add_cell(table, side, slot, key, float(i))
            told[key] = float(i)
    assert {int(key) for key in table.keys if key} == set(told)
    assert all(table.distance[cells.find_slot(table, key)] == value for key, value in told.items())


def test_a_restart_keeps_cells_and_a_clearing_does_not() -> None:
    work = memory(64)
    table, side = work.table, work.side
    key = cells.key_of(1, -2, 3)
    slot = cells.find_slot(table, key)
    cells.add_cell(table, side, slot, key, 0.5)
    assert side.cost[slot] == math.inf
    side.cost[slot], side.done[slot], table.penalized[slot] = 2.0, 1, 1
    cells.restart(table, side)
    assert (side.cost[slot], side.done[slot], table.penalized[slot]) == (math.inf, 0, 1)
    assert (table.keys[slot], table.distance[slot]) == (key, 0.5)
    cells.clear(table)
    assert not table.keys.any()


@pytest.mark.parametrize("slots", [8, 256, 1 << 13])
def test_the_arrays_of_a_search_fill_its_memory_and_nothing_twice(slots: int) -> None:
    buffer = np.zeros(cells.memory_size(slots))
    carve: Any = cells.carve
    work = carve.py_func(buffer, slots)
    model = memory(slots)
    arrays = [*work.table, *work.side, work.points, work.clock]
    expected = [*model.table, *model.side, model.points, model.clock]
    assert [(a.shape, a.dtype) for a in arrays] == [(a.shape, a.dtype) for a in expected]
    assert sum(a.nbytes for a in arrays) == buffer.nbytes
    for a in arrays:
        a.view(np.uint8)[...] += 1
    assert (buffer.view(np.uint8) == 1).all()


def test_what_a_search_may_take_is_bounded() -> None:
    assert 8 * cells.memory_size(1 << 20) < 49e6
