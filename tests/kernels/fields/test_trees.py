"""The closest of many, against looking at all of them.

Samples on a grid: interpolation, its slope, and bounds that hold for whatever has these samples.
"""

import math

import igl
import numpy as np
import pytest

from sinuous.kernels.fields import grids, trees
from sinuous.kernels.fields.deviation import _largest
from sinuous.kernels.fields.grids import SampleGrid
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.tables import BALL_SIZE, BALLS, CUBE_SIZE, CUBES, LEAF_ITEMS, TRIANGLES
from sinuous.scene.triangles import with_planes
from tests.helpers import Floats, random_unit, vec
from tests.kernels.fields.patches import patch_of, points_of

KINDS = (TRIANGLES, BALLS, CUBES)
HALF = 0.15


def draw(kind: int, count: int, rng: np.random.Generator) -> Floats:
    if kind == TRIANGLES:
        a = rng.normal(size=(count, 1, 3))
        return with_planes(np.concatenate([a, a + 0.3 * rng.normal(size=(count, 2, 3))], axis=1))
    items = rng.normal(size=(count, BALL_SIZE if kind == BALLS else CUBE_SIZE))
    if kind == BALLS:
        items[:, 3] = rng.uniform(0.0, 0.4, count)
    return items


def corners(kind: int, items: Floats) -> tuple[Floats, Floats]:
    if kind == TRIANGLES:
        places = items[:, :9].reshape(-1, 3, 3)
        return places.min(axis=1), places.max(axis=1)
    around = items[:, 3:] if kind == BALLS else np.full((len(items), 1), HALF)
    return items[:, :3] - around, items[:, :3] + around


def planted(kind: int, items: Floats) -> tuple[Floats, Tree, Floats]:
    """Store and tree, and the primitives in its order."""
    count = len(items)
    lows, highs = corners(kind, items)
    levels = max(0, (max(1, -(-count // LEAF_ITEMS)) - 1).bit_length())
    order, nodes = np.arange(count), np.empty((2 << levels, 6))
    trees.arrange(0.5 * (lows + highs), levels, order)
    assert sorted(order) == list(range(count))
    trees.enclose(lows, highs, order, levels, nodes)
    kept = items[order]
    return np.concatenate([nodes.ravel(), kept.ravel()]), Tree(0, levels, nodes.size, count, kind, HALF), kept


def each(kind: int, items: Floats, p: Floats) -> Floats:
    """Signed distance of `p` to every primitive."""
    if kind == TRIANGLES:
        flat = items[:, :9].reshape(-1, 3)
        faces = np.arange(len(flat)).reshape(-1, 3)
        one = [igl.point_mesh_squared_distance(p[None], flat, face[None])[0] for face in faces]
        return np.asarray(np.sqrt(np.ravel(one)))
    if kind == BALLS:
        return np.asarray(np.linalg.norm(items[:, :3] - p, axis=1) - items[:, 3])
    beyond = abs(items - p) - HALF
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.asarray(np.where(outside > 0.0, outside, beyond.max(axis=1)))


def gap(kind: int, items: Floats, points: Floats) -> float:
    """Signed distance of the closest of `points` to the closest primitive."""
    if kind == TRIANGLES:  # all at once: a call for each triangle and point took as long as all other tests of fields
        faces = np.arange(3 * len(items)).reshape(-1, 3)
        squares = igl.point_mesh_squared_distance(points, items[:, :9].reshape(-1, 3), faces)[0]
        return math.sqrt(squares.min())
    return min(float(each(kind, items, p).min()) for p in points)


def test_a_triangle_is_farthest_from_another_one_at_a_corner() -> None:
    rng = np.random.default_rng(0)
    store, tree, items = planted(TRIANGLES, draw(TRIANGLES, 20, rng))
    for i, corners in enumerate(rng.normal(size=(20, 3, 3))):
        most = max(each(TRIANGLES, items[i : i + 1], p)[0] for p in corners)
        assert _largest(store, tree, i, *map(vec, corners)) == pytest.approx(most**2)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 5, 200])
def test_no_point_of_a_patch_is_nearer_than_its_bound(kind: int, count: int) -> None:
    """And a patch across the gradient of one primitive is bounded by what its center says."""
    rng = np.random.default_rng(count)
    store, tree, items = planted(kind, draw(kind, count, rng))
    for _ in range(100):
        center = 1.5 * rng.normal(size=3)
        d = float(each(kind, items, center).min())
        own = rng.normal(size=(3, 3)) * rng.choice([0.0, 0.01, 0.3], (3, 1))
        low, _ = trees.bound_patch(store, tree, patch_of(center, *own), math.inf)
        swept = points_of(center, *own)
        assert low <= gap(kind, items, swept) + 1e-12
        assert trees.bound_patch(store, tree, patch_of(center, *own), low - 0.1)[0] == low - 0.1
        if d > 0.1:
            still = np.zeros((3, 3))
            low, g = trees.bound_patch(store, tree, patch_of(center, *still), math.inf)
            assert low == pytest.approx(d, abs=1e-12)
            across = 0.3 * d * np.cross(g, random_unit(rng))
            low, _ = trees.bound_patch(store, tree, patch_of(center, across, *still[1:]), math.inf)
            assert low == pytest.approx(d, rel=1e-9) if count == 1 else low > d - np.linalg.norm(across)


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
