"""Screens close the passage that a route leads through, and no other one."""

import itertools

import numpy as np
import pytest

from benchmarks.wild import doors
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.solving.classes.curves import Curves
from sinuous.solving.classes.screens import Bounds, Passage, passages, refined, screen
from tests.helpers import Floats
from tests.solving.classes.places import ACROSS, DOORS, ROBOT, bars, wall

ENDS = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 250.0)])
BOUNDS = Bounds(ENDS, 20.0, 300.0, 0.8, 4.0)


def curves(scene: list[Obstacle]) -> Curves:
    return Curves(ROBOT, Scene(scene).snapshot())


def line(*corners: tuple[float, float, float], count: int = 120) -> Floats:
    """Points on a line through corners."""
    parts = [np.linspace(a, b, count, endpoint=False) for a, b in itertools.pairwise(corners)]
    return np.vstack([*parts, corners[-1]])


@pytest.mark.parametrize("tilt", [0.0, 40.0, -40.0])
@pytest.mark.parametrize("door", [0, 1])
def test_a_screen_in_a_door_closes_it_and_leaves_the_other_open(door: int, tilt: float) -> None:
    own, place = curves(wall()), (0.5 * sum(DOORS[door]), 0.0, 150.0)
    route = line((place[0] - tilt, 0.0, 110.0), place, (place[0] + tilt, 0.0, 190.0))
    passage, *_ = passages(route, own.scene.distance(route), BOUNDS)
    closed = own.scene.beside([screen(own, passage, BOUNDS)])
    rng = np.random.default_rng(0)
    through = np.column_stack([rng.uniform(-12.0, 12.0, 500), rng.uniform(-ACROSS, ACROSS, 500)])
    for this, edges in enumerate(DOORS):
        for x, y in through + np.array([0.5 * sum(edges), 0.0]):
            crossing = np.column_stack([np.full(81, x), np.full(81, y), np.linspace(120.0, 180.0, 81)])
            if own.scene.distance(crossing).min() > BOUNDS.keep:
                assert (closed.distance(crossing).min() < 0.5) == (this == door)


def test_passages_are_where_a_route_has_least_room() -> None:
    own = curves([*wall(100.0), *wall(190.0)])
    route = line((-57.0, 0.0, 40.0), (-57.0, 0.0, 145.0), (52.0, 0.0, 145.0), (52.0, 0.0, 230.0))
    distances = own.scene.distance(route)
    found = passages(route, distances, BOUNDS)
    heights = sorted(float(passage.places[:, 2].mean()) for passage in found)
    assert heights[0] == pytest.approx(100.0, abs=5.0)
    assert heights[-1] == pytest.approx(190.0, abs=5.0)
    for passage in found:
        np.testing.assert_allclose(np.linalg.norm(passage.axes, axis=1), 1.0)
        assert np.linalg.norm(passage.places[:, None] - ENDS, axis=-1).min() > 0.5 * BOUNDS.off_ends


def test_near_its_ends_a_route_has_no_passage() -> None:
    own = curves(wall())
    route = line((57.0, 0.0, 140.0), (57.0, 0.0, 160.0))
    near = Bounds(route[[0, -1]], 30.0, 300.0, 0.8, 4.0)
    assert passages(route, own.scene.distance(route), near) == []


def test_a_screen_keeps_off_the_ends() -> None:
    own = curves(bars())
    passage = Passage(np.array([[25.0, 0.0, 140.0]]), np.array([[0.0, 0.0, 1.0]]), 17.0)
    beside = Bounds(np.array([(25.0, 60.0, 140.0), (0.0, 0.0, 250.0)]), 20.0, 300.0, 0.8, 4.0)
    alone = Scene([screen(own, passage, beside)])
    assert (alone.distance(beside.ends) > 16.0).all()
    assert alone.distance((25.0, 30.0, 140.0)) < 0.0


def test_a_refined_route_is_the_same_line_with_points_near_each_other() -> None:
    route = line((0.0, 0.0, 0.0), (0.0, 0.0, 30.0), (40.0, 0.0, 30.0), count=4)
    fine = refined(route, 1.5)
    assert np.linalg.norm(np.diff(fine, axis=0), axis=1).max() <= 1.5 + 1e-9
    on_first, on_second = fine[:, 0] == 0.0, fine[:, 2] == 30.0
    assert (on_first | on_second | (np.linalg.norm(fine - route[4], axis=1) < 1.5)).all()
    np.testing.assert_array_equal(fine[[0, -1]], route[[0, -1]])
    assert len(refined(route, 1e-9)) == 1000
    np.testing.assert_allclose(refined(route, 0.0)[0], route[0])


@pytest.mark.parametrize("number", [28, 30, 56])
def test_a_screen_in_a_thin_wall_leaves_the_other_doors_open(number: int) -> None:
    known = doors.make(0, number)
    own = Curves(doors.ROBOT, known.scene.snapshot())
    bounds = Bounds(np.array([np.zeros(3), known.target.position]), 30.0, 360.0, 0.8, 5.6)
    middles = [(*door.mean(axis=0), known.middle) for door in known.doors]
    for i, middle in enumerate(middles):
        aside = np.array([4.0, -12.0, 20.0])
        route = refined(line(tuple(middle - aside), middle, tuple(middle + aside), count=4), 2.0)
        passage, *_ = passages(route, own.scene.distance(route), bounds)
        closed = own.scene.beside([screen(own, passage, bounds)]).distance(np.array(middles))
        assert closed[i] < 1.0
        assert (np.delete(closed, i) > 3.0).all()
