"""Pausing the search for garbage."""

import gc

import pytest

from sinuous.base.progress import gc_paused


def failing() -> None:
    with gc_paused():
        assert not gc.isenabled()
        raise KeyError


def test_it_is_paused_within_and_as_before_afterwards() -> None:
    assert gc.isenabled()
    with pytest.raises(KeyError):
        failing()
    assert gc.isenabled()
    with gc_paused():
        with gc_paused():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()
