"""The update of the points of a path: both gradients are the attenuated sums of the paper."""

import dataclasses

import numpy as np
import pytest

from sinuous.methods.opti_path import gradient as path_gradient
from sinuous.methods.opti_path.gradient import Setting
from sinuous.methods.opti_path.options import OptiPath
from sinuous.methods.opti_path.path import Path
from tests.helpers import Floats
from tests.kernels.workspace import make_clock
from tests.methods.opti_path.test_gradient_costs import WEIGHTS, aim, arc_costs, c_of, field
from tests.methods.opti_path.test_path import N, make_path, wavy


def gradient(path: Path, chosen: Setting, backwards: bool, obstacles: bool = True) -> tuple[Floats, Floats]:
    compute = path_gradient.gradient_backwards if backwards else path_gradient.gradient_by_differences
    compute(field(), chosen, WEIGHTS, aim(), path, obstacles, make_clock())
    return path.update[1:-1].copy(), path.avoid[1:-1].copy()


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
        for backwards in (True, False):
            small = dataclasses.replace(chosen, disturbance=1e-6)
            path = make_path(points, chosen.dead_band)
            update, avoid = gradient(path, Setting(*map(float, small.vector())), backwards)
            np.testing.assert_allclose(update, shape, atol=1e-4 * (1.0 + np.abs(shape).max()))
            wanted = body + point_forces(points, path.arcs[:, 14])
            np.testing.assert_allclose(avoid, wanted, atol=1e-4 * (1.0 + np.abs(wanted).max()))
        assert np.abs(body).max() > 1e-3
