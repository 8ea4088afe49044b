"""The table of blocks, against a dictionary; and the memory that a search works in."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sinuous.kernels.freespace import cells
from sinuous.kernels.freespace.keys import child_of, key_of
from tests.kernels.freespace.places import memory

NUMBER = st.integers(-6, 6)


@settings(max_examples=40)
@given(wanted=st.lists(st.tuples(st.integers(1, 3), NUMBER, NUMBER, NUMBER), max_size=64))
def test_the_table_is_as_a_dictionary(wanted: list[tuple[int, int, int, int]]) -> None:
    work = memory(512)
    work.table.size[cells.SLOTS] = 2  # so that it grows on the way
    told: dict[int, int] = {}
    for numbers in wanted:
        key = key_of(*numbers)
        if key in told:
            assert cells.block_of(work.table, key) == told[key]
        else:
            assert cells.block_of(work.table, key) == cells.NONE
            told[key] = cells.add_block(work, key, len(told))
    assert list(told.values()) == list(range(len(told)))
    assert work.table.size[cells.BLOCKS] == len(told)
    for key, block in told.items():
        assert cells.block_of(work.table, key) == block
        assert (work.table.parents[block], work.table.cuts[block]) == (key, block)
        assert (work.table.distance[8 * block : 8 * block + 8] == cells.UNKNOWN).all()


@pytest.mark.parametrize("shape", [(400, 3, 3), (3, 400, 3), (3, 3, 400), (16, 16, 14)])
def test_few_blocks_share_a_slot(shape: tuple[int, int, int]) -> None:
    work = memory(1 << 15)
    for x, y, z in np.ndindex(shape):
        cells.add_block(work, key_of(1, x - 2, y - 2, z - 2), cells.NONE)
    taken = np.flatnonzero(work.table.index)
    homes = [cells.home(work.table, int(work.table.parents[work.table.index[slot] - 1])) for slot in taken]
    assert np.mean((taken - homes) % work.table.size[cells.SLOTS]) < 0.7


def test_cells_have_the_keys_of_children_and_halves_that_of_the_whole() -> None:
    work = memory(64)
    key = key_of(3, 1, -2, 5)
    divided, cut = cells.add_block(work, key, cells.NONE), cells.add_block(work, key_of(3, 2, -2, 5), 7)
    assert [cells.key_in(work.table, 8 * divided + i) for i in range(8)] == [child_of(key, i) for i in range(8)]
    assert {cells.key_in(work.table, 8 * cut + i) for i in range(2)} == {key_of(3, 2, -2, 5)}


def test_what_finds_no_place_is_said() -> None:
    work = memory(64)
    told = [cells.add_block(work, key_of(1, i, 0, 0), cells.NONE) for i in range(9)]
    assert told == [*range(8), cells.NONE]
    assert work.table.size[cells.OVERFLOW] == 1
    cells.clear(work)
    assert work.table.size[cells.OVERFLOW] == 0
    for i in range(65):
        cells.push(work, 1, float(i), 0)
    assert work.table.size[cells.OVERFLOW] == 1


def test_a_restart_keeps_cells_and_a_clearing_does_not() -> None:
    work = memory(64)
    table, sides = work.table, work.sides
    key = key_of(1, 1, -2, 3)
    cell = 8 * cells.add_block(work, key, cells.NONE) + 5
    assert (sides.cost[:, cell] == math.inf).all()
    sides.cost[:, cell], sides.done[:, cell], table.penalized[cell], table.distance[cell] = 2.0, 1, 1, 0.5
    cells.push(work, 1, 2.0, cell)
    cells.restart(work)
    assert (sides.cost[:, cell] == math.inf).all()
    assert not sides.done.any()
    assert not sides.size.any()
    assert table.penalized[cell] == 1
    assert cells.block_of(table, key) == cell // 8
    assert table.distance[cell] == 0.5
    cells.clear(work)
    assert cells.block_of(table, key) == cells.NONE


def test_each_side_has_a_heap_of_its_own() -> None:
    work = memory(64)
    one, other = cells.pick(work.sides, 0), cells.pick(work.sides, 1)
    for cell, priority in enumerate((3.0, 1.0, 2.0)):
        cells.push(work, 0, priority, cell)
        cells.push(work, 1, -priority, cell)
    assert [cells.pop(one) for _ in range(3)] == [1, 2, 0]
    assert [cells.pop(other) for _ in range(3)] == [0, 2, 1]


@pytest.mark.parametrize("most", [64, 256, 1 << 13])
def test_the_arrays_of_a_search_fill_its_memory_and_nothing_twice(most: int) -> None:
    buffer = np.zeros(cells.memory_size(most))
    work = cells.carve(buffer, most)
    model = memory(most)
    arrays = [*work.table, *work.sides, work.points, work.stack, work.clock]
    expected = [*model.table, *model.sides, model.points, model.stack, model.clock]
    assert [(a.shape, a.dtype) for a in arrays] == [(a.shape, a.dtype) for a in expected]
    assert sum(a.nbytes for a in arrays) == buffer.nbytes
    for a in arrays:
        a.view(np.uint8)[...] += 1
    assert (buffer.view(np.uint8) == 1).all()


def test_what_a_search_may_take_is_bounded() -> None:
    assert 8 * cells.memory_size(1 << 19) < 62e6
