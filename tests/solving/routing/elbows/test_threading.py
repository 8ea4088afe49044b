"""Chains through the tube that an elbow lies in: in by the mouth that the length of the robot asks for."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places import Place
from sinuous import Scene, Solver
from sinuous.solving.routing.elbows.threading import Elbows
from sinuous.solving.routing.growth import GLANCE, ONE
from sinuous.solving.starts import Batch
from sinuous.solving.strategy import ELBOWS_PRICES
from tests.solving.routing.questions import asked, place

HARD = [
    ("pipe between", 4),
    ("pipe between", 17),
    ("pipe between", 33),
    ("pipe between", 79),
    ("cells", 113),
    ("pipe between", 141),
]
"""Places whose elbow lies in a pipe, that the body enters by the mouth that is farther from the base."""

AMONG_WALLS = ("box duct", 28)
"""A place with an elbow, and walls about the base."""


def threading(at: Place, several: bool = False, seconds: float = 60.0) -> Elbows:
    return Elbows(*asked(at, several, seconds))


def chains(at: Place, several: bool = False, seconds: float = 60.0) -> list[Batch]:
    source = threading(at, several, seconds)
    return [batch for beam in ELBOWS_PRICES for batch in source.chains(beam)]


@pytest.mark.parametrize(("family", "number"), HARD)
def test_a_chain_is_led_through_the_tube_to_the_elbow(family: str, number: int) -> None:
    at = place(family, number)
    solver = Solver(at.robot, at.scene, tolerance=at.tolerance, routes=False, max_starts=1)
    batch = next(b for b in chains(at) if solver.solve(at.targets, b.initial[0], time=30.0).solved)
    assert at.robot.excess(batch.initial[0]) <= 1e-9
    elbow, tip = (np.asarray(target.position, float) for target in at.targets)
    (route,) = batch.routes
    assert np.allclose(route[0], at.robot.base[:3, 3])
    assert np.linalg.norm(route - elbow, axis=1).min() < max(at.robot.radii)
    assert np.linalg.norm(route[-1] - tip) <= np.linalg.norm(at.robot.tool[:3, 3]) + max(at.robot.radii)


def test_where_no_edges_say_a_route_one_is_searched_for_with_more_effort() -> None:
    source = threading(place("cells", 113))
    assert list(source.chains(GLANCE))
    assert source._guessed
    first = [parts for _, parts in source._parts]
    list(source.chains(ONE))
    assert not source._guessed
    assert all(parts not in first for _, parts in source._parts)
    for way, _ in source._parts:
        line = np.concatenate([leg[0] for leg in way.legs])
        assert place("cells", 113).scene.distance(line).min() > 0.5 * min(place("cells", 113).robot.radii)


@pytest.mark.parametrize(("family", "number"), HARD)
def test_such_places_are_solved(family: str, number: int) -> None:
    at = place(family, number)
    solution = sn.solve(at.robot, at.targets, at.scene, tolerance=at.tolerance, time=60.0)
    assert solution.solved
    assert all(sn.check(at.robot, solution.q, at.scene, target, tolerance=at.tolerance).ok for target in at.targets)
    assert solution.start == "route"
    assert solution.starts < 30


def test_it_makes_no_chains_without_an_elbow_in_a_tube_without_time_or_for_several_solutions() -> None:
    at = place(*HARD[0])
    assert chains(at, seconds=0.0) == []
    assert chains(at, several=True) == []
    free = Place(at.family, at.seed, at.robot, Scene(), at.targets, at.tolerance, at.hidden_q)
    assert chains(free) == []
    one = Place(at.family, at.seed, at.robot, at.scene, at.targets[1:], at.tolerance, at.hidden_q)
    assert chains(one) == []


def test_walls_about_the_base_are_seen() -> None:
    assert threading(place(*AMONG_WALLS)).from_inside
    assert not threading(place(*HARD[0])).from_inside
