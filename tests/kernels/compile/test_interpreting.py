"""Interpreted, kernels do what machine code does, also where Python raises, and remain the source that stands there."""

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.maths.vectors import Array

HERE = Path(__file__).parents[3]


def operations(x: float, y: float, k: int, out: Array) -> int:
    """Operations that Python refuses for some numbers."""
    out[0] = x / y
    out[1] = math.sqrt(x)
    out[2] = math.acos(x)
    out[3] = math.log(abs(y))
    out[4] = math.exp(x)
    out[5] = abs(x) ** y
    out[6] = math.sin(x)
    total = x
    total /= y
    out[7] = total
    out[8] = x
    out[8] /= y
    key = k + 1
    for _ in range(5):
        key = key * 1000003 + k
    out[10] = float(key % 1000)
    out[9] = float(np.uint64(k) * np.uint64(0x9E3779B97F4A7C15) >> np.uint64(40))
    return int(x)


CASES = [
    (x, y, k)
    for k, (x, y) in enumerate(
        (x, y) for x in (0.5, -1.0, 0.0, -0.0, 1e300, 1000.0, math.inf, -math.inf, math.nan) for y in (2.0, 0.0, -1.0)
    )
]


@pytest.fixture(scope="module")
def both() -> Any:
    return compiling.entry(operations)


@pytest.mark.parametrize(("x", "y", "k"), CASES)
def test_what_python_refuses_is_what_the_processor_says(both: Any, x: float, y: float, k: int) -> None:
    compiled, interpreted = np.zeros(11), np.zeros(11)
    for number in (k, -k):
        assert both(x, y, number, compiled) == both.interpreted(x, y, number, interpreted)
        np.testing.assert_allclose(interpreted, compiled, rtol=1e-15, atol=0.0)


def process(*command: str, mode: str = "interpreted") -> subprocess.CompletedProcess[str]:
    """Run Python in a process of its own, in which nothing can be compiled."""
    words = {**os.environ, "SINUOUS_KERNELS": mode, "NUMBA_DISABLE_JIT": "0", "SINUOUS_CACHE": os.devnull}
    return subprocess.run([sys.executable, *command], capture_output=True, text=True, check=False, cwd=HERE, env=words)


SOLVE = """
import numba.core.dispatcher
def refuse(*_): raise AssertionError("compiled")
numba.core.dispatcher.Dispatcher.compile = refuse
import sinuous as sn
robot = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05)
for scene in (None, [sn.Sphere((0.5, 0, 1.5), 0.2)]):
    assert sn.solve(robot, sn.Target((1, 0, 2), direction=(1, 0, 0.5)), scene).solved
"""


def test_nothing_is_compiled_where_all_is_interpreted() -> None:
    done = process("-c", SOLVE)
    assert (done.returncode, done.stderr) == (0, "")


BREAK = """
import pdb, sys
from tests.kernels.compile import parts
debugger = pdb.Pdb(nosigint=True, readrc=False)
debugger.rcLines = ["break tests/kernels/compile/parts.py:15", "continue", "print('seen', x, y)", "quit"]
debugger.runcall(parts.twice_the_norm, 3.0, 4.0)
"""


def test_a_debugger_stops_within_a_kernel() -> None:
    assert "seen 3.0 4.0" in process("-c", BREAK).stdout
