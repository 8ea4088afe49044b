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
@given(wanted=st.lists(st.tuples(*[st.integers(-6, 6)] * 3), max_size=64))
def test_the_table_is_as_a_dictionary(wanted: list[tuple[int, int, int]]) -> None:
    work = memory(64)
    work.table.size[1] = 2  # so that it grows on the way
    told: dict[int, int] = {}
    for numbers in wanted:
        key = cells.key_of(*numbers)
        if key in told:
            assert cells.cell_of(work.table, key) == told[key]
        else:
            assert cells.cell_of(work.table, key) == cells.NONE
            told[key] = cells.add_cell(work.table, work.sides, key, float(len(told)))
    assert list(told.values()) == list(range(len(told)))
    assert work.table.size[0] == len(told)
    for key, cell in told.items():
        assert cells.cell_of(work.table, key) == cell
        assert (work.table.keys[cell], work.table.distance[cell]) == (key, float(cell))


@pytest.mark.parametrize("shape", [(400, 3, 3), (3, 400, 3), (3, 3, 400), (16, 16, 14)])
def test_few_cells_share_a_slot(shape: tuple[int, int, int]) -> None:
    work = memory(1 << 12)
    for x, y, z in np.ndindex(shape):
        cells.add_cell(work.table, work.sides, cells.key_of(x - 2, y - 2, z - 2), 0.0)
    taken = np.flatnonzero(work.table.index)
    homes = [cells.home(work.table, int(work.table.keys[work.table.index[slot] - 1])) for slot in taken]
    assert np.mean((taken - homes) % work.table.size[1]) < 0.7


def test_a_restart_keeps_cells_and_a_clearing_does_not() -> None:
    work = memory(64)
    table, sides = work.table, work.sides
    key = cells.key_of(1, -2, 3)
    cell = cells.add_cell(table, sides, key, 0.5)
    assert (sides.cost[:, cell] == math.inf).all()
    sides.cost[:, cell], sides.done[:, cell], table.penalized[cell] = 2.0, 1, 1
    cells.push(side(work, 1), 2.0, cell)
    cells.restart(work)
    assert (sides.cost[:, cell] == math.inf).all()
    assert not sides.done.any()
    assert not sides.size.any()
    assert table.penalized[cell] == 1
    assert cells.cell_of(table, key) == cell
    assert table.distance[cell] == 0.5
    cells.clear(work)
    assert cells.cell_of(table, key) == cells.NONE


def side(work: cells.Memory, which: int) -> cells.Side:
    """One side, as views: a compiled kernel cannot hand over arrays to Python."""
    pick: Any = cells.pick
    return pick.py_func(work.sides, which)  # type: ignore[no-any-return]


def test_each_side_has_a_heap_of_its_own() -> None:
    work = memory(64)
    one, other = side(work, 0), side(work, 1)
    for cell, priority in enumerate((3.0, 1.0, 2.0)):
        cells.push(one, priority, cell)
        cells.push(other, -priority, cell)
    assert [cells.pop(one) for _ in range(3)] == [1, 2, 0]
    assert [cells.pop(other) for _ in range(3)] == [0, 2, 1]


@pytest.mark.parametrize("most", [8, 256, 1 << 13])
def test_the_arrays_of_a_search_fill_its_memory_and_nothing_twice(most: int) -> None:
    buffer = np.zeros(cells.memory_size(most))
    carve: Any = cells.carve
    work = carve.py_func(buffer, most)
    model = memory(most)
    arrays = [*work.table, *work.sides, work.points, work.clock]
    expected = [*model.table, *model.sides, model.points, model.clock]
    assert [(a.shape, a.dtype) for a in arrays] == [(a.shape, a.dtype) for a in expected]
    assert sum(a.nbytes for a in arrays) == buffer.nbytes
    for a in arrays:
        a.view(np.uint8)[...] += 1
    assert (buffer.view(np.uint8) == 1).all()


def test_what_a_search_may_take_is_bounded() -> None:
    assert 8 * cells.memory_size(1 << 19) < 45e6
