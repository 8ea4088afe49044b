"""Places around a hidden motion: it is clear, what stands around it is near, and plans find a way."""

from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest

from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import within_limits
from benchmarks.motion import judged
from benchmarks.motion.judged import samples
from benchmarks.motion.places import motions
from benchmarks.motion.places.known import FAMILIES, Task, examine, make
from benchmarks.motion.places.motions import THREADING, drawn_back, straight
from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import draw_shape
from sinuous.scene.obstacles import Box

made_once = cache(make)
"""To make a place takes time: tests that only look at it share it."""


@pytest.fixture(scope="module", autouse=True)
def looked_at_coarsely() -> Iterator[None]:
    """A step of a hidden motion is short: places are made as well, and much sooner, with a few looks at each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged, "A_STEP", 10)
        patch.setattr(motions, "FINE", 4)
        yield


@pytest.mark.parametrize("family", FAMILIES)
def test_the_hidden_motion_is_clear_and_what_stands_around_is_near(family: str) -> None:
    place = made_once(family, 7)
    way = samples(place.knots)[::4]  # `make` has looked at all of it
    assert within_limits(place.robot, way).all()
    assert self_collision.look(place.robot, way, 0.0).least.min() >= 0.0
    if FAMILIES[family].kind != THREADING:
        np.testing.assert_array_equal(place.knots[0], straight(place.robot))
    radius = max(place.robot.radii)
    least = Clearances(place.robot, place.scene).least(way, radius).min()
    assert 0.1 * radius < least < 0.5 * radius


def test_a_place_is_made_again() -> None:
    for family in ("40 balls, wandering", "door in mesh"):
        one, again = made_once(family, 7), make(family, 7)
        np.testing.assert_array_equal(one.knots, again.knots)
        np.testing.assert_array_equal(one.scene.group, again.scene.group)


def test_a_threading_body_begins_before_the_wall_and_ends_beyond_it() -> None:
    place = made_once("two doors", 7)
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
