"""Where points are nearest to obstacles, by the kernels: what the independent measures say."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.worst import compiled_clearance
from sinuous.measures import body
from sinuous.measures.body import BodyPlace, body_places, segment_ends
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.snapshot import room_at
from tests.helpers import Floats, present
from tests.solver.test_live import MADE

SCENES: dict[str, list[Obstacle]] = {
    **{name: [make()] for name, make in MADE.items()},
    "primitives": [
        sn.Sphere((0.4, 0.1, 0.5), 0.2),
        sn.Box((-0.4, 0.2, 0.6), (0.2, 0.3, 0.4)),
        sn.HalfSpace((0, 0, -0.2), (0, 0, 1)),
    ],
    "all": [sn.Cylinder((0.9, -1, 0.4), (0.9, 1, 0.4), 0.3), *(make() for make in MADE.values())],
    "nothing": [],
}
ROBOT = sn.Robot([sn.Segment((0.0, 0.4), 3.0, radius=radius) for radius in (0.02, 0.05, 0.01)], mount=0.15)


def bent(rng: np.random.Generator) -> Floats:
    return np.concatenate([rng.normal(size=(3, 2)), rng.choice([0.0, 0.2, 0.4], (3, 1))], axis=1)


def standing(q: Floats, place: BodyPlace) -> Floats:
    """Where (3,) a place is said to be: at the end of a body that is cut off there."""
    assert place.segment is not None
    part = q.copy()
    part[place.segment - 1] *= present(place.share)
    end: Floats = ROBOT.forward(part)[place.segment - 1, :3, 3]
    return end


@pytest.mark.parametrize("name", SCENES)
def test_the_body_is_as_near_as_other_code_says(name: str) -> None:
    scene = sn.Scene(SCENES[name]).snapshot()
    rng = np.random.default_rng(1)
    for _ in range(4):
        q = bent(rng)
        ends = segment_ends(ROBOT, q)
        expected = body.least_clearance(ROBOT, scene, q, ends)
        distance, segment, obstacle, place = compiled_clearance(ROBOT, scene, q)
        assert distance == pytest.approx(expected.distance, abs=1e-9)
        assert obstacle == expected.obstacle
        if obstacle is not None:
            assert place is not None
            assert place.segment == segment
            assert np.linalg.norm(place.position - standing(q, place)) < 1e-9
            assert expected.place is not None
            assert np.linalg.norm(expected.place.position - standing(q, expected.place)) < 1e-9
        if segment != expected.segment:  # where two meet, either may be named
            places, segments = body_places(ROBOT, q, ends)
            own = places[segments + 1 == segment]
            assert np.linalg.norm(own[:, None] - places[segments + 1 == expected.segment], axis=-1).min() < 1e-9


@pytest.mark.parametrize("name", [name for name in SCENES if name != "nothing"])
def test_a_place_has_as_much_room_as_other_code_says(name: str) -> None:
    scene = sn.Scene(SCENES[name]).snapshot()
    # Out of a grid of distances there are bounds alone, and not the same.
    for place in np.random.default_rng(2).uniform((-0.8, -0.8, -0.3), (0.8, 0.8, 1.3), (12, 3)):
        expected = body.room_at(place, scene)
        found = room_at(place, scene)
        assert found.distance == pytest.approx(expected.distance, abs=1e-9)
        assert found.obstacle == expected.obstacle
