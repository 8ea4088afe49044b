"""Batches of starts: nothing is lost where they are cut, and numbers go on."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.solver.attempts import StartBatch
from tests.helpers import Floats


def initial(count: int) -> Floats:
    return np.arange(6.0 * count).reshape(count, 2, 3)


@given(st.integers(0, 9), st.integers(0, 20), st.integers(0, 30), st.lists(st.integers(1, 9), min_size=1))
def test_parts_are_the_whole(count: int, first: int, own: int, sizes: list[int]) -> None:
    batch = StartBatch("route", initial(count), (first, first + own), effort=3.0)
    asked = itertools.cycle(sizes)
    limits: list[int] = []

    def most() -> int:
        limits.append(next(asked))
        return limits[-1]

    parts = list(batch.parts(most))
    assert batch.size == count + own == sum(part.size for part in parts)
    assert all(0 < part.size <= limit for part, limit in zip(parts, limits, strict=True))
    assert all(part.source == "route" for part in parts)
    assert np.array_equal(np.concatenate([NOTHING, *(part.initial for part in parts)]), batch.initial)
    numbers = [i for part in parts for i in range(*part.own)]
    assert numbers == list(range(first, first + own))
    # Initial configurations come first, and never together with starts of the method.
    kinds = [len(part.initial) > 0 for part in parts]
    assert kinds == sorted(kinds, reverse=True)
    assert not any(len(part.initial) and part.own[0] < part.own[1] for part in parts)


NOTHING = initial(0)
