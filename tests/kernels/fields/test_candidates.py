"""Lists of triangles that may be the closest: distances by them are those of the tree, in every cell and out of all."""

import math

import numpy as np
import pytest

from sinuous.base.checks import Floats
from sinuous.kernels.fields.candidates import LISTED, listed
from sinuous.kernels.fields.candidates import span as span_of
from sinuous.kernels.fields.distances import beside
from sinuous.kernels.fields.grids import grid_of
from sinuous.kernels.tables import FIRST_CELL, FIRST_SAMPLE, ORIGIN, SHAPE, SPACING
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.prepared import parts, sampling, trees
from sinuous.scene.prepared.sampling import CELLS
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from tests.helpers import kernel_scene, random_pose, random_unit
from tests.kernels.fields.patches import patch_of, points_of
from tests.scene import shapes

RNG = np.random.default_rng(0)


def boxes(count: int, inside: bool = False) -> Mesh:
    """Boxes that nearly touch, in a row that lies oblique to the axes."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    vertices, faces = map(np.array, shapes.cube())
    rows = [vertices * (0.99, 1.5, 0.2) + (float(i), 0.0, 0.0) for i in range(count)]
    turned = np.concatenate(rows) @ (turn * np.linalg.det(turn)).T
    return Mesh(turned, np.concatenate([faces + len(vertices) * i for i in range(count)]), inside=inside)


MESHES = {
    "boxes": boxes(12),
    "around": boxes(1, inside=True),
    "ball": Mesh(*shapes.ball(2)),
    "shell": Mesh(np.array(shapes.ball(2)[0]) * (1.0, 1.0, 0.3), shapes.ball(2)[1][:100], thickness=0.1),
}


def near_and_far(mesh: Mesh) -> Floats:
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
    lists, plain = parts.prepare(mesh, name), parts._of_pieces(trees.triangles(mesh))
    assert lists.row[FIRST_CELL] >= 0.0
    assert lists.row[FIRST_SAMPLE] == plain.row[FIRST_CELL] == -1.0
    points = near_and_far(mesh)
    one, other = Snapshot((mesh,), [lists]), Snapshot((mesh,), [plain])
    np.testing.assert_allclose(one.distance(points), other.distance(points), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", MESHES)
def test_a_list_is_in_order_and_begins_with_what_is_closest_to_the_middle(name: str) -> None:
    """The distances of middles are asked of the tree."""
    mesh = MESHES[name]
    row, store = (part := parts.prepare(mesh, name)).row, part.store
    plain = Snapshot((mesh,), [parts._of_pieces(trees.triangles(mesh))])
    first, shape = int(row[FIRST_CELL]), row[SHAPE : SHAPE + 3].astype(int)
    cells = store[first : first + 3 * shape.prod()].reshape(-1, 3)
    span = span_of(grid_of(row[None].copy(), 0, FIRST_CELL))
    for number in RNG.integers(0, len(cells), 200):
        place = row[ORIGIN : ORIGIN + 3] + row[SPACING] * np.array(np.unravel_index(number, shape))
        begin, count, distance = cells[number]
        entries = np.array([listed(entry, span) for entry in store[first + int(begin) :][: abs(int(count))]])
        assert (np.diff(entries[:, 1]) >= -2e-13 * span).all()
        assert len(set(entries[:, 0])) == abs(count) <= LISTED
        assert 0.0 <= abs(distance) - entries[0, 1] <= 3e-13 * span
        sign = -1.0 if mesh.inside else 1.0
        assert sign * (distance - 0.5 * mesh.thickness) == pytest.approx(float(plain.distance(place)), abs=1e-12)


def test_lists_that_have_no_room_leave_it_to_the_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where entries run out, lists end early, then are empty."""
    mesh = boxes(11)
    monkeypatch.setattr(sampling, "ENTRIES", 30_000)
    short, plain = parts.prepare(mesh, "boxes"), parts._of_pieces(trees.triangles(mesh))
    first, shape = int(short.row[FIRST_CELL]), short.row[SHAPE : SHAPE + 3].astype(int)
    counts = short.store[first : first + 3 * shape.prod()].reshape(-1, 3)[:, 1]
    assert (counts > 0.0).any()
    assert (counts < 0.0).any()
    assert (counts == 0.0).any()
    points = near_and_far(mesh)
    one, other = Snapshot((mesh,), [short]), Snapshot((mesh,), [plain])
    np.testing.assert_allclose(one.distance(points), other.distance(points), rtol=1e-13, atol=1e-13)


def test_lists_keep_within_the_memory_that_samples_have() -> None:
    ball = parts.prepare(MESHES["ball"], "ball")
    assert ball.store.nbytes < 16e6
    assert 0.5 * CELLS < ball.row[SHAPE : SHAPE + 3].prod() <= CELLS


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("moved", [False, True])
def test_what_is_beside_a_free_patch_is_no_nearer_than_its_bound(name: str, moved: bool) -> None:
    """And across the surface, where a body is proved to be clear, the bound of a short chord is nearly the truth."""
    still = np.zeros(3)
    mesh = MESHES[name]
    pose = random_pose(RNG) if moved else np.eye(4)
    own = Scene([mesh.placed(pose) if moved else mesh])
    scene, snapshot = kernel_scene(own), own.snapshot()
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    centers = (low + (high - low) * RNG.random((500, 3))) @ pose[:3, :3].T + pose[:3, 3]
    away, bounds, short = snapshot.distance(centers), [], []
    for center, d, g in zip(centers, away, snapshot.gradient(centers), strict=True):
        sizes = RNG.choice([0.01, 0.1, 0.5]) * max(d, 0.01) * np.array([[1.0], [1.0], [0.1]])
        chord, onward, twist = RNG.normal(size=(3, 3)) * sizes * RNG.choice([0.0, 1.0], (3, 1), p=[0.2, 0.8])
        aside = RNG.choice([0.0, 0.05]) * abs(d)
        found = beside(scene, 0, patch_of(center, chord, onward, twist), aside, math.inf)[0]
        if d > 0.0 and found > -math.inf:
            swept = points_of(center, chord, onward, twist)
            assert found <= snapshot.distance(swept).min() - aside + 1e-12
            bounds.append(found)
        across = 0.01 * d * np.cross(g, random_unit(RNG))
        low, slope = beside(scene, 0, patch_of(center, across, still, still), 0.0, math.inf)
        short.append(d <= 1e-3 or low > 0.998 * d)
        assert d <= 1e-3 or low == -math.inf or abs(np.linalg.norm(slope) - 1.0) < 1e-9
    assert len(bounds) > 35
    assert np.mean(short) > 0.9  # not where something else is as near, or a list is full
