"""Samples on a grid: interpolation, its slope, and bounds that hold for whatever has these samples."""

import math

import numpy as np
import pytest

from sinuous.kernels.fields import grids
from sinuous.kernels.fields.grids import SampleGrid
from tests.helpers import Floats, vec

LOW, SPACING, SHAPE = (0.5, -1.0, 2.0), 0.25, (5, 4, 6)
NODES = np.array(LOW) + SPACING * np.argwhere(np.ones(SHAPE))
HIGH = NODES.max(axis=0)


def grid(shape: tuple[int, int, int] = SHAPE) -> SampleGrid:
    return SampleGrid(2, shape, LOW, SPACING)


def store(values: Floats) -> Floats:
    return np.concatenate([[math.nan, math.nan], values.ravel()])


def points(seed: int, count: int = 100) -> Floats:
    return np.asarray(np.random.default_rng(seed).uniform(LOW, HIGH, (count, 3)))


def test_no_place_is_read_beyond_the_samples() -> None:
    numbers = store(np.zeros(SHAPE))
    for p in ((math.nan, 0.0, 0.0), (1e300, -1e300, math.inf), (-math.inf, math.nan, 1e18), HIGH):
        corners, t, _ = grids.look_up(numbers, grid(), vec(p))
        assert corners == (0.0,) * 8
        assert all(0.0 <= x <= 1.0 for x in t)


@pytest.mark.parametrize("seed", range(6))
def test_bounds_hold_for_distances_to_sets(seed: int) -> None:
    """The distance to a few points, some of them within the grid, and less a rounding."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(np.array(LOW) - 0.5, HIGH + 0.5, (1 + seed, 3))
    rounding = rng.uniform(0.0, 0.2)

    def distance(p: Floats) -> Floats:
        return np.asarray(np.linalg.norm(p[:, None] - places, axis=-1).min(axis=1) - rounding)

    numbers = store(distance(NODES))
    asked = points(seed, 400)
    lost = []
    for p, true in zip(asked, distance(asked), strict=True):
        corners, t, _ = grids.look_up(numbers, grid(), vec(p))
        assert grids.at_least(corners, t, SPACING) <= true + 1e-12
        assert grids.at_most(corners, t, SPACING) >= true - 1e-12
        low = grids.set_distance(corners, t, SPACING)
        assert low <= true + 1e-12
        if true > 2.0 * SPACING and len(places) == 1:  # else there are kinks
            lost.append((true - low) * true / SPACING**2)
    assert not lost or max(lost) < 0.6


def test_rounding_adds_nothing_where_the_set_is() -> None:
    """There a bound is the root of a difference that is 0 but for rounding, which the root makes large."""
    rng = np.random.default_rng(8)
    for place in rng.uniform(LOW, HIGH, (200, 3)):
        numbers = store(np.linalg.norm(NODES - place, axis=1))
        for p in (place, place + 1e-9 * rng.normal(size=3)):
            corners, t, _ = grids.look_up(numbers, grid(), vec(p))
            assert grids.set_distance(corners, t, SPACING) <= np.linalg.norm(p - place) + 1e-13


def test_bounds_hold_for_every_distance() -> None:
    """Also for one that is not that of a set, like a smaller one."""
    numbers = store(0.5 * np.abs(np.sin(2.0 * NODES)).min(axis=1))
    for p in points(9, 300):
        corners, t, _ = grids.look_up(numbers, grid(), vec(p))
        true = 0.5 * np.abs(np.sin(2.0 * p)).min()
        assert grids.at_least(corners, t, SPACING) <= true + 1e-12 <= grids.at_most(corners, t, SPACING) + 2e-12
