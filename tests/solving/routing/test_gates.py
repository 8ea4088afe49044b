"""Gates in the narrow places of routes: where they lie."""

from itertools import pairwise

import numpy as np
import pytest

from sinuous import Robot, Scene, Segment, Target
from sinuous.kernels.tables import GOAL, TARGET_POSITION, TARGET_SEGMENT
from sinuous.problem.problem import Problem
from sinuous.solving.routing.gates import NARROW, STRETCHED, WIDE, Passage, Way
from sinuous.solving.routing.growth import LEG_POINTS, divided
from sinuous.solving.routing.turned import Groups
from tests.helpers import Floats, kernel_groups

RADIUS = 0.1
ROBOT = Robot([Segment((0.8, 1.2), 2.0, radius=RADIUS)] * 6)
LINE = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), LEG_POINTS)


def groups(robot: Robot, targets: list[Target], scene: Scene) -> Groups:
    return kernel_groups(Problem(robot, targets, scene))


def straight(distances: Floats) -> Passage:
    return Passage(groups(ROBOT, [Target((0.0, 0.0, 4.8))], Scene()), LINE[None], distances[None])


def ways(passage: Passage) -> list[Way]:
    return [passage.way(i, count) for i, spot in enumerate(passage.places) for count in spot.counts]


def place_of(row: Floats) -> Floats:
    return row[TARGET_POSITION : TARGET_POSITION + 3]


def with_one_narrow_place(first: int, last: int) -> Floats:
    distances = np.full(LEG_POINTS, 10.0 * RADIUS)
    distances[first : last + 1] = 1.5 * RADIUS
    return distances


@pytest.mark.parametrize("at", [40, 80, 110])
def test_gates_lie_about_the_narrow_place_along_the_route(at: int) -> None:
    passage = straight(with_one_narrow_place(at, at))
    found = ways(passage)
    assert passage.room == pytest.approx(1.5)
    assert len(found) > 3
    assert {len(way.rows) for way in found} == {1}
    places = np.array([place_of(way.rows[0]) for way in found])
    assert np.allclose(places[0], LINE[at])
    assert np.abs(places[:, 2] - LINE[at, 2]).max() <= 0.6 + 0.04
    assert np.allclose([way.rows[0][GOAL : GOAL + 3] for way in found], (0.0, 0.0, 1.0))


def test_a_chain_is_long_enough_on_either_side_of_each_gate() -> None:
    for way in ways(straight(with_one_narrow_place(60, 62))):
        before, place = 1 + int(way.rows[0][TARGET_SEGMENT]), way.rows[0][TARGET_POSITION + 2]
        assert 1 <= before < len(ROBOT)
        assert before * 1.2 >= STRETCHED * place - 1e-9
        assert (len(ROBOT) - before) * 1.2 >= STRETCHED * (4.8 - place) - 1e-9


@pytest.mark.parametrize(("first", "last"), [(80, 80), (50, 120)])
def test_no_gate_comes_twice_and_legs_meet_there(first: int, last: int) -> None:
    found = ways(straight(with_one_narrow_place(first, last)))
    kinds = {(way.rows[0][TARGET_SEGMENT], *place_of(way.rows[0])) for way in found}
    assert len(kinds) == len(found) > 3
    for way in found:
        assert len(way.legs) == len(way.rows) + 1
        assert {leg.shape for leg in way.legs} == {(1, LEG_POINTS, 3)}
        assert np.allclose(way.legs[0][0, 0], LINE[0])
        assert np.allclose(way.legs[-1][-1, -1], LINE[-1])
        for (before, beyond), row in zip(pairwise(way.legs), way.rows, strict=True):
            assert np.allclose(before[-1, -1], beyond[0, 0])
            assert np.linalg.norm(before[-1, -1] - place_of(row)) < 0.3 * 1.2 + 0.04


def test_a_long_narrow_place_has_gates_where_it_begins_and_where_it_ends() -> None:
    first, last = 50, 120  # more than two metres
    found = ways(straight(with_one_narrow_place(first, last)))
    for way in found:
        assert LINE[first, 2] <= way.rows[0][TARGET_POSITION + 2] <= LINE[first, 2] + 0.67 * 1.2 + 0.14
    both = [way.rows for way in found if len(way.rows) == 2]
    assert len(both) > 3
    for begin, end in both:
        through = end[TARGET_SEGMENT] - begin[TARGET_SEGMENT]
        apart = end[TARGET_POSITION + 2] - begin[TARGET_POSITION + 2]
        assert end[TARGET_POSITION + 2] <= LINE[last, 2] + 0.3 * 1.2
        assert 0.8 * through * 0.999 <= apart <= 1.2 * through


