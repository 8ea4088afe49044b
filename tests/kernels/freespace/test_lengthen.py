"""Routes made as long as a body: their length, their distance from the obstacles, and their ends."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.freespace.lengthen import CLEAR, HELD, LEAST, lengthen_route, lengthen_workspace_size
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.kernels.freespace.places import query

POINTS, RADIUS, LENGTH = 160, 0.1, 3.0
STRAIGHT = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), 60)
NARROW = 1.0
SLEEVE = [
    Box(place, size)
    for place, size in (
        ((0.3, 0.0, 0.3), (0.3, 0.9, 1.4)),
        ((-0.3, 0.0, 0.3), (0.3, 0.9, 1.4)),
        ((0.0, 0.3, 0.3), (0.9, 0.3, 1.4)),
        ((0.0, -0.3, 0.3), (0.9, 0.3, 1.4)),
    )
]
"""A square pipe, 0.15 from the axis to the walls, from below the base up to `NARROW`."""


def longer(scene: Scene, angle: float = 0.0, seconds: float = 60.0, route: Floats = STRAIGHT, **asked: Any) -> Any:
    workspace = np.full(lengthen_workspace_size(POINTS), np.nan)  # nothing of what was there before may matter
    rod = np.full((POINTS, 3), np.nan)
    numbers = query(**({"shortest": LENGTH, "radius": RADIUS} | asked))
    group = scene.snapshot().group.copy()
    return rod if lengthen_route(group, numbers, route.copy(), angle, seconds, workspace, rod) else None


def steps(line: Floats) -> Floats:
    lengths: Floats = np.linalg.norm(np.diff(line, axis=0), axis=1)
    return lengths


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5, 4.0])
@pytest.mark.parametrize("ratio", [1.05, 1.3, 1.8])
def test_a_route_out_of_a_pipe_gets_its_length_in_the_open(angle: float, ratio: float) -> None:
    scene = Scene(SLEEVE)
    rod = longer(scene, angle, shortest=2.0 * ratio)
    assert steps(rod).sum() == pytest.approx(2.0 * ratio, rel=0.04)
    assert steps(rod).max() < 1.2 * steps(rod).min()
    assert scene.distance(rod).min() > RADIUS
    inside = rod[:, 2] < NARROW
    # In the pipe nothing is stowed: the line is as long as the pipe there.
    assert steps(rod)[inside[1:]].sum() == pytest.approx(NARROW, rel=0.08)


@pytest.mark.parametrize("seed", range(4))
def test_ends_and_their_tangents_stay(seed: int) -> None:
    rng = np.random.default_rng(seed)
    back = rng.normal(size=3)
    back /= np.linalg.norm(back)
    rod = longer(Scene(), rng.uniform(0.0, 2.0 * math.pi), back=tuple(back))
    first, last = rod[:HELD] - rod[0], rod[-HELD:][::-1] - rod[-1]
    assert np.array_equal(rod[0], STRAIGHT[0])
    assert np.array_equal(rod[-1], STRAIGHT[-1])
    for line, axis in ((first, (0.0, 0.0, 1.0)), (last, back)):
        along = np.linalg.norm(line, axis=1)
        assert (np.diff(along) > 0.0).all()
        assert np.allclose(line, along[:, None] * axis)


def test_a_stage_that_cannot_bend_stays_straight() -> None:
    rod = longer(Scene(), straight_min=0.5)
    low = rod[np.concatenate([[0.0], np.cumsum(steps(rod))]) <= 0.5]
    assert len(low) > 20
    assert np.abs(low[:, :2]).max() == 0.0


@pytest.mark.parametrize("angle", [0.0, 2.0, 4.0])
def test_it_is_bent_to_the_side_that_is_asked_for(angle: float) -> None:
    opposite = longer(Scene(), angle + math.pi)[:, :2].mean(axis=0)
    asked = longer(Scene(), angle)[:, :2].mean(axis=0)
    assert np.linalg.norm(asked) > 2.0 * RADIUS
    assert asked == pytest.approx(-opposite, abs=0.02)


def test_walls_bound_how_far_it_is_bent() -> None:
    walls = Scene([Sphere((0.0, side, 1.0), 0.6) for side in (-1.0, 1.0)])
    for angle in np.linspace(0.0, 2.0 * math.pi, 7):
        rod = longer(walls, float(angle))
        assert rod is None or walls.distance(rod).min() >= LEAST * RADIUS
    assert CLEAR > LEAST


def test_it_turns_no_more_tightly_than_the_body_can() -> None:
    def closest(turn: float) -> float:
        """Least distance of two points that are 0.6 apart along a rod that has to come back to its end."""
        rod = longer(Scene(), shortest=4.0, turn=turn, back=(0.0, 0.0, 1.0))
        apart = round(0.6 / steps(rod).mean())
        return float(np.linalg.norm(rod[apart:] - rod[:-apart], axis=1).min())

    chord = 2.0 * 0.4 * math.sin(0.5 * 0.6 / 0.4)
    assert closest(0.05) < 0.85 * chord
    assert closest(0.4) > 0.93 * chord


def test_a_route_that_is_long_enough_is_left_alone() -> None:
    assert longer(Scene(), shortest=2.0) is None
    assert longer(Scene(), shortest=2.001) is not None


def test_without_room_time_or_a_route_there_is_none() -> None:
    pipe = Scene([Box(box.center, (*box.size[:2], 6.0)) for box in SLEEVE])
    assert longer(pipe) is None
    assert longer(Scene(), seconds=0.0) is None
    assert longer(Scene([Box((0.0, 0.0, 1.0), (1.0, 1.0, 0.1))])) is None


def test_a_tool_is_not_part_of_it() -> None:
    rod = longer(Scene(), goal_radius=0.4)
    assert steps(rod).sum() == pytest.approx(LENGTH, rel=0.04)
    assert np.linalg.norm(rod[-1] - STRAIGHT[-1]) == pytest.approx(0.4, rel=0.1)
