"""What hides a body: held against the distance of the obstacles along the lines of sight."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.display.sight import hidden, hiding
from sinuous.scene.obstacles import Obstacle

RNG = np.random.default_rng(0)
SOLIDS: list[Obstacle] = [
    sn.Sphere((0.2, 0.1, 0), 0.4),
    sn.Box((0, 0.3, 0.1), (0.5, 0.9, 0.3), rotation=(1, 2, 3, 4)),
    sn.HalfSpace((0, 0, -0.3), (0.3, 0.2, 1)),
]
"""Those that are not looked at by the box around them."""


def meets(obstacle: Obstacle, begin: np.ndarray, end: np.ndarray) -> bool:
    """Whether a line meets an obstacle, by many places on it."""
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    return bool((sn.Scene([obstacle]).distance((1.0 - share) * begin + share * end) < 0.0).any())


@pytest.mark.parametrize("obstacle", SOLIDS, ids=lambda obstacle: obstacle.kind)
def test_lines_of_sight_meet_what_is_on_them(obstacle: Obstacle) -> None:
    points, eyes = RNG.uniform(-1, 1, (12, 3)), RNG.uniform(-2, 2, (6, 3))
    points = points[sn.Scene([obstacle]).distance(points) > 0.0]
    found = hidden([obstacle], points, eyes)[0]
    expected = [[meets(obstacle, point, eye) for point in points] for eye in eyes]
    assert 0 < found.sum() < found.size
    assert (found == expected).mean() > 0.95  # lines that graze an edge


@pytest.mark.parametrize(
    "obstacle",
    [
        sn.Capsule((0, 0, -1), (0.5, 0, 1), 0.2),
        sn.Cylinder((0, 0, -1), (0.5, 0, 1), 0.2),
        sn.PointCloud([[0, 0, 0]], 0.3),
    ],
    ids=lambda obstacle: obstacle.kind,
)
def test_the_box_around_others_hides_no_less(obstacle: Obstacle) -> None:
    points, eyes = RNG.uniform(-1, 1, (12, 3)), RNG.uniform(-2, 2, (6, 3))
    found = hidden([obstacle], points, eyes)[0]
    for e, eye in enumerate(eyes):
        for p, point in enumerate(points):
            assert found[e, p] or not meets(obstacle, point, eye)


def test_rooms_and_small_parts_hide_nothing() -> None:
    body = np.stack([np.zeros(100), np.linspace(-1, 1, 100), np.zeros(100)], axis=-1)
    eye = np.array([[5.0, 0.0, 0.0]])
    scene = [sn.Box((0, 0, 0), (4, 4, 4), inside=True), sn.Sphere((1, 0, 0), 0.01), sn.Sphere((1, 0, 0), 0.2)]
    assert hiding(scene, body, eye) == {2}
    assert hiding(scene, body[:0], eye) == hiding(scene, body, eye[:0]) == frozenset()
