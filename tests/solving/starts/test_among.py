"""Batches of one source come between those of another, by what these cost."""

import numpy as np

from sinuous.solving.starts.among import A_START, among
from sinuous.solving.starts.sources import Batch


def batch(source: str, starts: int = 0, then: int = 0) -> Batch:
    return Batch(source, np.zeros((starts, 2, 3)), then=then)


def order(batches: list[Batch], costs: dict[int, int]) -> list[str]:
    return [each.source for each in among(batches, costs, lambda effort: [batch(f"effort {effort}")])]


def test_efforts_come_when_batches_have_cost_as_much() -> None:
    batches = [batch("a", then=5), batch("b", starts=2), batch("c")]
    assert order(batches, {1: 0, 2: 5, 3: 5 + 2 * A_START}) == ["effort 1", "a", "effort 2", "b", "effort 3", "c"]
    assert order(batches, {1: 4, 2: 5}) == ["a", "effort 1", "effort 2", "b", "c"]


def test_what_is_not_due_comes_at_the_end_and_without_efforts_batches_stay_as_they_are() -> None:
    assert order([batch("a")], {1: 7, 2: 1000}) == ["a", "effort 1", "effort 2"]
    assert order([], {1: 7}) == ["effort 1"]
    assert order([batch("a"), batch("b")], {}) == ["a", "b"]


def test_nothing_is_made_before_it_is_asked_for() -> None:
    efforts: list[int] = []

    def made(effort: int) -> list[Batch]:
        efforts.append(effort)
        return []

    mixed = among([batch("a", then=9), batch("b")], {1: 9}, made)
    assert next(mixed).source == "a"
    assert efforts == []
    assert next(mixed).source == "b"
    assert efforts == [1]
