"""Tendons and chambers: lengths of lines from a configuration, and back."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.robot.actuators import Chambers, Tendons
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from tests.helpers import (
    Floats,
    refused,
)


def lines_robot(count: int, stretch: bool, kind: str) -> Robot:
    length = (0.5, 1.5) if stretch else 1.0
    return Robot(
        [
            Segment(
                length,
                tendons=Tendons(count, 0.05, 0.2 * k) if kind == "tendons" else None,
                chambers=Chambers(count, 0.05, 0.2 * k) if kind == "chambers" else None,
            )
            for k in range(4)
        ]
    )


def sample(stretch: bool, *lead: int) -> Floats:
    rng = np.random.default_rng(5)
    q = rng.normal(size=(*lead, 4, 3))
    q[..., 2] = rng.uniform(0.5, 1.5, q.shape[:-1]) if stretch else 1.0
    return q


@pytest.mark.parametrize("count", [3, 4, 7])
@pytest.mark.parametrize("stretch", [False, True])
@pytest.mark.parametrize("lead", [(), (5,), (2, 3)])
def test_there_and_back(count: int, stretch: bool, lead: tuple[int, ...]) -> None:
    q = sample(stretch, *lead)
    robot = lines_robot(count, stretch, "tendons")
    lengths = robot.tendon_lengths(q)
    assert [x.shape for x in lengths] == [(*lead, count)] * 4
    np.testing.assert_allclose(robot.from_tendon_lengths(lengths), q, atol=1e-12)
    pulled = robot.tendon_displacements(q)
    np.testing.assert_allclose(robot.from_tendon_displacements(pulled, q[..., 2]), q, atol=1e-12)
    if not stretch:
        np.testing.assert_allclose(robot.from_tendon_displacements(pulled), q, atol=1e-12)
    blown = lines_robot(count, stretch, "chambers")
    np.testing.assert_allclose(blown.from_chamber_lengths(blown.chamber_lengths(q)), q, atol=1e-12)


def test_one_length_for_a_batch_of_displacements_and_the_other_way() -> None:
    robot = lines_robot(3, True, "tendons")
    q = sample(True, 6)
    q[..., 2] = q[0, :, 2]
    np.testing.assert_allclose(
        robot.from_tendon_displacements(robot.tendon_displacements(q), q[0, :, 2]), q, atol=1e-12
    )
    one = sample(True)
    many = np.tile(one, (5, 1, 1))
    many[..., 2] = sample(True, 5)[..., 2]
    np.testing.assert_allclose(
        robot.from_tendon_displacements(robot.tendon_displacements(one), many[..., 2]), many, atol=1e-12
    )


def test_displacements_are_linear_and_distal_tendons_run_through_proximal_segments() -> None:
    robot = lines_robot(3, True, "tendons")
    a, b = sample(True), sample(True, 2)[1]
    for x, y, z in zip(*(robot.tendon_displacements(q) for q in (a, b, 2.0 * a - b)), strict=True):
        np.testing.assert_allclose(z, 2.0 * x - y, atol=1e-13)
    alone = np.zeros((4, 3))
    alone[1] = [0.3, -0.2, 0.0]
    first, second, third, fourth = robot.tendon_displacements(alone)
    np.testing.assert_array_equal(first, 0.0)
    for k, pulled in ((1, second), (2, third), (3, fourth)):
        angles = 0.2 * k + 2 * math.pi * np.arange(3) / 3
        np.testing.assert_allclose(pulled, 0.05 * (0.3 * np.cos(angles) - 0.2 * np.sin(angles)), atol=1e-15)
    np.testing.assert_allclose(sum(second), 0.0, atol=1e-15)


def test_slack_measurements_give_the_least_squares() -> None:
    robot = lines_robot(5, True, "tendons")
    q = sample(True)
    lengths = robot.tendon_lengths(q)
    arms = robot.segments[0].tendons.arms if robot.segments[0].tendons else np.zeros((0, 2))
    system = np.concatenate([-arms, np.ones((5, 1))], axis=1)
    noise = np.random.default_rng(6).normal(size=5)
    noise -= system @ np.linalg.lstsq(system, noise)[0]  # nothing of it looks like a configuration
    np.testing.assert_allclose(robot.from_tendon_lengths([lengths[0] + noise, *lengths[1:]]), q, atol=1e-12)


def test_segments_without_lines_have_none() -> None:
    robot = Robot([Segment(1.0, tendons=Tendons(3, 0.1)), Segment(1.0)])
    q = np.zeros((7, 2, 3))
    assert [x.shape for x in robot.tendon_displacements(q)] == [(7, 3), (7, 0)]
    assert [x.shape for x in robot.chamber_lengths(q)] == [(7, 0), (7, 0)]
    refused("segments[1].tendons", lambda: robot.from_tendon_lengths([np.ones(3), np.ones(0)]))


def test_lines_that_do_not_determine_the_shape_are_refused() -> None:
    opposite = Robot([Segment(1.0, tendons=Tendons(2, 0.1), chambers=Chambers(1, 0.1))])
    refused("segments[0].tendons", lambda: opposite.from_tendon_lengths([np.ones(2)]), "plane")
    refused("segments[0].chambers", lambda: opposite.from_chamber_lengths([np.ones(1)]))
    crossed = Tendons(angles=[0.0, 1.5], radius=0.1)
    fixed, free = Robot([Segment(1.0, tendons=crossed)]), Robot([Segment((0.5, 1.5), tendons=crossed)])
    q = np.array([[0.3, -0.4, 1.0]])
    np.testing.assert_allclose(fixed.from_tendon_lengths(fixed.tendon_lengths(q)), q, atol=1e-13)
    refused("segments[0].tendons", lambda: free.from_tendon_lengths(free.tendon_lengths(q)), "length")


@pytest.mark.parametrize("value", [None, 5, "abc", [], [[1.0, 1.0, 1.0]] * 3])
def test_lists_of_lines_of_the_wrong_size_are_refused(value: Any) -> None:
    robot = lines_robot(3, False, "tendons")
    refused("lengths", lambda: robot.from_tendon_lengths(value), "4")


@pytest.mark.parametrize(
    "value", [[1.0, 1.0], "abc", None, [1.0, math.nan, 1.0], [True, True, True], [[1.0], [1.0, 2.0]]]
)
def test_lines_of_the_wrong_size_are_refused(value: Any) -> None:
    robot = lines_robot(3, True, "tendons")
    good = [1.0, 1.0, 1.0]
    refused("lengths[2]", lambda: robot.from_tendon_lengths([good, good, value, good]))
    refused("displacements[2]", lambda: robot.from_tendon_displacements([good, good, value, good], [1.0] * 4))


@pytest.mark.parametrize("value", [None, "long", [1.0], [1.0, 1.0, 1.0, math.nan], 1.0])
def test_lengths_of_the_wrong_size_are_refused(value: Any) -> None:
    robot = lines_robot(3, True, "tendons")
    refused("length", lambda: robot.from_tendon_displacements([[0.0] * 3] * 4, value))


def test_batches_that_do_not_fit_each_other_are_refused() -> None:
    robot = lines_robot(3, True, "tendons")
    values = [np.ones((2, 3)), np.ones((2, 3)), np.ones((5, 3)), np.ones((2, 3))]
    refused("lengths", lambda: robot.from_tendon_lengths(values))
    refused("length", lambda: robot.from_tendon_displacements([np.ones((2, 3))] * 4, np.ones((3, 4))))


# Arc parameters
