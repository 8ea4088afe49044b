"""The laws of every distance field: whoever adds one adds it to `FIELDS`, and it goes through all of them.

The truth comes from elsewhere: libigl for triangles, a k-d tree for points, all cubes one by one, a formula.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import igl
import numpy as np
import pytest
from scipy.spatial import cKDTree

import sinuous as sn
from sinuous.kernels.fields import distances, solids
from sinuous.kernels.tables import FIRST_SAMPLE, ORIGIN, SHAPE, SPACING, TREE
from sinuous.measures.obstacles import measure
from sinuous.scene.grids import sample_points
from sinuous.scene.obstacles import Obstacle, Primitive
from sinuous.scene.triangles import Integers
from tests.helpers import Floats, kernel_scene, random_rotation, vec, with_each
from tests.scene import shapes

Oracle = Callable[[Floats], Floats]
RNG = np.random.default_rng(0)
TURN = random_rotation(RNG)
CENTER, HALF = np.array([0.4, -0.3, 0.7]), np.array([1.4, 1.4, 0.7])


@dataclass(frozen=True)
class Case:
    """An obstacle, and the distance to it by other code.

    `spacing` is that of the samples when there is nothing else to know it by; else 0.
    """

    obstacle: Obstacle
    truth: Oracle
    spacing: float = 0.0


def primitive(obstacle: Obstacle) -> Case:
    return Case(obstacle, lambda p: measure(obstacle, p))


def by_triangles(mesh: sn.Mesh) -> Case:
    vertices, faces = np.array(mesh.vertices), np.array(mesh.faces)
    signed, unsigned = igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL, igl.SIGNED_DISTANCE_TYPE_UNSIGNED

    def truth(p: Floats) -> Floats:
        d = np.asarray(igl.signed_distance(p, vertices, faces, sign_type=signed if mesh.watertight else unsigned)[0])
        return (-d if mesh.inside else d) - 0.5 * mesh.thickness

    return Case(mesh, truth)


def by_points(points: Floats, radii: Floats) -> Case:
    def truth(p: Floats) -> Floats:
        each = [cKDTree(points[radii == r]).query(p)[0] - r for r in np.unique(radii)]
        return np.asarray(np.min(each, axis=0))

    return Case(sn.PointCloud(points, radii), truth)


def by_cubes(values: "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]", spacing: float) -> Case:
    origin = CENTER - 0.5 * spacing * np.array(values.shape)
    boxes = [sn.Box(origin + spacing * index, np.full(3, spacing)) for index in np.argwhere(values)]
    return Case(sn.Grid(values, origin, spacing), lambda p: np.min([measure(box, p) for box in boxes], axis=0))


def torus(p: Floats) -> Floats:
    local = p - CENTER
    return np.asarray(np.hypot(np.hypot(local[:, 0], local[:, 1]) - 0.8, local[:, 2]) - 0.3)


def sampled_torus(spacing: float) -> Case:
    low, shape = CENTER - HALF, (round(2.8 / spacing), round(2.8 / spacing), round(1.4 / spacing))
    values = torus(sample_points(low, spacing, shape, 0, math.prod(shape))).reshape(shape)
    return Case(sn.Grid(values, low, spacing), torus, spacing)


def placed(body: shapes.Triangles, size: float = 1.0) -> tuple[Floats, Integers]:
    return size * body[0] @ TURN.T + CENTER, body[1]


def hollow() -> sn.Mesh:
    """A ball with a cube cut out of its middle, and a cube aside."""
    aside = shapes.cube(0.5, (1.5, 0.0, 0.0))
    return sn.Mesh(*placed(shapes.together(shapes.ball(3), shapes.inverted(shapes.cube(0.7)), aside)))


def pocket() -> sn.Mesh:
    """A cube with a dent: edges and corners that point inwards."""
    vertices, faces = shapes.cube()
    vertices = np.concatenate([vertices, [[0.1, 0.05, -0.2]]])
    top = [f for f in faces.tolist() if all(vertices[i][2] > 0 for i in f)]
    rest = [f for f in faces.tolist() if f not in top]
    border = [(f[i], f[(i + 1) % 3]) for f in top for i in range(3)]
    fan = [[a, b, 8] for a, b in border if (b, a) not in border]
    return sn.Mesh(*placed((vertices, np.array(rest + fan))))


SCAN = RNG.normal(size=(500, 3))
SCAN = SCAN / np.linalg.norm(SCAN, axis=1)[:, None] + CENTER

FIELDS: dict[str, Callable[[], Case]] = {
    "sphere": lambda: primitive(sn.Sphere(CENTER, 0.9)),
    "room": lambda: primitive(sn.Sphere(CENTER, 1.5, inside=True)),
    "box": lambda: primitive(sn.Box(CENTER, (1.0, 0.5, 1.5), TURN)),
    "hall": lambda: primitive(sn.Box(CENTER, (3.0, 2.0, 2.5), TURN, inside=True)),
    "capsule": lambda: primitive(sn.Capsule(CENTER, CENTER + TURN[0], 0.4)),
    "capsule of no length": lambda: primitive(sn.Capsule(CENTER, CENTER, 0.4)),
    "cylinder": lambda: primitive(sn.Cylinder(CENTER, CENTER + TURN[0], 0.4)),
    "drum": lambda: primitive(sn.Cylinder(CENTER - TURN[0], CENTER + TURN[0], 1.4, inside=True)),
    "half-space": lambda: primitive(sn.HalfSpace(CENTER, TURN[1])),
    "ball of triangles": lambda: by_triangles(sn.Mesh(*placed(shapes.ball(3)))),
    "cube of triangles": lambda: by_triangles(sn.Mesh(*placed(shapes.cube()))),
    "hollow mesh": lambda: by_triangles(hollow()),
    "mesh with a dent": lambda: by_triangles(pocket()),
    "mesh around": lambda: by_triangles(sn.Mesh(*placed(shapes.ball(2), 1.5), inside=True)),
    "shell": lambda: by_triangles(sn.Mesh(*placed((shapes.ball(3)[0], shapes.ball(3)[1][:300])), thickness=0.1)),
    "surface": lambda: by_triangles(sn.Mesh(*placed((shapes.cube()[0], shapes.cube()[1][:7])))),
    "one triangle": lambda: by_triangles(sn.Mesh(np.eye(3), [[0, 1, 2]])),
    "needles": lambda: by_triangles(sn.Mesh(*placed((shapes.cube()[0] * [1e-4, 1e-2, 1.0], shapes.cube()[1])))),
    "cloud": lambda: by_points(SCAN, np.full(len(SCAN), 0.07)),
    "cloud of all sizes": lambda: by_points(SCAN, RNG.choice([0.0, 0.05, 0.3], len(SCAN))),
    "one point": lambda: by_points(SCAN[:1], np.array([0.5])),
    "cubes": lambda: by_cubes(np.random.default_rng(1).random((6, 5, 4)) < 0.3, 0.25),
    "flat cubes": lambda: by_cubes(np.ones((4, 1, 1), bool), 0.5),
    "sampled distances": lambda: sampled_torus(0.1),
    "function": lambda: Case(sn.Field(torus, CENTER - HALF, CENTER + HALF, 0.1), torus, 0.1),
}
EXACT = [name for name in FIELDS if name not in ("sampled distances", "function")]
SAMPLED = [name for name in FIELDS if name not in EXACT]
AROUND = ("room", "hall", "drum", "mesh around")
CASES: dict[str, Case] = {}


def case(name: str) -> Case:
    """Make an obstacle once; what the kernels read of it is kept with it."""
    if name not in CASES:
        CASES[name] = FIELDS[name]()
    return CASES[name]


def tables(name: str) -> distances.Scene:
    return kernel_scene(sn.Scene([case(name).obstacle]))


def around(seed: int, count: int, far: bool = False) -> Floats:
    """Points in and around the obstacle; also very far when asked."""
    rng = np.random.default_rng(seed)
    spread = rng.choice([0.3, 1.0, 3.0, *([100.0, 1e4] if far else [])], (count, 1))
    return np.asarray(CENTER + rng.normal(size=(count, 3)) * spread)


def close(name: str, seed: int, count: int) -> Floats:
    """Points close to the surface, or as close as one step along the gradient brings them."""
    points = around(seed, count)
    scene = sn.Scene([case(name).obstacle])
    feet = points - scene.distance(points)[:, None] * scene.gradient(points)
    return np.asarray(feet + np.random.default_rng(seed).normal(size=points.shape) * 0.02)


def ask(name: str, points: Floats, how: int, reach: float = math.inf) -> Floats:
    """Lower and upper bound (m, 2) by the kernel."""
    scene = tables(name)
    return np.array([distances.evaluate(scene, 0, vec(p), reach, solids.MODES[how]) for p in points])


@pytest.mark.parametrize("name", FIELDS)
def test_the_scene_says_the_truth(name: str) -> None:
    points = np.concatenate([around(1, 1500), around(2, 300, far=True), close(name, 3, 500)])
    scene = sn.Scene([case(name).obstacle])
    d, true = scene.distance(points), case(name).truth(points)
    assert np.isfinite(d).all()
    if name == "sampled distances":
        assert (d <= true + 1e-12).all()
    else:
        np.testing.assert_allclose(d, true, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(measure(case(name).obstacle, points), true, rtol=1e-9, atol=1e-9)
    assert (d < 0).any() or not case(name).truth(np.concatenate([around(4, 500), points])).min() < 0


@with_each("name", EXACT)
def test_a_distance_changes_by_at_most_the_distance_moved(name: str) -> None:
    scene = sn.Scene([case(name).obstacle])
    rng = np.random.default_rng(5)
    a = np.concatenate([around(6, 1000), close(name, 7, 500)])
    b = a + rng.normal(size=a.shape) * rng.choice([1e-9, 1e-3, 0.1, 1.0], (len(a), 1))
    change = abs(scene.distance(a) - scene.distance(b))
    assert (change <= np.linalg.norm(a - b, axis=1) + 1e-13).all()


@with_each("name", lambda: [name for name in FIELDS if isinstance(case(name).obstacle, Primitive)])
def test_a_tangent_bounds_the_distance_to_a_primitive(name: str) -> None:
    """So proofs of arcs beside it may take the tangent; around the body the distance is below it."""
    scene, rng = sn.Scene([case(name).obstacle]), np.random.default_rng(10)
    a = np.concatenate([around(11, 1000), close(name, 12, 500)])
    b = a + rng.normal(size=a.shape) * rng.choice([1e-2, 0.3, 2.0], (len(a), 1))
    above = scene.distance(b) - scene.distance(a) - (scene.gradient(a) * (b - a)).sum(axis=1)
    rounding = 1e-12 * (1.0 + np.linalg.norm(b - a, axis=1))
    assert ((-above if name in AROUND else above) >= -rounding).all()


@with_each("name", EXACT)
def test_gradients_are_unit_and_the_slope(name: str) -> None:
    points = np.concatenate([around(8, 300), close(name, 9, 200)])
    scene = sn.Scene([case(name).obstacle])
    gradients = scene.gradient(points)
    np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-9)
    h = 1e-6
    slopes, smooth = np.empty_like(points), np.ones(len(points), bool)
    for i, axis in enumerate(np.eye(3)):
        forward, here, back = (scene.distance(points + step * axis) for step in (h, 0.0, -h))
        slopes[:, i] = (forward - back) / (2 * h)
        smooth &= abs(forward - 2 * here + back) < 1e-3 * h  # no kink within the stencil
    assert smooth.mean() > 0.9
    np.testing.assert_allclose(slopes[smooth], gradients[smooth], atol=2e-3)


UPRIGHT = [
    sn.Sphere((0, 0, 0), 1.0),
    sn.Box((0, 0, 0), (2, 2, 2)),
    sn.Capsule((0, 0, -1), (0, 0, 1), 0.5),
    sn.Capsule((0, 0, 0), (0, 0, 0), 0.5),
    sn.Cylinder((0, 0, -1), (0, 0, 1), 1.0),
    sn.HalfSpace((0, 0, 0), (0, 0, 1)),
]


@with_each("obstacle", UPRIGHT)
def test_centers_axes_faces_edges_and_corners_have_unit_gradients_too(obstacle: Obstacle) -> None:
    """Where several answers are right and NaN is none."""
    scene, steps = sn.Scene([obstacle]), (-2.0, -1.0, -0.5, -1e-9, 0.0, 1e-9, 0.5, 1.0, 2.0)
    points = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    values, gradients = scene.distance(points), scene.gradient(points)
    assert np.isfinite(values).all()
    np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-12)
    assert (scene.distance(points + 1e-7 * gradients) <= values + 1e-7 + 1e-15).all()


@pytest.mark.parametrize("name", FIELDS)
def test_bounds_are_bounds(name: str) -> None:
    """Near, far, out of the samples and at them."""
    row, _ = tables(name)
    nodes = around(10, 0)
    if row[0, 0] >= TREE and row[0, FIRST_SAMPLE] >= 0:
        shape = row[0, SHAPE : SHAPE + 3]
        index = np.random.default_rng(11).integers(0, shape, (100, 3))
        nodes = row[0, ORIGIN : ORIGIN + 3] + row[0, SPACING] * index
    points = np.concatenate([around(12, 150), around(13, 60, far=True), close(name, 14, 100), nodes])
    true = case(name).truth(points)
    rounding = 1e-12 * (1.0 + abs(true))
    bounds, above = ask(name, points, 1), ask(name, points, 3)
    assert (bounds[:, 0] <= true + rounding).all()
    assert (above[:, 0] >= true - rounding).all()
    if name in EXACT:
        assert (bounds[:, 1] >= true - rounding).all()


@pytest.mark.parametrize("name", FIELDS)
def test_what_is_within_reach_is_exact_and_the_rest_is_beyond(name: str) -> None:
    points = np.concatenate([around(15, 60), around(16, 15, far=True), close(name, 17, 25)])
    exact = ask(name, points, 2)[:, 0]
    for reach in (-0.1, 0.0, 0.05, 0.5, 2.0):
        low, high = ask(name, points, 2, reach).T
        within = exact < reach
        np.testing.assert_allclose(low[within], exact[within], rtol=1e-12, atol=1e-12)
        assert (low[~within] >= reach).all()
        assert (low <= exact + 1e-9 * (1.0 + abs(exact))).all()
        assert (high >= exact - 1e-9 * (1.0 + abs(exact))).all()


@pytest.mark.parametrize("name", FIELDS)
def test_steps_see_nearly_the_truth_and_its_own_slope(name: str) -> None:
    scene = tables(name)
    table = scene.table
    rich = table[0, 0] >= TREE and table[0, FIRST_SAMPLE] >= 0
    cell = table[0, SPACING] if rich else 0.0
    points = close(name, 18, 150)
    if rich:
        low = table[0, ORIGIN : ORIGIN + 3]
        high = low + cell * (table[0, SHAPE : SHAPE + 3] - 1)
        points = points[((points > low) & (points < high)).all(axis=1)]
    true = case(name).truth(points)
    assert len(points) > 50
    step = 1e-7
    for p, d in zip(points, true, strict=True):
        seen, slope = distances.obstacle(scene, 0, vec(p), math.inf)
        assert abs(seen - d) <= cell + 1e-9
        assert distances.evaluate(scene, 0, vec(p), math.inf, solids.INTERPOLATED)[0] == pytest.approx(seen, abs=1e-14)
        if rich:
            place = (p - low) / cell % 1.0
            if ((place > 1e-5) & (place < 1 - 1e-5)).all():
                ahead = [distances.obstacle(scene, 0, vec(p + step * axis), math.inf)[0] for axis in np.eye(3)]
                np.testing.assert_allclose((np.array(ahead) - seen) / step, slope, atol=1e-4)


@with_each("name", [name for name in FIELDS if isinstance(FIELDS[name]().obstacle, sn.Mesh)])
def test_on_triangles_edges_and_corners_distance_is_nothing(name: str) -> None:
    mesh = case(name).obstacle
    assert isinstance(mesh, sn.Mesh)
    corners = mesh.vertices[mesh.faces[:200]]
    weights = np.array([[1, 0, 0], [0, 1, 0], [0.5, 0.5, 0], [0, 0.3, 0.7], [0.2, 0, 0.8], [0.2, 0.3, 0.5]])
    points = np.einsum("wi,fij->fwj", weights, corners).reshape(-1, 3)
    scene = sn.Scene([mesh])
    np.testing.assert_allclose(scene.distance(points), -0.5 * mesh.thickness, atol=2e-13)
    np.testing.assert_allclose(np.linalg.norm(scene.gradient(points), axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("name", SAMPLED)
def test_samples_alone_prove_less_but_not_much_less(name: str) -> None:
    """Within their box the bound is below the truth by no more than the way to the nearest sample, twice."""
    points = around(20, 2000)
    points = points[(abs(points - CENTER) < [1.2, 1.2, 0.5]).all(axis=1)]
    assert len(points) > 200
    for seen in (ask(name, points, 2)[:, 0], measure(case(name).obstacle, points)):
        lost = case(name).truth(points) - seen
        assert -1e-12 <= lost.min() <= lost.max() <= math.sqrt(3.0) * case(name).spacing
        assert np.median(lost) < 0.6 * case(name).spacing


def test_all_together_are_their_union() -> None:
    cases = [case(name) for name in FIELDS if name not in (*AROUND, "sampled distances")]
    scene = sn.Scene([each.obstacle for each in cases])
    points = np.concatenate([around(21, 300), around(22, 50, far=True)])
    each = np.stack([c.truth(points) for c in cases])
    np.testing.assert_allclose(scene.distance(points), each.min(axis=0), rtol=1e-9, atol=1e-9)
    chosen = np.take_along_axis(each, scene.nearest(points)[None], axis=0)[0]
    np.testing.assert_allclose(chosen, each.min(axis=0), rtol=1e-9, atol=1e-9)
    gradients = np.stack([sn.Scene([each.obstacle]).gradient(points) for each in cases])
    np.testing.assert_array_equal(scene.gradient(points), gradients[scene.nearest(points), np.arange(len(points))])
