"""Routes through tubes: from mouth to mouth, over the shortest of them that can be reached."""

from itertools import pairwise

import numpy as np

from sinuous.kernels.tables import (
    QUERY_AXIS,
    QUERY_BACK,
    QUERY_GOAL,
    QUERY_LONGEST,
    QUERY_ORIGIN,
    QUERY_RADIUS,
    QUERY_WIDTH,
)
from sinuous.solver.polylines import lengths_along
from sinuous.solver.routing.tubes import LEGS, route_through, tubes_beside
from tests.helpers import Floats

MOST = 400


def line(*places: tuple[float, float, float]) -> Floats:
    """Nine points of each of the straight pieces between places."""
    corners = np.array(places, float)
    pieces = [np.linspace(a, b, 9)[:-1] for a, b in pairwise(corners)]
    return np.concatenate([*pieces, corners[-1:]])


def asked(goal: tuple[float, float, float]) -> Floats:
    query = np.zeros(QUERY_WIDTH)
    query[QUERY_AXIS + 2], query[QUERY_RADIUS], query[QUERY_LONGEST] = 1.0, 0.1, 20.0
    query[QUERY_GOAL : QUERY_GOAL + 3] = goal
    return query


class Straight:
    """Legs that are straight, but for those that lead across the plane z = 3.5, and to where nothing does."""

    def __init__(self, lost: tuple[float, ...] = ()) -> None:
        self.asked: list[Floats] = []
        self._lost = lost

    def __call__(self, query: Floats) -> Floats | None:
        self.asked.append(query)
        begin, end = query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_GOAL : QUERY_GOAL + 3]
        if (begin[2] < 3.5) != (end[2] < 3.5) or end[0] in self._lost:
            return None
        return np.linspace(begin, end, 10)


NEAR, FAR = line((0.0, 0.0, 3.0), (0.5, 0.0, 3.5), (0.0, 0.0, 4.0)), line((2.0, 0.0, 3.0), (2.0, 0.0, 4.0))


def test_a_route_leads_through_the_nearest_tube_either_way() -> None:
    for axes in ([FAR, NEAR], [FAR[::-1], NEAR[::-1]]):
        leg = Straight()
        route = route_through(axes, asked((0.0, 0.0, 5.0)), leg, leg, MOST)
        assert route is not None
        assert np.allclose(route[[0, -1]], [(0.0, 0.0, 0.0), (0.0, 0.0, 5.0)])
        assert np.linalg.norm(route - (0.5, 0.0, 3.5), axis=1).min() < 0.05
        steps = np.diff(lengths_along(route))
        assert steps.max() <= 1.05 * steps.mean()
        assert len(leg.asked) == 2
        assert np.allclose(leg.asked[0][QUERY_BACK : QUERY_BACK + 3], np.array([-0.5, 0.0, -0.5]) / 0.5**0.5)
        assert np.allclose(leg.asked[1][QUERY_AXIS : QUERY_AXIS + 3], np.array([-0.5, 0.0, 0.5]) / 0.5**0.5)
        assert leg.asked[1][QUERY_LONGEST] < 20.0 - 4.0


def test_where_a_mouth_is_not_reached_another_tube_is_taken() -> None:
    route = route_through([NEAR, FAR], asked((0.0, 0.0, 5.0)), Straight(lost=(0.0,)), Straight(lost=(0.0,)), MOST)
    assert route is None  # the goal has x = 0, too
    route = route_through([NEAR, FAR], asked((1.0, 0.0, 5.0)), Straight(lost=(0.0,)), Straight(), MOST)
    assert route is not None
    assert route[:, 0].max() > 1.9


def test_a_route_leads_through_several_tubes_in_a_row() -> None:
    class Rooms(Straight):
        def __call__(self, query: Floats) -> Floats | None:
            found = super().__call__(query)
            apart = (query[QUERY_ORIGIN + 2] < 6.5) != (query[QUERY_GOAL + 2] < 6.5)
            return None if apart else found

    second = line((1.0, 0.0, 6.0), (1.0, 0.0, 7.0))
    leg = Rooms()
    route = route_through([second, NEAR], asked((0.0, 0.0, 8.0)), leg, leg, MOST)
    assert route is not None
    for place in (NEAR[8], second[4]):
        assert np.linalg.norm(route - place, axis=1).min() < 0.05
    assert len(leg.asked) <= LEGS


def test_there_is_none_that_is_too_long_and_the_search_ends() -> None:
    query = asked((0.0, 0.0, 5.0))
    query[QUERY_LONGEST] = 4.0
    assert route_through([NEAR, FAR], query, Straight(), Straight(), MOST) is None
    leg = Straight(lost=(0.0, 2.0))
    assert route_through([NEAR, FAR] * 4, asked((0.0, 0.0, 5.0)), leg, leg, MOST) is None
    assert len(leg.asked) == LEGS
    assert tubes_beside(np.empty(0), np.empty((0, 10)), 0.0, 1.0) == []
