"""Lists of triangles that may be the closest: distances by them are those of the tree, in every cell and out of all."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.fields.distances import bound_patch
from sinuous.kernels.tables import FIRST_CELL, FIRST_SAMPLE
from sinuous.scene import parts
from sinuous.scene.snapshot import Snapshot
from tests.helpers import Floats, kernel_scene, random_pose, random_unit
from tests.kernels.fields.patches import patch_of, points_of
from tests.scene import shapes

RNG = np.random.default_rng(0)


def boxes(count: int, inside: bool = False) -> sn.Mesh:
    """Boxes that nearly touch, in a row that lies oblique to the axes."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    vertices, faces = map(np.array, shapes.cube())
    rows = [vertices * (0.99, 1.5, 0.2) + (float(i), 0.0, 0.0) for i in range(count)]
    turned = np.concatenate(rows) @ (turn * np.linalg.det(turn)).T
    return sn.Mesh(turned, np.concatenate([faces + len(vertices) * i for i in range(count)]), inside=inside)


MESHES = {
    "boxes": boxes(12),
    "around": boxes(1, inside=True),
    "ball": sn.Mesh(*shapes.ball(2)),
    "shell": sn.Mesh(np.array(shapes.ball(2)[0]) * (1.0, 1.0, 0.3), shapes.ball(2)[1][:100], thickness=0.1),
}


def near_and_far(mesh: sn.Mesh) -> Floats:
    """Points on the surface and beside it, all about the mesh, and far away."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    corners = mesh.vertices[mesh.faces[RNG.integers(0, len(mesh.faces), 3000)]]
    on = np.einsum("pi,pij->pj", RNG.dirichlet(np.ones(3), len(corners)), corners)
    beside = on + RNG.normal(size=on.shape) * RNG.choice([0.0, 1e-9, 1e-3, 0.1], (len(on), 1))
    about = low + (high - low) * RNG.uniform(-0.2, 1.2, (3000, 3))
    return np.concatenate([beside, about, RNG.normal(size=(500, 3)) * 20.0])


@pytest.mark.parametrize("name", MESHES)
def test_distances_by_lists_are_those_of_the_tree(name: str) -> None:
    mesh = MESHES[name]
    lists, plain = parts.prepare(mesh, name), parts._of_pieces(parts.triangles(mesh))
    assert lists.row[FIRST_CELL] >= 0.0
    assert lists.row[FIRST_SAMPLE] == plain.row[FIRST_CELL] == -1.0
    points = near_and_far(mesh)
    one, other = Snapshot((mesh,), [lists]), Snapshot((mesh,), [plain])
    np.testing.assert_allclose(one.distance(points), other.distance(points), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("moved", [False, True])
def test_what_is_beside_a_free_patch_is_no_nearer_than_its_bound(name: str, moved: bool) -> None:
    """And across the surface, where a body is proved to be clear, the bound of a short chord is nearly the truth."""
    still = np.zeros(3)
    mesh = MESHES[name]
    pose = random_pose(RNG) if moved else np.eye(4)
    own = sn.Scene([mesh.placed(pose) if moved else mesh])
    scene, snapshot = kernel_scene(own), own.snapshot()
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    centers = (low + (high - low) * RNG.random((500, 3))) @ pose[:3, :3].T + pose[:3, 3]
    away, bounds, short = snapshot.distance(centers), [], []
    for center, d, g in zip(centers, away, snapshot.gradient(centers), strict=True):
        sizes = RNG.choice([0.01, 0.1, 0.5]) * max(d, 0.01) * np.array([[1.0], [1.0], [0.1]])
        chord, onward, twist = RNG.normal(size=(3, 3)) * sizes * RNG.choice([0.0, 1.0], (3, 1), p=[0.2, 0.8])
        aside = RNG.choice([0.0, 0.05]) * abs(d)
        found = bound_patch(scene, 0, patch_of(center, chord, onward, twist), aside, math.inf)[0]
        if d > 0.0 and found > -math.inf:
            swept = points_of(center, chord, onward, twist)
            assert found <= snapshot.distance(swept).min() - aside + 1e-12
            bounds.append(found)
        across = 0.01 * d * np.cross(g, random_unit(RNG))
        low, slope = bound_patch(scene, 0, patch_of(center, across, still, still), 0.0, math.inf)
        short.append(d <= 1e-3 or low > 0.998 * d)
        assert d <= 1e-3 or low == -math.inf or abs(np.linalg.norm(slope) - 1.0) < 1e-9
    assert len(bounds) > 35
    assert np.mean(short) > 0.9  # not where something else is as near, or a list is full
