"""Small worlds: many, quickly, each with a shape that is free by other code, the same for the same number."""

import numpy as np
import pytest

from benchmarks.places import make
from benchmarks.places.place import feasible
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene


def test_worlds_are_of_boxes_and_possible() -> None:
    made = [make("small world", number) for number in range(12)]
    assert all(isinstance(obstacle, Box) for world in made for obstacle in world.scene.obstacles)
    assert {len(world.scene.obstacles) for world in made} != {4}
    for world in made:
        points = world.robot.backbone(world.hidden_q, 40)
        if world.robot.mount == 0.0:
            assert world.scene.distance(points).min() >= min(world.robot.radii)


@pytest.mark.parametrize("number", [0, 5])
def test_a_planted_overlap_is_seen(number: int) -> None:
    world = make("small world", number)
    assert feasible(world)
    middle = world.robot.backbone(world.hidden_q, 10)[-5]
    planted = Scene([*world.scene.obstacles, Sphere(middle, 0.01 * world.robot.mean_length)])
    object.__setattr__(world, "scene", planted)
    assert not feasible(world)


def test_worlds_differ_in_size_and_number_of_segments() -> None:
    made = [make("small world", number) for number in range(30)]
    assert len({len(world.robot) for world in made}) >= 5
    lengths = np.array([world.robot.mean_length for world in made])
    assert lengths.max() > 100.0 * lengths.min()
