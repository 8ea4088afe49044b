"""The judge of clearances: a body that is inside is caught, one that is free is not, in every kind of obstacle."""

import math

import igl
import numpy as np
import pytest
import trimesh

import sinuous as sn
from benchmarks.judges import clearances
from benchmarks.judges.clearances import Clearances, distance_of, distances_among, least_clearance, overlaps
from benchmarks.judges.kinematics import body_points
from sinuous.scene.obstacles import Obstacle
from tests.scene.shapes import together

ARM = sn.Robot.uniform(3, 1.0, 2.0, radius=0.1)
STRAIGHT = np.array([[[0.0, 0.0, 1.0]] * 3])


def box_mesh(low: tuple[float, ...], high: tuple[float, ...], inside: bool = False) -> sn.Mesh:
    solid = trimesh.creation.box(bounds=[low, high])
    return sn.Mesh(solid.vertices, solid.faces, inside=inside)


def beside(gap: float) -> list[Obstacle]:
    """Obstacles of all rich kinds, each `gap` away from the body of `ARM` when it is straight."""
    x = 0.1 + gap
    wall = np.array([[x, -1, 0.5], [x, 1, 0.5], [x, 0, 2.5]], float)
    return [
        box_mesh((x, -1, 1), (x + 1, 1, 2)),
        box_mesh((-1, -1, -1), (x, 1, 4), inside=True),
        sn.Mesh(wall + np.array([0.05, 0, 0]), [[0, 1, 2]], thickness=0.1),
        sn.PointCloud([[x + 0.3, 0, 1.5], [5, 5, 5]], 0.3),
        sn.PointCloud([[x + 0.3, 0, 1.5], [x + 0.9, 0, 1.5]], [0.3, 0.5]),
        sn.Field(lambda p: p[:, 0] - x if gap > 1 else x - p[:, 0], (-1, -1, -1), (2, 2, 4), 0.5),
        sn.Sphere((x + 0.5, 0, 1.5), 0.5),
    ]


@pytest.mark.parametrize("which", range(7))
def test_clearances_are_exact_either_side(which: int) -> None:
    for gap in (-0.01, -1e-6, 1e-6, 0.04):
        (least,) = least_clearance(ARM, sn.Scene([beside(gap)[which]]), STRAIGHT)
        assert least == pytest.approx(gap, abs=1e-9)


def test_a_body_inside_a_solid_is_caught_though_it_touches_no_triangle() -> None:
    scene = sn.Scene([box_mesh((-5, -5, -5), (5, 5, 5))])
    (least,) = least_clearance(ARM, scene, STRAIGHT)
    assert least == pytest.approx(-5.1)


@pytest.mark.parametrize("seed", range(5))
def test_skipping_what_cannot_matter_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = np.stack([rng.uniform(-1, 1, (4, 3)), rng.uniform(-1, 1, (4, 3)), np.ones((4, 3))], axis=-1)
    robot = sn.Robot.uniform(3, 1.0, 2.0, radius=0.1, mount=0.4)
    scene = sn.Scene(
        [sn.Box(rng.normal(size=3), (0.3, 0.4, 0.5)), *(sn.Sphere(3 * rng.normal(size=3), 0.3) for _ in range(5))]
    )
    points, along = body_points(robot, q, clearances.FINEST)
    gaps = np.min([own(points.reshape(-1, 3)) for own in distances_among(scene)], axis=0).reshape(along.shape) - 0.1
    dense = np.where(along >= robot.mount, gaps, math.inf).min(axis=(1, 2))
    judged = Clearances(robot, scene)
    np.testing.assert_allclose(judged.least(q), dense, atol=1e-12)
    assert ((judged.least(q, 0.0) < 0.0) == (dense < 0.0)).all()


def test_a_speck_between_coarse_samples_is_seen() -> None:
    thin = sn.Robot.uniform(3, 1.0, 2.0, radius=1e-4)
    speck = sn.Scene([sn.Sphere((1.2e-4, 0, 1.0 + 0.5 / 400), 1e-4)])
    assert overlaps(thin, speck, STRAIGHT).tolist() == [True]


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("spread", [0.01, 0.3, 3.0])
def test_sides_of_a_mesh_are_those_of_every_point_alone(inside: bool, spread: float) -> None:
    """Points that wander through a torus and a box, in small and in large steps; the side by exact solid angles."""
    solids = [trimesh.creation.torus(2.0, 0.7), trimesh.creation.box(bounds=[(-0.5, -0.5, 2), (0.5, 0.5, 3)])]
    mesh = sn.Mesh(*together(*((each.vertices, each.faces) for each in solids)), inside=inside)
    rng = np.random.default_rng(3)
    points = np.array([2.0, 0.0, 0.0]) + spread * rng.normal(size=(3000, 3)).cumsum(axis=0)
    points = np.mod(points + 4.0, 8.0) - 4.0
    numbers = np.asarray(igl.winding_number(np.array(mesh.vertices), np.array(mesh.faces), points)).reshape(-1)
    found = distance_of(mesh)(points)
    assert ((found < 0.0) == ((numbers > 0.5) != inside)).all()
    assert 50 < (found < 0.0).sum() < 2950
