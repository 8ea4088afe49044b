"""Buffers that threads share: lent to one at a time, and few are kept."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.solver.routing.searches import BufferPool


def test_a_buffer_that_was_given_back_is_lent_again() -> None:
    pool = BufferPool(2, 100)
    with pool.borrow(50) as first:
        pass
    with pool.borrow(40) as again, pool.borrow(40) as other:
        assert again is first
        assert other is not first


def test_a_larger_one_replaces_a_smaller_one() -> None:
    pool = BufferPool(1, 100)
    with pool.borrow(10):
        pass
    with pool.borrow(60) as larger:
        assert len(larger) >= 60
    assert pool.kept_bytes == 480


def test_what_is_too_large_is_not_kept() -> None:
    pool = BufferPool(2, 100)
    with pool.borrow(101) as large:
        assert len(large) == 101
    assert pool.kept_bytes == 0


def test_a_buffer_comes_back_after_an_error() -> None:
    pool = BufferPool(1, 100)
    try:
        with pool.borrow(10):
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        pass
    assert pool.kept_bytes == 80


@given(sizes=st.lists(st.integers(0, 150), max_size=20))
def test_no_more_is_kept_than_said(sizes: list[int]) -> None:
    pool = BufferPool(2, 100)
    for size in sizes:
        with pool.borrow(size) as one, pool.borrow(size) as two, pool.borrow(size) as three:
            assert min(len(one), len(two), len(three)) >= size
        assert pool.kept_bytes <= 8 * 2 * 100


def test_threads_never_share_one() -> None:
    pool, barrier = BufferPool(2, 100), Barrier(4)

    def work(number: int) -> bool:
        kept = True
        for _ in range(50):
            with pool.borrow(64) as buffer:
                buffer[:] = number
                barrier.wait()
                kept = kept and bool((buffer == number).all())
                barrier.wait()
        return kept

    with ThreadPoolExecutor(4) as threads:
        assert all(threads.map(work, range(4)))
    assert pool.kept_bytes <= 2 * 8 * 100
    assert np.isfinite(pool.kept_bytes)
