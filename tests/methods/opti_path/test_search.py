"""A step of a path, by each metric, and the weights of each schedule."""

from typing import Any

import numpy as np
import pytest

from sinuous.methods.opti_path import search
from sinuous.methods.opti_path.gradient import Setting
from sinuous.methods.opti_path.options import OptiPath
from tests.methods.opti_path.test_gradient import make_path, wavy


def setting(**changes: Any) -> Setting:
    return Setting(*(float(x) for x in OptiPath(**changes).vector()))


def difference_matrix(n: int) -> np.ndarray:
    return 2.0 * np.eye(n - 1) - np.eye(n - 1, k=1) - np.eye(n - 1, k=-1)


@pytest.mark.parametrize("metric", ["identity", "difference", "acceleration"])
def test_a_step_is_minus_the_inverse_metric_times_the_gradient(metric: str) -> None:
    path = make_path(wavy(0), 0.0)
    before, n = path.points.copy(), len(path.arcs)
    rng = np.random.default_rng(1)
    path.update[:], path.avoid[:] = rng.normal(size=(2, n + 1, 3))
    force = (path.update + path.avoid)[1:-1]
    K = difference_matrix(n)
    A = {"identity": np.eye(n - 1), "difference": K, "acceleration": K.T @ K}[metric]
    wanted = -np.linalg.solve(A, force) / 7.0
    far = search.move(setting(metric=metric, regularisation=7.0, largest_step=0.0), path, 1.0)
    np.testing.assert_allclose((path.points - before)[1:-1], wanted, atol=1e-12)
    np.testing.assert_array_equal(path.points[[0, -1]], before[[0, -1]])
    assert far == pytest.approx(np.linalg.norm(wanted, axis=-1).max())
