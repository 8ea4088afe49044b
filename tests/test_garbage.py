"""Pausing the search for garbage."""

import gc

import pytest

from sinuous.garbage import uncollected


def failing() -> None:
    with uncollected():
        assert not gc.isenabled()
        raise KeyError


def test_it_is_paused_within_and_as_before_afterwards() -> None:
    assert gc.isenabled()
    with pytest.raises(KeyError):
        failing()
    assert gc.isenabled()
    with uncollected():
        with uncollected():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()
