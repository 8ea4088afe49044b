"""One solve under way."""

from typing import Any

import numpy as np

from sinuous.kernels.tables import FAILED, LATE, NO_ROUTE, SOLVED, UNPROVED, Outcome
from sinuous.solving.search import Search


def outcome(**changed: Any) -> Outcome:
    values: dict[str, Any] = {
        "q": np.zeros((2, 3)),
        "code": FAILED,
        "iterations": 10,
        "starts": 4,
        "kind": 0,
        "position_error": 1.0,
        "angle_error": 0.0,
        "clearance": -0.1,
        "bound": False,
        "merit": 1.0,
        "seconds": 0.2,
    }
    return Outcome(**(values | changed))


def test_the_better_counts_with_the_effort_of_all() -> None:
    search = Search(outcome(), 100, 1.0)
    search.take(outcome(merit=0.5, kind=2))
    search.take(outcome(merit=0.7, kind=3))
    search.spend(0.1)
    found = search.outcome
    assert (found.merit, found.kind, found.starts, found.iterations) == (0.5, 2, 12, 30)
    assert found.seconds == 0.2 * 3 + 0.1
    assert search.open


def test_it_ends_with_what_is_solved() -> None:
    search = Search(outcome(merit=1e-9), 100, 1.0)
    search.take(outcome(code=SOLVED, merit=1e-8))
    assert not search.open
    assert search.outcome.code == SOLVED


def test_it_ends_with_the_starts_or_the_time() -> None:
    search = Search(outcome(), 8, 1.0)
    assert search.starts_left == 4
    search.take(outcome())
    assert not search.open
    assert search.outcome.code == FAILED
    late = Search(outcome(), 100, 1.0)
    late.spend(0.9)
    assert not late.open
    assert late.outcome.code == LATE


def test_an_unproved_answer_stays_one_when_the_time_is_up() -> None:
    search = Search(outcome(code=UNPROVED), 100, 0.1)
    assert not search.open
    assert search.outcome.code == UNPROVED


def test_a_proof_that_there_is_nothing_ends_it() -> None:
    search = Search(outcome(), 100, 1.0)
    search.close(0.05)
    assert not search.open
    assert (search.outcome.code, search.outcome.cell) == (NO_ROUTE, 0.05)


def test_batches_grow_as_long_as_they_are_quick() -> None:
    assert Search(outcome(seconds=1e-3), 1000, 1.0).affordable(0.1) == 4
    assert Search(outcome(seconds=0.4), 1000, 1.0).affordable(0.1) == 1
    assert Search(outcome(seconds=1e-3), 6, 1.0).affordable(0.1) == 2
