"""Tests of processes that work for another one."""

import signal
import subprocess
import sys

import pytest

from sinuous.base.system import pool_of
from tests.base.processes import alive, until

PROGRAM = """
import os, time
from sinuous.base.system import pool_of
print(pool_of(1, int).submit(os.getpid).result(), flush=True)
time.sleep(600)
"""


def test_a_process_begins_with_what_it_is_given() -> None:
    with pool_of(1, sys.setrecursionlimit, 777) as pool:
        assert pool.submit(sys.getrecursionlimit).result() == 777


@pytest.mark.parametrize("end", [signal.SIGTERM, getattr(signal, "SIGKILL", signal.SIGTERM)])
def test_a_process_ends_however_its_program_ends(end: signal.Signals) -> None:
    with subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        worker = int(program.stdout.readline())
        assert alive(worker)
        program.send_signal(end)
    assert until(lambda: not alive(worker))
