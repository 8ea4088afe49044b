"""The queue of attempts: the cheapest first, scattered starts in proportion, each attempt switched off by its name."""

import re
from collections.abc import Callable, Iterator
from functools import cache, partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from sinuous import Box, Capsule, Robot, Scene, Sphere, Target, Tolerance
from sinuous.base.errors import InputError
from sinuous.kernels.tables import GIVEN, ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.scene.obstacles import Obstacle
from sinuous.solver import strategy as own
from sinuous.solver.attempts import (
    ATTEMPTS,
    EFFORT_OF_A_CHAIN,
    Attempt,
    AttemptQueue,
    IKQuery,
    RandomRestarts,
    StartBatch,
    read_without,
)
from sinuous.solver.options import SolveOptions
from sinuous.solver.route_classes.passages import Passages
from sinuous.solver.routing.growth import FIRST_WIDTH
from sinuous.solver.routing.searches import Searches, SearchPlan
from sinuous.solver.strategy import Strategy, attempts_of, plans_of
from tests.cases import with_each
from tests.helpers import Floats
from tests.solver.routing.questions import asked as asked_of
from tests.solver.routing.questions import place

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
SCENE = Scene([Sphere((0, 0, 2.2), 0.7), Sphere((0.9, 0.2, 3.1), 0.4)])
TARGET = Target((0, 0, 4.4))
WIDEST = 8 * FIRST_WIDTH
"""Of beams that the tests wait for; nearly all of the time goes into wide ones."""
Make = Callable[[], Iterator[StartBatch]]


def question(scene: Scene = SCENE, seconds: float = 60.0, several: bool = False, given: int = 0) -> IKQuery:
    return IKQuery(Problem(ROBOT, TARGET, scene), np.zeros((given, 5, 3)), lambda: seconds, several)


def alone(without: tuple[str, ...] = (), last: int = 100, seconds: float = 60.0) -> AttemptQueue:
    """A queue that knows of no routes."""
    return AttemptQueue(question(Scene(), seconds), RandomRestarts(3, last), without=without)


def searching(scene: Scene = SCENE, several: bool = False, without: tuple[str, ...] = ()) -> AttemptQueue:
    searches = Searches(ROBOT, scene, Tolerance().for_robot(ROBOT))
    return attempts_of(question(scene, several=several), RandomRestarts(3, 1000), searches, without=without)


def made(strategy: AttemptQueue, monkeypatch: pytest.MonkeyPatch) -> list[Attempt]:
    """All attempts that are made, in order."""
    attempts: list[Attempt] = []
    following = strategy._next

    def popped() -> Attempt:
        attempts.append(following())
        return attempts[-1]

    monkeypatch.setattr(strategy, "_next", popped)
    list(strategy.batches())
    return attempts


@cache
def everything_made() -> list[Attempt]:
    """All attempts of a search from which nothing is left out."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(own, "LAST_WIDTH", WIDEST)
        return made(searching(), patch)


@pytest.fixture(autouse=True)
def few_passages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Close passages and lead routes aside a few times and no more: each searches, or grows chains."""
    monkeypatch.setattr(own, "PASSAGES_SEARCHES", 6)
    monkeypatch.setattr(own, "DETOURS", 4)


