"""One solve under way: what counts, and when it ends."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.tables import (
    BASE_BLOCKED,
    FAILED,
    GIVEN,
    LATE,
    NO_ROUTE,
    OUT_OF_REACH,
    ROUTE,
    SOLVED,
    SOURCES,
    TARGET_BLOCKED,
    UNPROVED,
    Outcome,
)
from sinuous.solver.attempts import ENOUGH, FirstSolved, StartBatch
from sinuous.solver.distinct_solutions import DistinctSearch

NONE = np.empty((0, 2, 3))
IMPOSSIBLE = (OUT_OF_REACH, TARGET_BLOCKED, BASE_BLOCKED, NO_ROUTE)


def outcome(**changed: Any) -> Outcome:
    values: dict[str, Any] = {
        "q": np.zeros((2, 3)),
        "code": FAILED,
        "iterations": 10,
        "starts": 4,
        "source": GIVEN,
        "position_error": 1.0,
        "angle_error": 0.0,
        "clearance": -0.1,
        "self_clearance": 1.0,
        "bound": False,
        "merit": 1.0,
        "seconds": 0.2,
    }
    return Outcome(**(values | changed))


class Hands:
    """A clock that goes on when it is told to."""

    def __init__(self) -> None:
        self.time = 100.0

    def __call__(self) -> float:
        return self.time


def test_it_ends_with_the_starts_or_the_time() -> None:
    search = FirstSolved(outcome(), 8, 1.0)
    assert search.starts_left == 4
    search.take(outcome())
    assert not search.open
    assert search.outcome.code == FAILED
    hands = Hands()
    late = FirstSolved(outcome(), 100, 1.0, hands)
    assert late.seconds_left == pytest.approx(0.8)
    hands.time += 0.9
    assert not late.open
    assert late.outcome.code == LATE


@pytest.mark.parametrize("code", IMPOSSIBLE)
def test_a_proof_in_the_first_call_is_not_tried_again(code: int) -> None:
    search = FirstSolved(outcome(code=code, starts=1), 100, 1.0)
    assert not search.open
    assert (search.outcome.code, search.outcome.starts) == (code, 1)


outcomes = st.builds(
    lambda code, merit, starts, seconds: outcome(code=code, merit=merit, starts=starts, seconds=seconds),
    st.sampled_from([FAILED, UNPROVED, SOLVED]),
    st.floats(0.0, 1.0),
    st.integers(1, 50),
    st.floats(0.0, 0.01),
)


@given(outcomes, st.lists(outcomes, max_size=20), st.integers(1, 300))
def test_effort_adds_up_and_the_best_only_gets_better(first: Outcome, later: list[Outcome], most: int) -> None:
    search = FirstSolved(first, most, 9.0)
    taken = [first]
    for each in later:
        before = search.outcome
        assert search.starts_left <= 0 or 1 <= search.chunk() <= search.starts_left
        search.take(each)
        taken.append(each)
        after = search.outcome
        order = (SOLVED, UNPROVED, FAILED)
        assert (order.index(after.code), after.merit) <= (order.index(before.code), before.merit)
    found = search.outcome
    assert found.starts == sum(each.starts for each in taken)
    assert found.iterations == sum(each.iterations for each in taken)
    best = min(taken, key=lambda each: ((SOLVED, UNPROVED, FAILED).index(each.code), each.merit))
    assert (found.code, found.merit) == (best.code, best.merit)


class Source:
    """Batches one after the other, and how many of them were asked for."""

    def __init__(self, *batches: StartBatch, hands: Hands | None = None) -> None:
        self.asked = 0
        self._batches, self._hands = batches, hands

    def __iter__(self) -> Iterator[StartBatch]:
        for batch in self._batches:
            self.asked += 1
            if self._hands is not None:
                self._hands.time += 0.1
            yield batch


class Answers:
    """A method that gives these answers in turn, and the batches that it was given."""

    def __init__(self, *answers: Outcome) -> None:
        self.seen: list[tuple[StartBatch, float]] = []
        self._answers = iter(answers)

    def __call__(self, batch: StartBatch, seconds: float) -> Outcome:
        self.seen.append((batch, seconds))
        return next(self._answers)


def test_a_proof_on_the_way_ends_the_search() -> None:
    source = Source(
        StartBatch(SOURCES[ROUTE], NONE),
        StartBatch(SOURCES[ROUTE], NONE, closed=0.25),
        StartBatch(SOURCES[ROUTE], NONE),
    )
    search = FirstSolved(outcome(), 100, 9.0)
    search.pursue(iter(source), Answers())
    assert source.asked == 2
    assert (search.outcome.code, search.outcome.cell) == (NO_ROUTE, 0.25)


def at(place: float, **changed: Any) -> Outcome:
    """Return a solution whose backbone is at this place."""
    return outcome(**({"q": np.full((2, 3), place), "code": SOLVED, "starts": 1, "seconds": 0.1} | changed))


def distinct(count: int = 3, most: int = 100) -> DistinctSearch:
    return DistinctSearch(count, 0.5, np.copy, most, 9.0)


def test_solutions_that_are_close_are_one() -> None:
    search = distinct()
    for place in (0.0, 0.1, 1.0, 1.1, -0.1):
        assert search.open
        search.take(at(place))
    assert [each.q[0, 0] for each in search.found] == [0.0, 1.0]
    assert [(each.starts, each.iterations) for each in search.found] == [(1, 10), (3, 30)]
    assert search.open
    search.take(at(2.0))
    assert not search.open


def test_without_a_bound_a_search_goes_on_until_the_time_is_over() -> None:
    hands = Hands()
    search = FirstSolved(outcome(starts=4), None, 1.0, hands)
    for _ in range(20):
        assert search.open
        search.take(outcome(starts=search.chunk()))
    hands.time += 2.0
    assert not search.open
    assert search.outcome.code == FAILED  # so many starts say more than that the time is over
    assert search.outcome.starts > ENOUGH


def test_a_search_that_was_cut_short_says_so() -> None:
    few = FirstSolved(outcome(starts=4), None, 1.0)
    few.take(outcome(code=LATE, starts=ENOUGH - 5))
    assert not few.open
    assert few.outcome.code == LATE
    many = FirstSolved(outcome(starts=4), None, 1.0)
    many.take(outcome(code=LATE, starts=ENOUGH - 4))
    assert many.outcome.code == FAILED
    bounded = FirstSolved(outcome(starts=4), 2 * ENOUGH, 1.0)
    bounded.take(outcome(code=LATE, starts=ENOUGH))
    assert bounded.outcome.code == LATE
