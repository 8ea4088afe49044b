"""The update of the points of a path: both gradients are the attenuated sums of the paper's costs of arcs."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

import sinuous as sn
from sinuous.methods.opti_path import gradient as path_gradient
from sinuous.methods.opti_path import path as paths
from sinuous.methods.opti_path.gradient import Setting, Weights
from sinuous.methods.opti_path.options import OptiPath
from sinuous.methods.opti_path.path import Aim, Path, Potential, interpolated, sample
from tests.helpers import Floats, kernel_scene, vec
from tests.kernels.workspace import make_clock

N = 6
ROBOT = sn.Robot.uniform(N, (0.8, 1.2), 2.0)
SCENE = sn.Scene([sn.Sphere((0.9, 0.3, 1.5), 0.4), sn.Sphere((-0.3, 0.2, 3.0), 0.5), sn.Sphere((0.4, -0.5, 4.5), 0.4)])
WEIGHTS = Weights(1.3, 0.7, 0.9, 0.4)
GOAL = np.array([0.6, -0.64, 0.48])
REACH = 0.6


def wavy(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([np.zeros((1, 3)), np.cumsum([0.0, 0.0, 0.9] + 0.35 * rng.normal(size=(N, 3)), axis=0)])


def make_path(points: Floats, band: float) -> Path:
    n = len(points) - 1
    tangents = np.zeros((n + 1, 3))
    tangents[0] = [0.0, 0.0, 1.0]
    path = Path(
        points.copy(),
        points.copy(),
        tangents,
        np.zeros((n, 15)),
        np.zeros((n + 1, 3)),
        np.zeros((n + 1, 3)),
        np.zeros((n, 4)),
    )
    paths.want(ROBOT.limits.copy(), band, 0.0, path)
    paths.trace(path)
    return path


def c_of(p: Floats) -> float:
    d = float(SCENE.distance(p)) - 0.05
    return 1.2 * (0.5 * REACH - d) if d < 0.0 else 0.6 / REACH * (d - REACH) ** 2 if d < REACH else 0.0


def arc_costs(points: Floats, chosen: OptiPath) -> tuple[Floats, Floats]:
    """Costs F_j of all arcs, without and of the obstacles: plain NumPy, the paper's words."""
    t, shapes, bodies = np.array([0.0, 0.0, 1.0]), [], []
    for j in range(N):
        a, b = points[j], points[j + 1]
        chord = float(np.linalg.norm(b - a))
        e = (b - a) / chord
        x = math.acos(float(np.clip(t @ e, -1.0, 1.0)))
        length = chord * x / math.sin(x)
        inset = 0.5 * (1.0 - chosen.dead_band) * 0.4
        miss = max(0.0, length - (1.2 - inset)) + max(0.0, 0.8 + inset - length)
        over = max(0.0, 2.0 * x - 2.0)
        shape = WEIGHTS.length * miss**2 + WEIGHTS.bends * over**2
        body = 0.0
        for s in range(1, chosen.samples + 1):
            u = s / (chosen.samples + 1)
            w, h = t @ e, 0.5 * chord
            top = (1 - u) ** 2 * a + 2 * u * (1 - u) * (w * a + h * t) + u**2 * b
            body += c_of(top / ((1 - u) ** 2 + 2 * u * (1 - u) * w + u**2))
        bodies.append(WEIGHTS.obstacles * chosen.arcs_weight * length * body / chosen.samples)
        t = 2.0 * (t @ e) * e - t
        if j == N - 1:
            far = float(np.linalg.norm(t - GOAL))
            shape += WEIGHTS.orientation * (far if chosen.orientation == "norm" else far**2)
        shapes.append(shape)
    return np.array(shapes), np.array(bodies)


def attenuated_sums(points: Floats, chosen: OptiPath) -> tuple[Floats, Floats]:
    """Sums of `alpha^k dF_j / dp_i` over j >= i, by differences of every F_j."""
    out = np.zeros((2, N - 1, 3))
    for i in range(1, N):
        for c in range(3):
            moved = [points.copy(), points.copy()]
            moved[0][i, c] += 1e-6
            moved[1][i, c] -= 1e-6
            more, less = (arc_costs(p, chosen) for p in moved)
            for j in range(i, N + 1):
                k = j - i if chosen.exponent == "literal" else max(0, j - i - 1)
                for part in range(2):
                    slope = (more[part][j - 1] - less[part][j - 1]) / 2e-6
                    out[part, i - 1, c] += chosen.attenuation**k * slope
    return out[0], out[1]


