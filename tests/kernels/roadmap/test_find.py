"""The door of the roadmap: routes through doors, clear all along, or none."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.roadmap.find import find_by_edges, roadmap_size
from sinuous.solver.routing.tubes import walls_of
from tests.helpers import Floats
from tests.kernels.freespace.places import query, room
from tests.scene import shapes

POINTS, RADIUS = 300, 0.1
CORNERS, FACES = shapes.cube()


def wall(height: float, door: tuple[float, float], half: float, thick: float = 0.08) -> list[sn.Box]:
    """A wall across the way with a square door; its four boxes do not overlap."""
    x, y = door
    parts = [((-4.0, -4.0), (x - half, 4.0)), ((x + half, -4.0), (4.0, 4.0))]
    parts += [((x - half, -4.0), (x + half, y - half)), ((x - half, y + half), (x + half, 4.0))]
    boxes = []
    for low, high in parts:
        a, b = np.append(low, height - 0.5 * thick), np.append(high, height + 0.5 * thick)
        boxes.append(sn.Box(0.5 * (a + b), b - a))
    return boxes


def find(scene: sn.Scene, seconds: float = 60.0, **changed: Any) -> Floats:
    route, buffer = np.full((POINTS, 3), np.nan), np.full(roadmap_size(POINTS), np.nan)
    asked = query(**({"longest": 9.0} | changed))
    group = scene.snapshot().group.copy()
    return route[: find_by_edges(group, asked, *walls_of(scene.snapshot()), seconds, buffer, route)]


def check(route: Floats, scene: sn.Scene) -> None:
    """A route runs evenly from the origin to the goal and is clear, also between its points."""
    assert np.allclose(route[[0, -1]], [(0, 0, 0), (0, 0, 2)])
    steps = np.linalg.norm(np.diff(route, axis=0), axis=1)
    assert steps.min() > 0.6 * steps.max()
    dense = np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(route)])
    assert scene.distance(dense).min() > 0.8 * RADIUS


@pytest.mark.parametrize("half", [1.25 * RADIUS, 3.0 * RADIUS])
@pytest.mark.parametrize("door", [(0.0, 0.0), (0.9, -0.4)])
def test_a_route_leads_through_a_door(door: tuple[float, float], half: float) -> None:
    scene = sn.Scene(wall(1.0, door, half))
    route = find(scene)
    check(route, scene)
    through = route[np.abs(route[:, 2] - 1.0).argmin()]
    assert np.abs(through[:2] - door).max() < half


def test_a_route_leads_through_one_door_after_the_other() -> None:
    scene = sn.Scene([*wall(0.7, (0.8, 0.3), 0.15), *wall(1.3, (-0.7, -0.5), 0.15)])
    check(find(scene), scene)


def test_a_wall_of_a_mesh_is_one_of_boxes() -> None:
    boxes = wall(1.0, (0.6, 0.2), 0.2)
    meshes = sn.Scene([sn.Mesh(CORNERS * (box.size - 1e-3) + box.center, FACES) for box in boxes])
    check(find(meshes), meshes)
    assert np.linalg.norm(find(meshes)[::10] - find(sn.Scene(boxes))[::10], axis=1).max() < 0.1


def test_a_closed_room_has_no_route() -> None:
    assert len(find(room(0.02, 0.3, (0.0, 0.0, 2.0)))) == 0


def test_a_route_is_no_longer_than_it_may_be() -> None:
    scene = sn.Scene(wall(1.0, (1.2, 0.0), 0.15))
    assert len(find(scene, longest=2.2)) == 0
    check(find(scene, longest=4.0), scene)
