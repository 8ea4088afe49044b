"""Every entry does the same compiled and interpreted, in problems of all kinds."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sinuous.kernels.compiling.pieces import PIECES
from tests.kernels.both_ways import NEAR

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def seen() -> Any:
    """What `both_ways` says."""
    command = [sys.executable, "-m", "tests.kernels.both_ways"]
    words = {**os.environ, "SINUOUS_KERNELS": "compiled"}
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, env=words)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_no_kernel_raises_when_it_is_interpreted(seen: Any) -> None:
    assert not seen["failed"], "\n".join(seen["failed"])


def test_every_entry_was_compared(seen: Any) -> None:
    assert {entry for piece in PIECES for entry in piece.entries} <= seen["compared"].keys()


def test_answers_are_the_same(seen: Any) -> None:
    assert not seen["apart"], "\n".join(seen["apart"])
    assert max(seen["largest"].values()) <= NEAR


def test_everything_is_compiled_ahead_and_in_one_form(seen: Any) -> None:
    assert sorted(seen["ahead"]) == sorted(entry for piece in PIECES for entry in piece.entries)
    assert seen["late"] == {}
