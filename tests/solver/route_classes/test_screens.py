"""Screens close the passage that a route leads through, and no other one."""

import itertools

import numpy as np
import pytest

from benchmarks.wild import doors
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.solver.route_classes.blocking_surfaces import (
    ABOUT,
    WIDER,
    Passage,
    SurfaceBounds,
    make_blocking_surface,
    passages,
    refined,
)
from sinuous.solver.route_classes.curves import RouteCurves
from tests.cases import with_each
from tests.helpers import Floats
from tests.solver.route_classes.places import ACROSS, DOORS, ROBOT, bars, wall

ENDS = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 250.0)])
BOUNDS = SurfaceBounds(ENDS, 20.0, 300.0, 0.8, 4.0)


def curves(scene: list[Obstacle]) -> RouteCurves:
    return RouteCurves(ROBOT, Scene(scene).snapshot())


def made(own: RouteCurves, passage: Passage, bounds: SurfaceBounds) -> Mesh:
    closing = make_blocking_surface(own, passage, bounds)
    assert closing is not None
    return closing


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
    closed = own.scene.beside([made(own, passage, BOUNDS)])
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
    near = SurfaceBounds(route[[0, -1]], 30.0, 300.0, 0.8, 4.0)
    assert passages(route, own.scene.distance(route), near) == []


def test_a_screen_keeps_off_the_ends() -> None:
    own = curves(bars())
    passage = Passage(np.array([[25.0, 0.0, 140.0]]), np.array([[0.0, 0.0, 1.0]]), 17.0)
    beside = SurfaceBounds(np.array([(25.0, 60.0, 140.0), (0.0, 0.0, 250.0)]), 20.0, 300.0, 0.8, 4.0)
    alone = Scene([made(own, passage, beside)])
    assert (alone.distance(beside.ends) > 16.0).all()
    assert alone.distance((25.0, 30.0, 140.0)) < 0.0


@with_each("looks", [0, 3, 8, 9, 12, 20, 10_000])
def test_a_screen_is_whole_or_none_whenever_the_time_ends(looks: int) -> None:
    """The clock is read before and after each of five looks around, and while corners are left out."""
    passage, left = Passage(np.array([[25.0, 0.0, 140.0]]), np.array([[0.0, 0.0, 1.0]]), 17.0), iter([60.0] * looks)
    whole = make_blocking_surface(curves(bars()), passage, BOUNDS)
    assert whole is not None
    late = make_blocking_surface(RouteCurves(ROBOT, Scene(bars()).snapshot(), lambda: next(left, 0.0)), passage, BOUNDS)
    assert late is None or np.array_equal(late.vertices, whole.vertices)
    assert late is None or looks > 8


def test_passages_are_chosen_as_one_after_the_other_would_be() -> None:
    """The narrowest place first; every other one with more room between it and all before, and some way off."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 300.0), 301)
        distances = 10.0 + np.convolve(rng.uniform(0.0, 20.0, 320), np.ones(20) / 20, "valid")
        bounds = BOUNDS._replace(ends=route[[0, -1]])
        chosen: list[int] = []
        for i in np.argsort(distances, kind="stable").tolist():
            wide = all(distances[min(i, j) : max(i, j) + 1].max() > WIDER * distances[i] for j in chosen)
            far = all(abs(i - j) > 2.0 * ABOUT * distances[i] for j in chosen)
            if wide and far and min(i, 300 - i) > bounds.off_ends:
                chosen.append(i)
        rooms = [passage.room for passage in passages(route, distances, bounds)]
        assert rooms == [float(distances[i]) for i in chosen[:3]]


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
    own = RouteCurves(doors.ROBOT, known.scene.snapshot())
    bounds = SurfaceBounds(np.array([np.zeros(3), known.target.position]), 30.0, 360.0, 0.8, 5.6)
    middles = [(*door.mean(axis=0), known.middle) for door in known.doors]
    for i, middle in enumerate(middles):
        aside = np.array([4.0, -12.0, 20.0])
        route = refined(line(tuple(middle - aside), middle, tuple(middle + aside), count=4), 2.0)
        passage, *_ = passages(route, own.scene.distance(route), bounds)
        closed = own.scene.beside([made(own, passage, bounds)]).distance(np.array(middles))
        assert closed[i] < 1.0
        assert (np.delete(closed, i) > 3.0).all()
