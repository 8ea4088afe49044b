"""Places around a hidden motion: it is clear, what stands around it is near, and plans find a way."""

import numpy as np
import pytest

from benchmarks.judges.clearances import Clearances
from benchmarks.motion.judged import collides, samples
from benchmarks.motion.places.known import FAMILIES, Task, examine, make
from benchmarks.motion.places.motions import THREADING, drawn_back, straight
from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import draw_shape
from sinuous.scene.obstacles import Box


@pytest.mark.parametrize("family", FAMILIES)
def test_the_hidden_motion_is_clear_and_what_stands_around_is_near(family: str) -> None:
    place = make(family, 7)
    assert collides(place.robot, place.scene, place.knots) == ""
    if FAMILIES[family].kind != THREADING:
        np.testing.assert_array_equal(place.knots[0], straight(place.robot))
    radius = max(place.robot.radii)
    way, clearances = samples(place.knots), Clearances(place.robot, place.scene)
    seen = clearances.least(way[::10]).min()
    least = clearances.least(way, seen).min()  # of all; what is more than was seen is an upper bound only
    assert 0.1 * radius < least < 0.5 * radius


def test_a_place_is_made_again() -> None:
    for family in ("40 balls, leading", "door in mesh"):
        one, again = make(family, 7), make(family, 7)
        np.testing.assert_array_equal(one.knots, again.knots)
        np.testing.assert_array_equal(one.scene.group, again.scene.group)


def test_a_threading_body_begins_before_the_wall_and_ends_beyond_it() -> None:
    place = make("two doors", 7)
    boxes = [obstacle for obstacle in place.scene.obstacles if isinstance(obstacle, Box)]
    walls = [box for box in boxes if str(box.name).startswith(("door", "slit"))]
    assert len(walls) == 8
    ends = [place.robot.backbone(q, 40) for q in place.knots[[0, -1]]]
    for wall in walls:
        begin, end = ((line - wall.center) @ wall.rotation[:, 2] for line in ends)
        assert begin.max() <= 0.5 * wall.size[2]
        assert end[-1] > 0.5 * wall.size[2] > end[0]


def test_plans_are_found_and_judged() -> None:
    trial = examine(Task("40 balls, wandering", 0))
    assert trial.begins
    assert trial.status == "solved"
    assert trial.wrong == ""


def test_a_body_is_drawn_back_along_itself() -> None:
    rng = np.random.default_rng(0)
    robot = robot_of(17, rng)
    q = draw_shape(robot, 4.0 * max(robot.radii), rng)
    back = np.stack(drawn_back(robot, q, 0.2))
    np.testing.assert_array_equal(back[0], q)
    assert robot.excess(back[-1]) < 1e-9
    line = robot.backbone(q, 200)
    tips = robot.forward(back)[:, -1, :3, 3]
    off = np.array([np.linalg.norm(line - tip, axis=1).min() for tip in tips])
    assert off.max() < 0.1 * robot.mean_length
    along = np.array([np.linalg.norm(line - tip, axis=1).argmin() for tip in tips])
    assert (np.diff(along) <= 0).all()
    assert 0.15 * len(line) < along[0] - along[-1] < 0.25 * len(line)
