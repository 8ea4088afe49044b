"""Keys of cells, against the numbers that they stand for."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.freespace import keys

NUMBER = st.integers(-keys.OFFSET + 1, keys.OFFSET - 1)
SMALL = st.tuples(st.integers(0, 3), *[st.integers(-9, 9)] * 3)


@given(level=st.integers(0, keys.MOST_LEVELS + 1), numbers=st.tuples(NUMBER, NUMBER, NUMBER))
def test_a_key_tells_the_level_and_the_numbers_of_its_cell(level: int, numbers: tuple[int, int, int]) -> None:
    key = keys.key_of(level, *numbers)
    assert key > 0
    assert keys.numbers_of(key) == (level, *numbers)


@given(level=st.integers(1, keys.MOST_LEVELS), numbers=st.tuples(*[st.integers(-1000, 1000)] * 3))
def test_children_are_eight_and_know_their_parent(level: int, numbers: tuple[int, int, int]) -> None:
    key = keys.key_of(level, *numbers)
    children = [keys.child_of(key, octant) for octant in range(8)]
    assert len(set(children)) == 8
    for octant, child in enumerate(children):
        assert keys.parent_of(child) == key
        assert keys.octant_of(*keys.numbers_of(child)[1:]) == octant


def finest(cell: tuple[int, int, int, int]) -> Any:
    """Numbers (m, 3) of the finest cells in a cell."""
    edge = 1 << cell[0]
    return edge * np.array(cell[1:]) + np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij"), -1).reshape(-1, 3)


@given(one=SMALL, other=SMALL)
def test_cells_touch_where_two_of_their_finest_cells_are_neighbours(one: Any, other: Any) -> None:
    between = np.abs(finest(one)[:, None] - finest(other)[None]).max(axis=-1).min()
    assert keys.touch(keys.key_of(*one), keys.key_of(*other)) == (between <= 1)
