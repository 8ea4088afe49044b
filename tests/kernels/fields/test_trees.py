"""The closest of many, against looking at all of them."""

import math

import igl
import numpy as np
import pytest

from sinuous.kernels.fields import trees
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.tables import BALLS, CUBES, ITEM_SIZES, LEAF_ITEMS, TRIANGLES
from sinuous.scene.triangles import with_planes
from tests.helpers import Floats, random_unit, vec
from tests.kernels.fields.patches import patch_of, points_of

KINDS = (TRIANGLES, BALLS, CUBES)
HALF = 0.15


def draw(kind: int, count: int, rng: np.random.Generator) -> Floats:
    if kind == TRIANGLES:
        a = rng.normal(size=(count, 1, 3))
        return with_planes(np.concatenate([a, a + 0.3 * rng.normal(size=(count, 2, 3))], axis=1))
    items = rng.normal(size=(count, ITEM_SIZES[kind]))
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


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 2, 4, 5, 37, 200])
def test_the_closest_is_the_closest_of_all(kind: int, count: int) -> None:
    rng = np.random.default_rng(count)
    store, tree, items = planted(kind, draw(kind, count, rng))
    for p in rng.normal(size=(40, 3)) * rng.choice([0.5, 1.0, 10.0], (40, 1)):
        true = each(kind, items, p)
        found, lifted = trees.closest(store, tree, vec(p), math.inf)
        assert trees.unlift(lifted) == pytest.approx(true.min(), abs=1e-12, rel=1e-9)
        assert true[found] == pytest.approx(true.min(), abs=1e-12, rel=1e-9)


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
        low, _ = trees.beside(store, tree, patch_of(center, *own), math.inf)
        swept = points_of(center, *own)
        assert low <= gap(kind, items, swept) + 1e-12
        assert trees.beside(store, tree, patch_of(center, *own), low - 0.1)[0] == low - 0.1
        if d > 0.1:
            still = np.zeros((3, 3))
            low, g = trees.beside(store, tree, patch_of(center, *still), math.inf)
            assert low == pytest.approx(d, abs=1e-12)
            across = 0.3 * d * np.cross(g, random_unit(rng))
            low, _ = trees.beside(store, tree, patch_of(center, across, *still[1:]), math.inf)
            assert low == pytest.approx(d, rel=1e-9) if count == 1 else low > d - np.linalg.norm(across)
