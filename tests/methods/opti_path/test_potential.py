import math

import numpy as np
import pytest

from sinuous.methods.opti_path import potential
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene, vec

SLOPE, REACH = 1.7, 0.4
SCENE = Scene(
    [Sphere((0.5, 0.1, 0.2), 0.3), Box((-0.6, 0.0, 0.3), size=(0.4, 0.3, 0.5)), Sphere((0.0, -0.9, 0.0), 0.2)]
)


def literal(d: float) -> float:
    """The paper's three lines."""
    if d < 0.0:
        return SLOPE * (-d + 0.5 * REACH)
    return SLOPE / (2.0 * REACH) * (d - REACH) ** 2 if d <= REACH else 0.0


def grid(scene: Scene, spacing: float, radius: float, nodes: int, extent: float = 10.0) -> tuple[Floats, Floats]:
    origin = -0.5 * spacing * (nodes - 1)
    place = np.array([[origin, origin, origin, spacing, radius]])
    sampled = np.concatenate([[nodes] * 3, place[0], np.full(nodes**3, np.nan)])
    potential.sample(scene.group.copy(), sampled, (SLOPE, REACH), np.zeros((1, 3)), extent)
    return sampled[8:].reshape(nodes, nodes, nodes), place


def made(values: Floats, place: Floats, scene: Scene = SCENE) -> potential.Potential:
    """As `read_potential` does it; no kernel can return an array."""
    x, y, z, spacing, radius = place[0].tolist()
    return potential.Potential(kernel_scene(scene), values, (x, y, z), spacing, SLOPE, REACH, radius)


def test_the_exact_potential_is_that_of_the_distance_of_the_surface() -> None:
    rng = np.random.default_rng(0)
    place = np.array([[0.0, 0.0, 0.0, 1.0, 0.05]])
    exact = made(np.empty((0, 0, 0)), place)
    for p in rng.uniform(-1.2, 1.2, (200, 3)):
        value, gradient = potential.exact(exact, vec(p))
        assert value == pytest.approx(literal(float(SCENE.distance(p)) - 0.05), abs=1e-12)
        slope = [
            (literal(float(SCENE.distance(p + s)) - 0.05) - literal(float(SCENE.distance(p - s)) - 0.05)) / 2e-6
            for s in 1e-6 * np.eye(3)
        ]
        if np.abs(np.subtract(gradient, slope)).max() > 1e-4:
            # Only where another obstacle, or another side, is as near.
            near = sorted(float(Scene([o]).distance(p)) for o in SCENE.obstacles)
            assert near[1] - near[0] < 1e-5 or near[0] < 0.0


def test_every_node_of_the_grid_has_the_potential_there() -> None:
    """Blocks that are passed over must be zero."""
    values, place = grid(SCENE, 0.09, 0.05, 37)
    nodes = place[0, 0] + 0.09 * np.arange(37)
    points = np.stack(np.meshgrid(nodes, nodes, nodes, indexing="ij"), axis=-1)
    wanted = np.vectorize(literal)(SCENE.distance(points) - 0.05)
    np.testing.assert_allclose(values, wanted, atol=1e-12)
    assert (values > 0.0).mean() > 0.05


def test_interpolation_is_exact_at_nodes_and_near_between() -> None:
    values, place = grid(SCENE, 0.05, 0.0, 51)
    made_of = made(values, place)
    rng = np.random.default_rng(1)
    for index in rng.integers(0, 50, (50, 3)):
        p = place[0, 0] + 0.05 * index + 1e-12
        assert potential.interpolated(made_of, vec(p))[0] == pytest.approx(values[tuple(index)], abs=1e-9)
    for p in rng.uniform(-1.2, 1.2, (300, 3)):
        value, gradient = potential.interpolated(made_of, vec(p))
        # The potential changes by at most its slope times the distance to the farthest node of the cell.
        assert abs(value - literal(float(SCENE.distance(p)))) <= SLOPE * math.sqrt(3.0) * 0.05
        for i in range(3):
            step = 1e-7 * np.eye(3)[i]
            cells = np.floor((np.stack([p - step, p + step]) - place[0, :3]) / 0.05)
            if (cells[0] == cells[1]).all():
                more, less = (potential.interpolated(made_of, vec(p + s))[0] for s in (step, -step))
                assert gradient[i] == pytest.approx((more - less) / 2e-7, abs=1e-5)
