"""Signed distances: FCL outside, the ball that just fits inside, and the laws of every distance field."""

from collections.abc import Callable
from typing import Any

import fcl
import numpy as np
import pytest

from sinuous.kernels.fields import distances
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Primitive, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene, random_rotation

KINDS = ("sphere", "box", "capsule", "cylinder", "half_space")
Gauge = Callable[[Floats], Floats]


def draw(kind: str, rng: np.random.Generator, inside: bool = False) -> tuple[Primitive, Any, Gauge]:
    """Make an obstacle, the same for FCL, and a gauge of its own: less than 0 inside, 0 on the surface."""
    center, rotation = rng.normal(size=3), random_rotation(rng)
    radius, half = rng.uniform(0.2, 1.0), rng.uniform(0.2, 1.0)
    place = fcl.Transform(rotation, center)
    axis = rotation[:, 2]
    start, end = center - half * axis, center + half * axis

    def along(p: Floats) -> tuple[Floats, Floats]:
        z = (p - center) @ axis
        return z, np.linalg.norm(p - center - z[:, None] * axis, axis=1)

    if kind == "sphere":
        return (
            Sphere(center, radius, inside),
            fcl.CollisionObject(fcl.Sphere(radius), place),
            lambda p: np.linalg.norm(p - center, axis=1) - radius,
        )
    if kind == "box":
        size = rng.uniform(0.3, 2.0, 3)
        return (
            Box(center, size, rotation, inside),
            fcl.CollisionObject(fcl.Box(*size), place),
            lambda p: (np.abs((p - center) @ rotation) - 0.5 * size).max(axis=1),
        )
    if kind == "capsule":

        def from_line(p: Floats) -> Floats:
            z, rho = along(p)
            return np.asarray(np.hypot(rho, np.maximum(np.abs(z) - half, 0.0)) - radius)

        return Capsule(start, end, radius), fcl.CollisionObject(fcl.Capsule(radius, 2 * half), place), from_line
    if kind == "cylinder":

        def from_walls(p: Floats) -> Floats:
            z, rho = along(p)
            return np.maximum(rho - radius, np.abs(z) - half)

        shape = fcl.CollisionObject(fcl.Cylinder(radius, 2 * half), place)
        return Cylinder(start, end, radius, inside), shape, from_walls
    # FCL as it comes to Python cannot ask the distance to a half-space: a large box with one face on the plane instead.
    big = fcl.CollisionObject(fcl.Box(100.0, 100.0, 100.0), fcl.Transform(rotation, center - 50.0 * axis))
    return HalfSpace(center, 3.0 * axis), big, lambda p: (p - center) @ axis


def ask(obstacle: Primitive, points: Floats) -> tuple[Floats, Floats]:
    values, above, gradients = np.empty(len(points)), np.empty(len(points)), np.empty((len(points), 3))
    which = np.empty(len(points), np.int64)
    distances.many(*kernel_scene(Scene([obstacle])), points, values, above, gradients, which)
    assert (which == 0).all()
    np.testing.assert_array_equal(above, values)
    return values, gradients


def around(obstacle: Any, rng: np.random.Generator, count: int) -> Floats:
    """Points in and around an obstacle, near and far."""
    center = obstacle.row[2:5]
    return np.asarray(center + rng.normal(size=(count, 3)) * rng.choice([0.1, 0.5, 1.0, 3.0], (count, 1)))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_outside_it_is_the_distance_of_fcl(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    obstacle, shape, gauge = draw(kind, rng)
    points = around(obstacle, rng, 200)
    points = points[gauge(points) > 1e-2]
    assert len(points) > 20
    ball = 1e-3  # FCL has no points
    for p, d in zip(points, ask(obstacle, points)[0], strict=True):
        other = fcl.CollisionObject(fcl.Sphere(ball), fcl.Transform(p))
        expected = fcl.distance(shape, other, fcl.DistanceRequest(), fcl.DistanceResult()) + ball
        assert d == pytest.approx(expected, abs=2e-5, rel=1e-5)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_one_step_down_the_gradient_is_the_surface_and_no_surface_is_nearer(kind: str, seed: int) -> None:
    """Together these pin the distance down on both sides, exactly."""
    rng = np.random.default_rng(10 + seed)
    obstacle, _, gauge = draw(kind, rng)
    points = around(obstacle, rng, 300)
    values, gradients = ask(obstacle, points)
    assert (values < 0).sum() > 10
    assert (values > 0).sum() > 10
    np.testing.assert_array_equal(values < 0, gauge(points) < 0)
    feet = points - values[:, None] * gradients
    np.testing.assert_allclose(gauge(feet), 0.0, atol=1e-13)
    # Points of the surface, by bisection on rays from a point within.
    center = obstacle.row[2:5] - (1.0 * obstacle.row[[7, 10, 13]] if kind == "half_space" else 0.0)
    rays = rng.normal(size=(3000, 3))
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    low, high = np.zeros(len(rays)), np.full(len(rays), 50.0)
    keep = gauge(center + 50.0 * rays) > 0
    for _ in range(60):
        middle = 0.5 * (low + high)
        out = gauge(center + middle[:, None] * rays) > 0
        low, high = np.where(out, low, middle), np.where(out, middle, high)
    surface = (center + high[:, None] * rays)[keep]
    for p, d in zip(points[::10], values[::10], strict=True):
        assert np.linalg.norm(surface - p, axis=1).min() >= abs(d) - 1e-9


@pytest.mark.parametrize("inside", [False, True])
def test_a_distance_changes_by_at_most_the_distance_moved(inside: bool) -> None:
    """The proof of clearance rests on this, so it holds to rounding, kinks and all."""
    rng = np.random.default_rng(30)
    for kind in KINDS:
        obstacle, _, _ = draw(kind, rng, inside)
        a = around(obstacle, rng, 2000)
        b = a + rng.normal(size=a.shape) * rng.choice([1e-9, 1e-3, 1.0], (len(a), 1))
        change = abs(ask(obstacle, a)[0] - ask(obstacle, b)[0])
        assert (change <= np.linalg.norm(a - b, axis=1) + 1e-14).all()


def test_delicate_places_have_unit_gradients_too() -> None:
    """Centers, axes, faces, edges and corners, where several answers are right and NaN is none."""
    obstacles: list[Primitive] = [
        Sphere((0, 0, 0), 1.0),
        Box((0, 0, 0), (2, 2, 2)),
        Capsule((0, 0, -1), (0, 0, 1), 0.5),
        Capsule((0, 0, 0), (0, 0, 0), 0.5),
        Cylinder((0, 0, -1), (0, 0, 1), 1.0),
        HalfSpace((0, 0, 0), (0, 0, 1)),
    ]
    steps = (-2.0, -1.0, -0.5, -1e-9, 0.0, 1e-9, 0.5, 1.0, 2.0)
    points = np.array([[x, y, z] for x in steps for y in steps for z in steps])
    for obstacle in obstacles:
        values, gradients = ask(obstacle, points)
        assert np.isfinite(values).all()
        np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-12)
        above = ask(obstacle, points + 1e-7 * gradients)[0]
        assert (above <= values + 1e-7 + 1e-15).all()
