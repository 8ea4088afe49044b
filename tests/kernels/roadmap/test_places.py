"""Places beside edges and about the ends."""

import numpy as np
import pytest

from sinuous.kernels.freespace.grid import Grid
from sinuous.kernels.roadmap.places import LEAST, ROOM, SIDES, put_places
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import GOAL, RADIUS, grid
from tests.kernels.workspace import make_clock

NO_EDGES = np.empty((0, 10))
FAR = {"longest": 20.0}


def places(scene: Scene, asked: Grid, edges: Floats = NO_EDGES, most: int = 256, deadline: int = 2**62) -> Floats:
    found = np.full((most, 3), np.nan)
    return found[: put_places(kernel_scene(scene), asked, edges, found, make_clock(deadline))]


def test_a_box_has_places_off_its_edges_with_room_for_a_ball() -> None:
    box = Box((5.0, 0.0, 0.0), (2.0, 1.0, 3.0), (0.9, 0.2, -0.3, 0.1))
    found = places(Scene([box]), grid(**FAR))
    assert np.array_equal(found[:2], [(0.0, 0.0, 0.0), GOAL])
    assert 12 <= len(found) - 2 <= 24
    clear = Scene([box]).distance(found[2:]) / RADIUS
    assert clear.min() >= LEAST
    assert clear.max() <= ROOM + 0.2


def test_in_a_door_a_place_is_in_its_middle() -> None:
    walls = [Box((side * 2.325, 0.0, 3.0), (4.0, 9.0, 0.05)) for side in (-1.0, 1.0)]
    walls += [Box((0.0, side * 2.5, 3.0), (0.65, 4.0, 0.05)) for side in (-1.0, 1.0)]
    found = places(Scene(walls), grid(**FAR))
    through = found[np.abs(found[:, 2] - 3.0) < 1.5 * RADIUS]
    assert (np.abs(through[:, 0]) < 0.2 * RADIUS).any()


def test_about_an_end_with_a_tangent_there_are_places_to_turn_at() -> None:
    found = places(Scene(), grid(axis=(0.0, 0.0, 1.0), turn=0.5, **FAR))
    assert len(found) == 2 + 1 + SIDES
    assert np.allclose(found[2], (0.0, 0.0, 0.5))
    assert np.allclose(found[3:, 2], 0.0)
    assert len(places(Scene(), grid(axis=(0.0, 0.0, 1.0), back=(1.0, 0.0, 0.0), turn=0.5, **FAR))) == 2 + 2 * (
        1 + SIDES
    )


def test_other_edges_count_too_and_what_is_too_narrow_or_too_far_does_not() -> None:
    edge = np.array([[0.5, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5]])
    assert len(places(Scene(), grid(**FAR), edge)) >= 3
    assert len(places(Scene([Sphere((0.8, 0.3, 0.0), 0.3)]), grid(longest=0.9), edge)) == 2


@pytest.mark.parametrize("most", [2, 7])
def test_there_are_no_more_than_there_is_room_for(most: int) -> None:
    assert len(places(Scene([Box((5.0, 0.0, 0.0), (2.0, 1.0, 3.0))]), grid(**FAR), most=most)) == most


def test_a_box_to_stay_within_has_no_places() -> None:
    assert len(places(Scene([Box((0.0, 0.0, 0.0), (4.0, 4.0, 4.0), inside=True)]), grid(**FAR))) == 2
