"""The closest to each point of a block, against looking at all primitives."""

import numpy as np
import pytest

from sinuous.kernels.fields import blocks, discs
from sinuous.kernels.fields.blocks import FOUND, LANES, WORKSPACE
from sinuous.kernels.fields.discs import DISC_SIZE
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.tables import BALLS, TRIANGLES
from sinuous.measures.obstacles import to_triangles
from sinuous.scene.prepared.trees import with_planes
from tests.helpers import Floats
from tests.kernels.fields.test_discs import MESHES, made
from tests.kernels.fields.test_trees import draw, planted


def found(store: Floats, tree: Tree, own: Floats, seed: int, points: Floats) -> Floats:
    """Numbers of the closest primitives of points (LANES, 3)."""
    work = np.full(WORKSPACE, np.nan)
    work[: 3 * LANES] = points.T.ravel()
    blocks.closest(store, tree, own, seed, work)
    return work[FOUND : FOUND + LANES].astype(int)


def clusters(rng: np.random.Generator) -> list[Floats]:
    """Points (LANES, 3) near to each other, and far from each other."""
    return [rng.normal(size=3) * far + wide * rng.normal(size=(LANES, 3)) for far in (0.3, 3.0) for wide in (0.01, 1.0)]


@pytest.mark.parametrize("count", [1, 2, 5, 37, 200])
def test_the_closest_ball_is_found(count: int) -> None:
    rng = np.random.default_rng(count)
    store, tree, balls = planted(BALLS, draw(BALLS, count, rng))
    for points in clusters(rng):
        true = np.linalg.norm(points[:, None] - balls[:, :3], axis=-1) - balls[:, 3]
        for seed in (0, count - 1):
            item = found(store, tree, np.empty((0, DISC_SIZE)), seed, points)
            np.testing.assert_allclose(true[np.arange(LANES), item], true.min(axis=1), atol=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_the_closest_triangle_is_found(name: str) -> None:
    pieces, store, tree, own = made(name)
    hold(store, tree, own, pieces.items[:, :9].reshape(-1, 3, 3))


@pytest.mark.parametrize("height", [1e-12, 1e-6])
def test_thin_triangles_are_as_far_as_they_are(height: float) -> None:
    rng = np.random.default_rng(5)
    items = draw(TRIANGLES, 40, rng)
    a, b = items[:, :3], items[:, 3:6]
    items[:, 6:9] = a + rng.uniform(0.2, 1.5, (40, 1)) * (b - a) + height * rng.normal(size=(40, 3))
    thin = with_planes(items[:, :9].reshape(-1, 3, 3))
    store, tree, kept = planted(TRIANGLES, thin)
    own = np.full((2 << tree.levels, DISC_SIZE), np.nan)
    discs.enclose(store, tree, own)
    hold(store, tree, own, kept[:, :9].reshape(-1, 3, 3))


def hold(store: Floats, tree: Tree, own: Floats, corners: Floats) -> None:
    """Hold what is found among triangles (count, 3, 3) against the distances to all."""
    for points in clusters(np.random.default_rng(1)):
        each = [to_triangles(corners, np.broadcast_to(p, (len(corners), 3))) for p in points]
        true = np.array(each)
        for seed in (0, len(corners) - 1):
            item = found(store, tree, own, seed, points)
            np.testing.assert_allclose(true[np.arange(LANES), item], true.min(axis=1), atol=1e-9)
