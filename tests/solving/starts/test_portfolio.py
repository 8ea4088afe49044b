"""The order of start sources, and that none works before it is asked."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
import pytest

from sinuous.kernels.tables import GIVEN, RANDOM, ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
from sinuous.solving.starts.portfolio import ALONE, LOCAL, Portfolio
from sinuous.solving.starts.sources import Batch, Question

PROBLEM = Problem(Robot.uniform(2, 1.0), Target((0.0, 0.0, 2.0)))


class Routes:
    """A source of routes that says when it was asked."""

    name = SOURCES[ROUTE]

    def __init__(self, *then: int) -> None:
        self.asked = 0
        self._then = then

    def batches(self, question: Question) -> Iterator[Batch]:
        for then in self._then:
            self.asked += 1
            yield Batch(self.name, np.zeros((1, 2, 3)), then=then)


def question(given: int = 0) -> Question:
    return Question(PROBLEM, np.zeros((given, 2, 3)), lambda: 1.0)


def listed(portfolio: Portfolio, given: int = 0) -> list[tuple[str, int, tuple[int, int]]]:
    return [(batch.source, len(batch.initial), batch.own) for batch in portfolio.batches(question(given))]


def test_without_routes_the_opening_and_then_what_is_scattered() -> None:
    assert listed(Portfolio(100)) == [("given", 0, (0, ALONE)), ("random", 0, (ALONE, 100))]
    assert listed(Portfolio(100), 1) == [("given", 1, (0, ALONE - 1)), ("random", 0, (ALONE - 1, 99))]


def test_routes_and_scattered_starts_take_turns() -> None:
    assert listed(Portfolio(100, Routes(0, 20, 30))) == [
        ("given", 0, (0, LOCAL)),
        ("route", 1, (0, 0)),
        ("random", 0, (LOCAL, LOCAL)),
        ("route", 1, (0, 0)),
        ("random", 0, (LOCAL, LOCAL + 20)),
        ("route", 1, (0, 0)),
        ("random", 0, (LOCAL + 20, LOCAL + 50)),
        ("random", 0, (LOCAL + 50, 100)),
    ]


@pytest.mark.parametrize("given", [0, 1])
@pytest.mark.parametrize("most", [1, 2, LOCAL, ALONE, 1000])
@pytest.mark.parametrize("routes", [None, Routes(5, 7)])
def test_every_own_start_comes_once_and_no_more_than_allowed(given: int, most: int, routes: Routes | None) -> None:
    batches = list(Portfolio(most, routes).batches(question(given)))
    numbers = [i for batch in batches for i in range(*batch.own)]
    assert numbers == list(range(most - given))
    assert sum(len(batch.initial) for batch in batches if batch.source == SOURCES[GIVEN]) == given


def test_a_source_works_only_when_its_batch_is_asked_for() -> None:
    routes = Routes(1, 1, 1)
    batches = Portfolio(100, routes).batches(question())
    assert next(batches).source == SOURCES[GIVEN]
    assert routes.asked == 0
    assert [batch.source for batch in islice(batches, 2)] == [SOURCES[ROUTE], SOURCES[RANDOM]]
    assert routes.asked == 1


def test_further_begins_after_the_opening() -> None:
    portfolio = Portfolio(100, Routes(3))
    whole = list(portfolio.batches(question(1)))
    rest = list(portfolio.further(question(1)))
    assert [(batch.source, batch.own) for batch in rest] == [(batch.source, batch.own) for batch in whole[1:]]
