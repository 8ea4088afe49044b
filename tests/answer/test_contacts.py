"""Contacts: what is touching is found, and the gradient of its clearance is right."""

import numpy as np
import pytest

from sinuous import Box, Problem, Robot, Sphere, Target, pose
from sinuous.answer.worst import contacts_of
from sinuous.measures.body import least_clearance, segment_ends
from tests.cases import with_each
from tests.helpers import Floats

ROBOT = Robot.uniform(4, (0.5, 1.0), 2.5, radius=0.06, base=pose((0.1, 0.2, 0.3), direction=(1, 1, 1)), mount=0.1)


def random_q(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.normal(0.0, 0.9, (4, 2)), rng.uniform(0.5, 1.0, 4)])


def asked(seed: int, q: Floats) -> Problem:
    rng = np.random.default_rng(seed)
    places = ROBOT.backbone(q, 50)[rng.integers(20, 200, 3)]
    balls = [Sphere(place + rng.normal(0.0, 0.08, 3), 0.1, name=f"ball{i}") for i, place in enumerate(places)]
    return Problem(ROBOT, Target((0, 0, 0)), [*balls, Box((9, 9, 9), (1, 1, 1))])


@with_each("seed", range(12))
def test_the_deepest_contact_is_the_least_clearance(seed: int) -> None:
    q = random_q(seed)
    problem = asked(seed, q)
    least = least_clearance(ROBOT, problem.scene, q, segment_ends(ROBOT, q))
    found = contacts_of(problem, q)
    assert (found != []) == (least.distance <= 1e-3 * ROBOT.mean_length)
    if found:
        assert found[0].clearance == pytest.approx(least.distance, abs=2e-3)
        assert found[0].obstacle != "box[3]"


@pytest.mark.parametrize("seed", range(6))
def test_gradients_are_derivatives_of_the_clearance(seed: int) -> None:
    """A contact moves along the body as the shape changes, so places inside a segment need a wide margin of error."""
    q = random_q(seed)
    problem = asked(seed, q)
    for contact in contacts_of(problem, q)[:1]:
        numbers = []
        for step in 1e-5 * np.eye(12).reshape(12, 4, 3):
            more, less = (
                least_clearance(
                    ROBOT, problem.scene.without([]), q + sign * step, segment_ends(ROBOT, q + sign * step)
                ).distance
                for sign in (1.0, -1.0)
            )
            numbers.append((more - less) / 2e-5)
        along = float(np.dot(contact.gradient, numbers)) / float(np.linalg.norm(numbers) ** 2)
        assert along == pytest.approx(1.0, abs=0.25)


def test_far_obstacles_and_empty_scenes_have_none() -> None:
    q = random_q(0)
    assert contacts_of(Problem(ROBOT, Target((0, 0, 0))), q) == []
    assert contacts_of(Problem(ROBOT, Target((0, 0, 0)), [Sphere((50, 0, 0), 1.0)]), q) == []


def test_what_sits_in_the_mount_is_no_contact() -> None:
    base = [Sphere(ROBOT.base[:3, 3], 0.03, name="socket")]
    q = np.array([[0.0, 0.0, 0.8]] * 4)
    assert contacts_of(Problem(ROBOT, Target((0, 0, 0)), base), q) == []