def point_forces(points: Floats, lengths: Floats) -> Floats:
    """The obstacle functional along the points, with their velocities held fixed."""
    out = np.zeros((N - 1, 3))
    for i in range(1, N):
        speed = 0.5 * (lengths[i - 1] + lengths[i])
        for c in range(3):
            step = 1e-6 * np.eye(3)[c]
            out[i - 1, c] = WEIGHTS.obstacles * speed * (c_of(points[i] + step) - c_of(points[i] - step)) / 2e-6
    return out


CHOICES = [
    OptiPath(attenuation=1.0, dead_band=0.0, bend_weight=0.0),
    OptiPath(attenuation=0.01, exponent="adjacent", dead_band=0.5),
    OptiPath(attenuation=0.3, exponent="literal"),
    OptiPath(attenuation=0.5, orientation="norm", samples=3, arcs_weight=2.0),
    OptiPath(attenuation=0.0, exponent="literal"),
]


@pytest.mark.parametrize("chosen", CHOICES)
def test_both_gradients_are_the_attenuated_sums(chosen: OptiPath) -> None:
    for seed in range(2):
        points = wavy(seed)
        shape, body = attenuated_sums(points, chosen)
        field = Potential(kernel_scene(SCENE), np.empty((0, 0, 0)), (0.0, 0.0, 0.0), 1.0, 1.2, REACH, 0.05)
        setting = Setting(*map(float, dataclasses.replace(chosen, disturbance=1e-6).vector()))
        for compute in (path_gradient.gradient_backwards, path_gradient.gradient_by_differences):
            path = make_path(points, chosen.dead_band)
            compute(field, setting, WEIGHTS, Aim((0.0, 0.0, 0.0), vec(GOAL), True, 1.0), path, True, make_clock())
            update, avoid = path.update[1:-1], path.avoid[1:-1]
            np.testing.assert_allclose(update, shape, atol=1e-4 * (1.0 + np.abs(shape).max()))
            wanted = body + point_forces(points, path.arcs[:, 14])
            np.testing.assert_allclose(avoid, wanted, atol=1e-4 * (1.0 + np.abs(wanted).max()))
        assert np.abs(body).max() > 1e-3


def test_a_grid_is_linear_within_its_cells_and_its_gradient_is_the_slope() -> None:
    rng, nodes = np.random.default_rng(0), 0.5 * np.arange(5)
    values = rng.random((5, 5, 5))
    field = Potential(kernel_scene(SCENE), values, (0.0, 0.0, 0.0), 0.5, 1.2, REACH, 0.05)
    linear = RegularGridInterpolator((nodes, nodes, nodes), values)
    for cell in rng.integers(0, 4, (60, 3)):
        p = 0.5 * (cell + rng.uniform(0.1, 0.9, 3))
        value, gradient = interpolated(field, vec(p))
        slope = [(linear(p + step)[0] - linear(p - step)[0]) / 2e-3 for step in 1e-3 * np.eye(3)]
        assert value == pytest.approx(linear(p)[0])
        np.testing.assert_allclose(gradient, slope, atol=1e-9)


def test_all_nodes_have_the_potential_there() -> None:
    """Blocks of nodes that are passed over must be zero."""
    count, spacing = 37, 0.2
    sampled = np.concatenate([[count] * 3, [-3.6, -3.6, 0.0, spacing, 0.05], np.full(count**3, np.nan)])
    sample(SCENE.group.copy(), sampled, (1.2, REACH), np.zeros((1, 3)), 20.0)
    nodes = np.moveaxis(np.indices((count,) * 3), 0, -1) * spacing + [-3.6, -3.6, 0.0]
    d = SCENE.distance(nodes.reshape(-1, 3)) - 0.05
    wanted = np.where(d < 0.0, 1.2 * (0.5 * REACH - d), 0.6 / REACH * np.minimum(d - REACH, 0.0) ** 2)
    np.testing.assert_allclose(sampled[8:], wanted, atol=1e-12)
    assert np.mean(wanted > 0.0) > 0.01
