"""Tendons and chambers: linear in the bend, and as long as the curves that they are."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.robot.actuators import Chambers, Lines, Tendons
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from tests.helpers import NOT_NUMBERS, Floats, configurations, expm_chain, refused, refused_each

LINES = (Tendons, Chambers)


def curve_length(q: Floats, angle: float, radius: float, samples: int = 200) -> float:
    """Length of the curve offset from the backbone of segments, from the chords of many small arcs."""
    offset = np.array([radius * math.cos(angle), radius * math.sin(angle), 0.0, 1.0])
    totals = []
    for count in (samples, 2 * samples):
        chords = [np.diff([pose @ offset for pose in expm_powers(row / count, count)], axis=0) for row in q]
        totals.append(float(np.linalg.norm(chords, axis=-1).sum()))
    return totals[1] + (totals[1] - totals[0]) / 3.0  # chords are short by the square of the spacing


def expm_powers(row: Floats, count: int) -> list[Floats]:
    step = expm_chain(row[None])[-1]
    poses = [np.eye(4)]
    for _ in range(count):
        poses.append(poses[-1] @ step)
    return poses


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
def test_lines_are_spread_evenly(count: int) -> None:
    lines = Lines(count, 2.0, 0.3)
    np.testing.assert_allclose(lines.angles, 0.3 + 2 * math.pi * np.arange(count) / count)
    np.testing.assert_allclose(np.linalg.norm(lines.arms, axis=1), 2.0)
    np.testing.assert_allclose(np.arctan2(lines.arms[0, 1], lines.arms[0, 0]), 0.3)
    assert not lines.angles.flags.writeable


def test_angles_one_by_one() -> None:
    lines = Lines(angles=[0.0, 1.0], radius=0.004)
    np.testing.assert_array_equal(lines.angles, [0.0, 1.0])


def test_a_line_on_the_side_bent_to_gets_shorter() -> None:
    robot = Robot([Segment((0.5, 2.0), tendons=Tendons(2, 0.1), chambers=Chambers(2, 0.2))])
    q = [[0.5, 0.0, 1.0]]
    np.testing.assert_allclose(robot.to_actuators(q), [0.05, -0.05, 0.9, 1.1])


@pytest.mark.parametrize("seed", range(3))
def test_lengths_are_those_of_the_curves(seed: int) -> None:
    """Tendons of the last segment run through all; offset curves do not turn back on themselves at this radius."""
    rng = np.random.default_rng(seed)
    angles, radius = rng.uniform(-math.pi, math.pi, 3), 0.05
    robot = Robot([Segment((0.0, 3.0), 7.0, tendons=Tendons(angles=angles + k, radius=radius)) for k in range(3)])
    q = configurations(seed, 3, 1)[0]
    q[:, 2] += 0.5
    pulled = robot.to_actuators(q).reshape(3, 3)
    for k in range(3):
        for j in range(3):
            expected = q[: k + 1, 2].sum() - curve_length(q[: k + 1], angles[j] + k, radius)
            assert pulled[k][j] == pytest.approx(expected, abs=1e-7)
    chambered = Robot([Segment((0.0, 4.0), 7.0, chambers=Chambers(angles=angles, radius=radius))] * 3)
    for k, lengths_k in enumerate(chambered.to_actuators(q).reshape(3, 3)):
        assert lengths_k[1] == pytest.approx(curve_length(q[k : k + 1], angles[1], radius), abs=1e-7)


@pytest.mark.parametrize("kind", LINES)
@pytest.mark.parametrize("value", [*NOT_NUMBERS, 0.0, -1.0])
def test_bad_radii_are_refused(kind: Any, value: Any) -> None:
    refused("radius", lambda: kind(3, value), "greater than 0")


@pytest.mark.parametrize("kind", LINES)
@pytest.mark.parametrize("value", [0, -3, 2.5, True, "3", 65, 10**9])
def test_bad_counts_are_refused(kind: Any, value: Any) -> None:
    refused("count", lambda: kind(value, 1.0), "1 to 64")


@pytest.mark.parametrize("kind", LINES)
def test_places_are_said_one_way(kind: Any) -> None:
    refused("count", lambda: kind(radius=1.0), "angles")
    refused("count", lambda: kind(3, 1.0, angles=[0.0, 1.0]))
    refused("angle", lambda: kind(radius=1.0, angle=0.1, angles=[0.0, 1.0]))
    refused("angle", lambda: kind(3, 1.0, "up"))
    refused_each("angles", ([], [0.0] * 65), lambda angles: kind(radius=1.0, angles=angles), "1 to 64")
    refused_each(
        "angles", ([math.nan], [[0.0]], "east", [True, False], 1.0), lambda angles: kind(radius=1.0, angles=angles)
    )


def test_limits_of_tendons_contain_the_straight_robot() -> None:
    assert Tendons(3, 1.0).displacement == (-math.inf, math.inf)
    assert Tendons(3, 1.0, displacement=(-1, 0)).displacement == (-1.0, 0.0)
    refused_each(
        "displacement",
        ((0.1, 1.0), (-1.0, -0.1), 0.5),
        lambda value: Tendons(3, 1.0, displacement=value),
        "low <= 0 <= high",
    )
    refused_each(
        "displacement", ((1.0, -1.0), (1, 2, 3), "wide", True), lambda value: Tendons(3, 1.0, displacement=value)
    )
    refused("displacement[1]", lambda: Tendons(3, 1.0, displacement=(-1.0, math.inf)))


@pytest.mark.parametrize("kind", LINES)
def test_names_are_one_for_each(kind: Any) -> None:
    assert kind(2, 1.0).names is None
    assert kind(2, 1.0, names=("left", "right")).names == ("left", "right")
    refused_each("names", ("ab", 5, ["left"], ["a", "b", "c"], {"a": 1, "b": 2}), lambda n: kind(2, 1.0, names=n), "2")
    refused_each("names[1]", (["a", ""], ["a", 1], ["a", None]), lambda n: kind(2, 1.0, names=n), "a text")


def test_limits_of_chambers_are_lengths() -> None:
    assert Chambers(3, 1.0).length == (-math.inf, math.inf)
    assert Chambers(3, 1.0, length=(1, 2)).length == (1.0, 2.0)
    refused("length[0]", lambda: Chambers(3, 1.0, length=(-1.0, 1.0)))
    refused("length", lambda: Chambers(3, 1.0, length=(2.0, 1.0)))