@pytest.fixture
def narrow_beams(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let beams widen once and no more: nearly all of the time goes into wide ones."""
    monkeypatch.setattr(own, "LAST_WIDTH", 2 * FIRST_WIDTH)


def noted(order: list[str], name: str) -> Make:
    """Make nothing, and note that it was made."""

    def make() -> Iterator[StartBatch]:
        order.append(name)
        return iter(())

    return make


def chains(count: int, cost: float = 0.0) -> Iterator[StartBatch]:
    yield StartBatch(SOURCES[ROUTE], np.zeros((count, 5, 3)), cost=cost)


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 3)), max_size=12))
def test_attempts_come_by_price_and_those_of_one_price_in_order(asked: list[tuple[int, int]]) -> None:
    strategy, order = alone(("scattered",)), list[int]()
    for number, (price, size) in enumerate(asked):

        def make(number: int = number, size: int = size) -> Iterator[StartBatch]:
            order.append(number)
            return chains(size)

        strategy.add("grown", price, make)
    list(strategy.batches())
    assert order == sorted(range(len(asked)), key=lambda i: (asked[i][0], i))


def test_an_attempt_may_add_others_which_come_in_their_turn() -> None:
    strategy, order = alone(("scattered",)), list[str]()

    def first() -> Iterator[StartBatch]:
        order.append("first")
        strategy.add("laid", 0, noted(order, "cheap"))
        strategy.add("laid", 9, noted(order, "dear"))
        return iter(())

    strategy.add("grown", 1, first)
    strategy.add("grown", 5, noted(order, "second"))
    list(strategy.batches())
    assert order == ["first", "cheap", "second", "dear"]


@pytest.mark.parametrize(("seconds", "most"), [(60.0, 6), (0.0, 0)])
def test_searches_through_other_passages_end_when_the_time_does(
    seconds: float, most: int, monkeypatch: pytest.MonkeyPatch, narrow_beams: None
) -> None:
    searched: list[int] = []
    routes = Passages.routes

    def counted(self: Passages, closed: frozenset[int], plan: SearchPlan) -> tuple[list[Floats], int]:
        searched.append(len(closed))
        return routes(self, closed, plan)

    monkeypatch.setattr(Passages, "routes", counted)
    searches = Searches(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    list(attempts_of(question(seconds=seconds), RandomRestarts(3, 1000), searches).batches())
    assert len(searched) == most


def test_nothing_is_made_before_it_is_asked_for_or_after_the_deadline() -> None:
    strategy, calls = alone(), list[str]()
    strategy.add("grown", 1, noted(calls, "one"))
    batches = strategy.batches()
    assert not calls
    next(batches)
    assert calls == ["one"]
    late = alone(seconds=0.0)
    late.add("grown", 1, noted(calls, "late"))
    assert {batch.source for batch in late.batches()} == {"random"}
    assert calls == ["one"]


@given(st.lists(st.tuples(st.integers(0, 20), st.floats(0, 30), st.integers(0, 3)), max_size=10))
def test_scattered_starts_are_in_proportion_to_what_others_cost(asked: list[tuple[int, float, int]]) -> None:
    without = set(ATTEMPTS) - {"grown", "scattered"}
    searches = Searches(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    strategy = attempts_of(question(), RandomRestarts(3, 5000), searches, without=without)
    for price, more, size in asked:
        strategy.add("grown", price, partial(chains, size, more))
    batches = list(strategy.batches())
    costs = sum(price + more + EFFORT_OF_A_CHAIN * size for price, more, size in asked)
    assert strategy.ledger["grown"] == pytest.approx(costs)
    scattered = strategy.ledger["scattered"]
    share = own.SHARE_AMONG_BALLS * costs
    assert share - 1 < max(share, scattered) <= max(share, own.SCATTERED_FIRST) + 1
    assert share - 1 < scattered
    numbers = [i for batch in batches for i in range(*batch.own)]
    assert numbers == list(range(3, 5000))


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (Capsule((3, 0, 0), (3, 0, 1), 0.2), own.SHARE_AMONG_BALLS),
        (Box((3, 0, 0), (0.2, 0.2, 0.2)), own.SHARE),
        (Sphere((0, 0, 0), 9.0, inside=True), own.SHARE),
    ],
)
def test_among_balls_alone_more_starts_are_scattered(other: Obstacle, share: float) -> None:
    assert searching(Scene([*SCENE.obstacles, other]))._share == share


def test_an_attempt_that_had_nothing_to_do_costs_nothing() -> None:
    strategy = alone()
    strategy.add("grown", 50, lambda: iter(()))
    assert sum(batch.size for batch in strategy.batches()) == 97
    assert not any(strategy.ledger.values())


@with_each("given", [0, 1])
@with_each("most", [1, 2, own.OPENING, own.OPENING_ALONE, 1000])
@with_each("routes", [False, True])
def test_the_first_call_is_one_batch_and_scattered_starts_go_on_from_there(given: int, most: int, routes: bool) -> None:
    options = SolveOptions(max_starts=most, routes=routes)
    strategy = Strategy(ROBOT, SCENE, Tolerance().for_robot(ROBOT), options)
    batch = strategy.opening(question(given=given))
    assert batch.source == SOURCES[GIVEN]
    assert len(batch.initial) == given
    assert batch.own == (0, strategy.opening_starts(given))
    assert batch.own[1] == max(0, min(most, own.OPENING if routes else own.OPENING_ALONE) - given)
    rest = strategy.batches(question(given=given, seconds=0.0))
    numbers = [i for each in rest for i in range(*each.own)]
    assert numbers == list(range(batch.own[1], most - given))


@pytest.mark.usefixtures("narrow_beams")
@pytest.mark.parametrize("name", ATTEMPTS)
def test_what_is_switched_off_is_not_made(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert name not in {attempt.name for attempt in made(searching(without=(name,)), monkeypatch)}


@with_each("name", ATTEMPTS)
def test_a_solve_takes_what_is_switched_off(name: str) -> None:
    solution = sn.solve(ROBOT, TARGET, SCENE, without=name, time=20.0)
    assert solution.solved
    assert solution._resolver.solve(solution.problem).solved


def test_without_any_route_only_scattered_starts_are_left() -> None:
    off = tuple(name for name in ATTEMPTS if name != "scattered")
    assert {batch.source for batch in searching(without=off).batches()} == {"random"}


@with_each(
    ("names", "value"), [("hops", "'hops'"), (("grown", "hops"), "'hops'"), (7, "7"), ((7,), "7"), (None, "None")]
)
def test_an_attempt_that_is_not_known_is_refused(names: object, value: str) -> None:
    with pytest.raises(InputError, match=f"^without: .*scattered, .*passages, got {re.escape(value)}") as told:
        read_without(names)
    assert "\n" not in str(told.value)


def test_names_are_read_in_any_order_and_once() -> None:
    assert read_without("grown") == ("grown",)
    assert read_without(["gates", "grown", "gates"]) == ("grown", "gates")
    assert read_without(()) == ()


def test_prices_grow_with_what_is_tried() -> None:
    prices = own.GATES_COSTS
    assert list(prices.items()) == sorted(prices.items(), key=lambda each: each[1])
    assert list(prices) == sorted(prices)
    for family in ("pipe 1.3", "hall", "spheres 12"):
        prices_of = [price for price, _ in plans_of(asked_of(place(family, 0))[0])]
        assert prices_of == sorted(prices_of)


def test_attempts_come_with_more_effort_later() -> None:
    attempts = everything_made()
    assert {"laid", "grown", "cells", "gates"} <= {attempt.name for attempt in attempts}
    prices = [attempt.price for attempt in attempts]
    assert all(
        before <= after or attempts[i + 1].number > attempts[i].number
        for i, (before, after) in enumerate(pairwise(prices))
    )


@pytest.mark.usefixtures("narrow_beams")
def test_nothing_is_tried_twice() -> None:
    tried = [q.tobytes() for batch in searching().batches() for q in batch.initial]
    assert len(tried) == len(set(tried))


def test_beams_widen_as_long_as_there_is_time() -> None:
    prices = [attempt.price for attempt in everything_made() if attempt.name == "grown"]
    assert max(prices) >= own.GROWN_COST * WIDEST


@pytest.mark.usefixtures("narrow_beams")
def test_where_several_are_wanted_chains_are_grown_after_all_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    names = [attempt.name for attempt in made(searching(several=True), monkeypatch)]
    assert "gates" not in names
    assert "grown" in names
    assert max(i for i, name in enumerate(names) if name == "cells") < names.index("grown")


@pytest.mark.parametrize(("share", "first"), [(0.95, "laid"), (1.05, "gates")])
def test_a_chain_that_has_to_be_stowed_is_led_through_gates_first(
    share: float, first: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    shortest = sum(segment.length[0] for segment in ROBOT.segments)
    length = shortest / (share * 1.1)
    monkeypatch.setattr(Searches, "by_edges", lambda *_: np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, length), 40))
    names = [attempt.name for attempt in made(searching(without=("grown",)), monkeypatch)]
    assert next(name for name in names if name in ("laid", "gates")) == first


@pytest.mark.usefixtures("narrow_beams")
def test_over_cells_the_first_search_waits_where_a_route_around_edges_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Searches, "by_edges", lambda *_: np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.4), 40))
    attempts = made(searching(), monkeypatch)
    cells = [attempt.price for attempt in attempts if attempt.name == "cells"]
    assert cells[:2] == [own.AT_ONCE, own.AFTER_EDGES]
    names = [attempt.name for attempt in attempts]
    second = [i for i, name in enumerate(names) if name == "cells"][1]
    assert {"laid", "grown", "gates"} <= set(names[:second])
