"""Work in processes: every item once, in order, and each process on a core of its own."""

import os
import warnings

import pytest

from benchmarks.solvers import parallel
from benchmarks.solvers.parallel import in_processes
from sinuous.problem.suspicions import warn_of


def square(number: int) -> int:
    return number * number


def cores_of(_: int) -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def test_results_come_in_order() -> None:
    assert list(in_processes(square, range(7), chunk=2)) == [n * n for n in range(7)]
    assert list(in_processes(square, range(3), alone=True)) == [0, 1, 4]


def test_processes_keep_to_their_cores() -> None:
    assert set(in_processes(cores_of, range(3))) == {1}


def heard(_: int) -> int:
    """How many warnings of an odd problem are heard."""
    with warnings.catch_warnings(record=True) as caught:
        warn_of(["odd"])
    return len(caught)


def test_odd_problems_are_not_complained_of() -> None:
    assert set(in_processes(heard, range(3))) == {0}


def test_processes_end_when_what_gathers_stops() -> None:
    """As at an interrupt; afterwards there are new ones."""
    results = in_processes(square, range(1000))
    assert next(results) == 0
    before = parallel._pool()
    results.close()  # type: ignore[attr-defined]
    with pytest.raises(RuntimeError, match="shutdown"):
        before.submit(square, 1)
    assert list(in_processes(square, range(2))) == [0, 1]