@pytest.mark.parametrize("dips", [[119, 120], [50], [50, 51, 120]])
def test_where_a_route_cuts_corners_the_channel_is_still_seen(dips: list[int]) -> None:
    """At its mouths a route comes nearer to the walls than in the middle of the channel."""
    distances = with_one_narrow_place(50, 120)
    distances[dips] = 1.15 * RADIUS
    even, cut = (straight(each).places for each in (with_one_narrow_place(50, 120), distances))
    assert [abs(one.at - other.at) <= 2 for one, other in zip(even, cut, strict=True)] == [True] * 3


def test_what_overlaps_all_along_is_no_error() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        straight(RADIUS * rng.normal(size=LEG_POINTS))


def test_what_is_wide_or_narrow_up_to_an_end_has_no_gate() -> None:
    assert not straight(np.full(LEG_POINTS, 1.01 * WIDE * RADIUS)).places
    assert not straight(with_one_narrow_place(0, 80)).places
    assert not straight(with_one_narrow_place(80, LEG_POINTS - 1)).places
    assert not straight(np.full(LEG_POINTS, 1.5 * RADIUS)).places
    assert NARROW > 1.0


def test_with_an_elbow_the_gate_is_on_the_leg_that_is_narrow_and_of_its_segments() -> None:
    targets = [Target((0.0, 0.0, 2.4), segment=3), Target((0.0, 0.0, 4.8))]
    legs = np.stack([np.linspace(one, other, LEG_POINTS) for one, other in pairwise(LINE[[0, 80, -1]])])
    wide, narrow = np.full(LEG_POINTS, 1.0), with_one_narrow_place(80, 80)
    asked = groups(ROBOT, targets, Scene())
    for which, distances in enumerate(([narrow, wide], [wide, narrow])):
        found = ways(Passage(asked, legs, np.stack(distances)))
        assert found
        for way in found:
            assert [len(leg) for leg in way.legs] == [1 + which, 2 - which]
            assert 3 * which <= way.rows[0][TARGET_SEGMENT] < 3 * which + 2


def test_a_route_is_divided_at_the_elbows_that_it_leads_past() -> None:
    elbow = Target((0.05, 0.0, 2.0), segment=3)
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), 300)
    tip = Target((0.0, 0.0, 4.8))
    legs = divided(groups(ROBOT, [elbow, tip], Scene()), route, RADIUS)
    assert legs is not None
    assert legs.shape == (2, LEG_POINTS, 3)
    assert np.allclose(legs[:, [0, -1]], [[route[0], elbow.position], [elbow.position, route[-1]]])
    assert divided(groups(ROBOT, [elbow, tip], Scene()), route, 0.04) is None
    whole = divided(groups(ROBOT, [tip], Scene()), route, RADIUS)
    assert whole is not None
    assert np.allclose(whole, LINE)


@pytest.mark.parametrize("seed", range(100))
def test_whatever_a_place_looks_like_its_ways_lie_along_the_route(seed: int) -> None:
    """Also places that are narrow for so short a stretch, beside their mouths, that no segment lies between them."""
    rng = np.random.default_rng(seed)
    distances = RADIUS * rng.uniform(1.0, 10.0) * np.exp(np.cumsum(rng.normal(0.0, 0.1, LEG_POINTS)))
    for first in rng.integers(0, LEG_POINTS, 2):
        distances[first : first + int(rng.integers(1, 60))] = RADIUS * rng.uniform(-0.2, 2.4)
    for way in ways(straight(distances)):
        segments = [row[TARGET_SEGMENT] for row in way.rows]
        assert segments[0] >= 0
        assert segments[-1] < len(ROBOT) - 1
        assert np.all(np.diff(segments) > 0)
        assert np.all(np.diff([0.0, *(row[TARGET_POSITION + 2] for row in way.rows)]) > 0.0)
