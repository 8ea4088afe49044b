"""One solve under way: what counts, and when it ends."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.tables import FAILED, GIVEN, LATE, SOLVED, UNPROVED, Outcome
from sinuous.solver.attempts import ENOUGH, FirstSolved


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
