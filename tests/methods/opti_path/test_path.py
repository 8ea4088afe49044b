"""A path of arcs: what follows from its points, and what every arc wants."""

import numpy as np
import pytest

from sinuous.methods.opti_path import path as paths
from sinuous.methods.opti_path.path import Path
from sinuous.model.robot import Robot
from tests.cases import with_each
from tests.helpers import Floats, expm_chain

N = 6
ROBOT = Robot.uniform(N, (0.8, 1.2), 2.0)


def wavy(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([np.zeros((1, 3)), np.cumsum([0.0, 0.0, 0.9] + 0.35 * rng.normal(size=(N, 3)), axis=0)])


def make_path(points: Floats, band: float = 0.0, robot: Robot = ROBOT, mount: float = 0.0) -> Path:
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
    paths.want(robot.limits.copy(), band, mount, path)
    paths.trace(path)
    return path


@with_each("seed", range(10))
def test_arcs_are_traced_through_the_ends_of_segments(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bend, angle = rng.uniform(0.1, 2.5, N), rng.uniform(-np.pi, np.pi, N)
    q = np.stack([bend * np.cos(angle), bend * np.sin(angle), rng.uniform(0.8, 1.2, N)], axis=-1)
    poses = expm_chain(q)
    path = make_path(np.array([pose[:3, 3] for pose in poses]))
    np.testing.assert_allclose(path.tangents, [pose[:3, 2] for pose in poses], atol=1e-9)
    np.testing.assert_allclose(path.arcs[:, 14], q[:, 2], rtol=1e-9)
    np.testing.assert_allclose(2.0 * path.arcs[:, 11], bend, atol=1e-9)


def test_an_arc_is_read_as_it_was_written() -> None:
    path = make_path(wavy(0))
    for k in range(N):
        row = path.arcs[k].copy()
        paths.put_arc(path.arcs, k, paths.get_arc(path.arcs, k))
        np.testing.assert_array_equal(path.arcs[k], row)


@pytest.mark.parametrize("band", [0.0, 0.4, 1.0])
def test_a_dead_band_is_that_share_of_the_range(band: float) -> None:
    wanted = make_path(wavy(1), band, mount=1.5).wanted
    np.testing.assert_allclose(wanted[:, 0], 1.0 - 0.2 * band)
    np.testing.assert_allclose(wanted[:, 1], 1.0 + 0.2 * band)
    np.testing.assert_allclose(wanted[:, 2], 2.0)
    np.testing.assert_allclose(wanted[:, 3], [1.5, 0.5, 0.0, 0.0, 0.0, 0.0])
