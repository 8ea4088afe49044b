"""Every entry does the same compiled and interpreted, in problems of all kinds."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sinuous.kernels.compile.tiers import PIECES
from tests.kernels.both_ways import NEAR

ROOT = Path(__file__).parents[2]


def compare_both_ways(*steps: str, **settings: str) -> dict[str, Any]:
    """What `both_ways` says with such variables of the environment."""
    command = [sys.executable, "-m", "tests.kernels.both_ways", *steps]
    words = {**os.environ, "SINUOUS_KERNELS": "compiled", **settings}
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, env=words)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout.splitlines()[-1]))


def assert_same(seen: dict[str, Any]) -> None:
    assert not seen["failed"], "\n".join(seen["failed"])
    assert not seen["apart"], "\n".join(seen["apart"])
    assert max(seen["largest"].values()) <= NEAR


@pytest.fixture(scope="module")
def seen() -> dict[str, Any]:
    return compare_both_ways()


def test_no_kernel_raises_when_it_is_interpreted_and_answers_are_the_same(seen: dict[str, Any]) -> None:
    assert_same(seen)


def test_every_entry_was_compared(seen: dict[str, Any]) -> None:
    assert {entry for piece in PIECES for entry in piece.entries} <= seen["compared"].keys()


def test_everything_is_compiled_ahead_and_in_one_form(seen: dict[str, Any]) -> None:
    assert sorted(seen["ahead"]) == sorted(entry for piece in PIECES for entry in piece.entries)
    assert seen["late"] == {}


def test_no_entry_is_compiled_for_arrays_that_cannot_be_written_to(seen: dict[str, Any]) -> None:
    """All kernels that it calls would be compiled once more for them."""
    assert seen["closed"] == []


def test_numba_by_itself_makes_the_same() -> None:
    """The way out of what we do to it, and what runs with versions that were not tried."""
    seen = compare_both_ways("kinematics", "starts of a memory", SINUOUS_COMPILER="numba")
    assert_same(seen)
    assert len(seen["compared"]) == 5
