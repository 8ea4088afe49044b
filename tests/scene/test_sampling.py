"""Samples about an obstacle: where, how many, exact, and not computed twice."""

import threading
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.fields import solids
from sinuous.kernels.fields.blocks import EDGE
from sinuous.kernels.tables import FIRST_SAMPLE, ORIGIN, SHAPE, SPACING
from sinuous.scene import parts, sampling
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.snapshot import Snapshot
from tests.scene import shapes


@pytest.mark.parametrize("kind", ["mesh", "cloud", "grid"])
def test_every_point_of_a_grid_has_its_sample(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also at the rim, where blocks of points are not whole; the distances are asked for one by one."""
    monkeypatch.setattr(sampling, "LEAST", 30 * 27 * 25)
    monkeypatch.setattr(sampling, "PER_PIECE", 0)
    rng = np.random.default_rng(2)
    vertices, faces = shapes.ball(3)
    obstacle: Obstacle = {
        "mesh": sn.Mesh(np.array(vertices) * (1.0, 0.8, 0.7), faces),
        "cloud": sn.PointCloud(rng.normal(size=(300, 3)) * (1.0, 0.8, 0.7), rng.choice([0.01, 0.2], 300)),
        "grid": sn.Grid(rng.random((9, 7, 6)) > 0.8, (0.0, 0.0, 0.0), 0.1),
    }[kind]
    part = parts.prepare(obstacle, kind)
    shape = part.row[SHAPE : SHAPE + 3].astype(int)
    values = part.store[int(part.row[FIRST_SAMPLE]) :].reshape(shape)
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    points = part.row[ORIGIN : ORIGIN + 3] + part.row[SPACING] * index
    assert (shape % EDGE != 0).any()
    unsampled = Snapshot((obstacle,), [parts._of_pieces(_pieces(obstacle))])
    np.testing.assert_allclose(values, unsampled.distance(points), atol=1e-12)


def _pieces(obstacle: Obstacle) -> Any:
    """Its tree alone."""
    if isinstance(obstacle, sn.Mesh):
        return parts.triangles(obstacle)
    if isinstance(obstacle, sn.PointCloud):
        return parts.balls(obstacle)
    assert isinstance(obstacle, sn.Grid)
    return parts.cubes(obstacle.origin + obstacle.spacing * np.argwhere(obstacle.values), obstacle.spacing)


def test_progress_goes_from_nothing_to_all() -> None:
    seen: list[tuple[str, float]] = []
    sn.Scene([sn.Mesh(*shapes.cube(), name="housing")]).prepare(lambda name, share: seen.append((name, share)))
    assert {name for name, _ in seen} == {"housing"}
    shares = [share for _, share in seen]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_an_interrupt_does_not_wait_for_all_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    computed: list[int] = []

    def slab(*arguments: Any) -> None:
        computed.append(arguments[-3])
        threading.Event().wait(0.1)

    def interrupted(_name: str, _share: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(solids, "sample", slab)
    with pytest.raises(KeyboardInterrupt):
        sn.Scene([sn.Mesh(*shapes.ball(2))]).prepare(interrupted)
    assert len(computed) < sampling.SLABS // 2
