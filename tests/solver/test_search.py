"""One solve under way: what counts, and when it ends."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.base.checks import Floats
from sinuous.kernels.tables import (
    ARC,
    BASE_BLOCKED,
    FAILED,
    GIVEN,
    LATE,
    NO_ROUTE,
    OUT_OF_REACH,
    RANDOM,
    ROUTE,
    SOLVED,
    SOURCES,
    TARGET_BLOCKED,
    UNPROVED,
    Outcome,
)
from sinuous.solver.attempts import StartBatch
from sinuous.solver.distinct_solutions import PATIENCE, DistinctSearch
from sinuous.solver.options import UNBOUNDED
from sinuous.solver.search import ENOUGH, FirstSolved

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


def test_the_better_counts_with_the_effort_of_all() -> None:
    hands = Hands()
    search = FirstSolved(outcome(), 100, 1.0, hands)
    search.take(outcome(merit=0.5, source=RANDOM))
    search.take(outcome(merit=0.7, source=ROUTE))
    hands.time += 0.5
    found = search.outcome
    assert (found.merit, found.source, found.starts, found.iterations) == (0.5, RANDOM, 12, 30)
    assert found.seconds == pytest.approx(0.2 + 0.5)
    assert search.open


def test_it_ends_with_what_is_solved() -> None:
    search = FirstSolved(outcome(merit=1e-9), 100, 1.0)
    search.take(outcome(code=SOLVED, merit=1e-8))
    assert not search.open
    assert search.outcome.code == SOLVED


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


def test_an_unproved_answer_stays_one_when_the_time_is_up() -> None:
    search = FirstSolved(outcome(code=UNPROVED), 100, 0.1)
    assert not search.open
    assert search.outcome.code == UNPROVED


def test_what_is_only_not_proved_is_better_than_what_failed() -> None:
    search = FirstSolved(outcome(code=UNPROVED, merit=1e-8), 100, 9.0)
    search.take(outcome(code=FAILED, merit=1e-9))
    assert search.outcome.code == UNPROVED
    search.take(outcome(code=UNPROVED, merit=1e-9, source=ARC))
    assert (search.outcome.code, search.outcome.source) == (UNPROVED, ARC)
    search.take(outcome(code=SOLVED, merit=1.0))
    assert search.outcome.code == SOLVED


def test_a_late_start_ends_it() -> None:
    search = FirstSolved(outcome(merit=0.5), 100, 9.0)
    search.take(outcome(code=LATE, merit=0.7))
    assert not search.open
    assert (search.outcome.code, search.outcome.merit) == (LATE, 0.5)


@pytest.mark.parametrize("code", IMPOSSIBLE)
def test_a_proof_in_the_first_call_is_not_tried_again(code: int) -> None:
    search = FirstSolved(outcome(code=code, starts=1), 100, 1.0)
    assert not search.open
    assert (search.outcome.code, search.outcome.starts) == (code, 1)


def test_a_proof_that_there_is_nothing_ends_it() -> None:
    search = FirstSolved(outcome(), 100, 1.0)
    search.close(0.05)
    assert not search.open
    assert (search.outcome.code, search.outcome.cell) == (NO_ROUTE, 0.05)


def test_calls_grow_till_the_starts_are_used_up() -> None:
    assert FirstSolved(outcome(starts=4), 1000, 1.0).chunk() == 4
    assert FirstSolved(outcome(starts=0), 1000, 1.0).chunk() == 1
    assert FirstSolved(outcome(starts=4), 6, 1.0).chunk() == 2


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


def initial(count: int) -> Floats:
    return np.arange(6.0 * count).reshape(count, 2, 3)


def test_no_more_is_asked_for_than_is_needed() -> None:
    hands = Hands()
    source = Source(*[StartBatch(SOURCES[ROUTE], initial(2))] * 3, hands=hands)
    method = Answers(outcome(starts=1), outcome(starts=1, code=SOLVED))
    search = FirstSolved(outcome(starts=1, seconds=0.5), 100, 9.0, hands)
    search.pursue(iter(source), method)
    assert source.asked == 1
    assert (search.outcome.code, search.outcome.source) == (SOLVED, ROUTE)
    assert [len(batch.initial) for batch, _ in method.seen] == [1, 1]
    # What the batch cost is off the budget, and so is the call before.
    assert [seconds for _, seconds in method.seen] == pytest.approx([9.0 - 0.6, 9.0 - 0.6])


def test_nothing_is_asked_for_when_it_is_over() -> None:
    source = Source(StartBatch(SOURCES[ROUTE], initial(1)))
    for first, most, seconds in (
        (outcome(code=SOLVED), 100, 9.0),
        (outcome(code=OUT_OF_REACH), 100, 9.0),
        (outcome(), 4, 9.0),
        (outcome(), 100, 0.2),
    ):
        FirstSolved(first, most, seconds).pursue(iter(source), Answers())
    assert source.asked == 0


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


def test_a_method_without_such_starts_is_asked_once() -> None:
    source = Source(StartBatch(SOURCES[RANDOM], NONE, (4, 40)), StartBatch(SOURCES[RANDOM], NONE, (40, 50)))
    method = Answers(outcome(starts=0))
    FirstSolved(outcome(), 100, 9.0).pursue(iter(source), method)
    assert source.asked == 1
    assert [batch.own[0] for batch, _ in method.seen] == [4]


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


def test_only_what_is_solved_is_a_solution() -> None:
    search = distinct()
    for code in (FAILED, UNPROVED, LATE):
        search.take(at(1.0, code=code))
    assert search.found == []
    assert search.open


@pytest.mark.parametrize("code", IMPOSSIBLE)
def test_proofs_end_the_search_for_more(code: int) -> None:
    search = distinct()
    search.take(at(0.0, code=code))
    assert not search.open
    closed = distinct()
    closed.close(0.1)
    assert not closed.open


def test_every_start_is_followed_by_itself() -> None:
    method = Answers(*(at(float(i)) for i in range(5)))
    search = distinct(count=5)
    search.pursue(iter(Source(StartBatch(SOURCES[GIVEN], initial(2), (0, 9)))), method)
    assert [(len(batch.initial), batch.own) for batch, _ in method.seen] == [
        (1, (0, 0)),
        (1, (0, 0)),
        (0, (0, 1)),
        (0, (1, 2)),
        (0, (2, 3)),
    ]
    assert len(search.found) == 5


def test_the_starts_are_counted() -> None:
    search = distinct(count=50, most=3)
    method = Answers(*(at(float(i)) for i in range(9)))
    search.pursue(iter(Source(StartBatch(SOURCES[RANDOM], NONE, (0, 9)))), method)
    assert len(method.seen) == 3


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


def test_distinct_solutions_are_not_sought_for_ever() -> None:
    search = DistinctSearch(9, 0.1, lambda q: q, UNBOUNDED, 60.0)
    search.take(outcome(code=FAILED, starts=5 * PATIENCE))
    assert search.open
    search.take(outcome(code=SOLVED))
    search.take(outcome(code=SOLVED, starts=PATIENCE - 1))
    assert search.open
    search.take(outcome(code=SOLVED, source=ROUTE, starts=9))
    assert search.open
    search.take(outcome(code=SOLVED))
    assert not search.open
