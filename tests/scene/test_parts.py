"""What kernels read of obstacles is prepared once each, and different obstacles do not wait for each other."""

import math
import threading

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.fields import distances
from sinuous.kernels.fields.solids import INTERPOLATED, LOWER_BOUND
from sinuous.kernels.tables import MANY_OBSTACLES
from sinuous.scene import parts
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.parts import Part
from sinuous.scene.sampling import Progress
from tests.helpers import kernel_scene, vec
from tests.scene import shapes


def test_one_obstacle_is_prepared_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def slow(obstacle: Obstacle, name: str, progress: Progress | None, sharing: int) -> Part:
        made.append(name)
        threading.Event().wait(0.05)
        return Part(np.zeros(18), np.zeros(0))

    monkeypatch.setattr(parts, "_prepare", slow)
    mesh = sn.Mesh(*shapes.cube())
    threads = [threading.Thread(target=parts.prepare, args=(mesh, "one")) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made == ["one"]


def test_small_meshes_have_cells_of_their_own_or_few_samples_where_there_are_many() -> None:
    rng = np.random.default_rng(0)
    vertices, faces = shapes.cube(0.6)
    meshes = [sn.Mesh(vertices + 4.0 * rng.random(3), faces) for _ in range(MANY_OBSTACLES)]
    points = 5.0 * rng.random((50, 3)) - 0.5
    scene, few = sn.Scene(meshes), sn.Scene(meshes[:3])
    boxes = sn.Scene([sn.Box(mesh.vertices.mean(axis=0), np.ptp(mesh.vertices, axis=0)) for mesh in meshes])
    exact = boxes.distance(points)
    np.testing.assert_allclose(scene.distance(points), exact, rtol=1e-12, atol=1e-12)
    own = kernel_scene(scene)
    for p, d in zip(points, exact, strict=True):  # also within several that overlap
        low, step = (distances.closest(own, vec(p), math.inf, mode)[0] for mode in (LOWER_BOUND, INTERPOLATED))
        assert low <= d <= distances.search(own, vec(p), math.inf, LOWER_BOUND, 0.0, -1)[1]
        assert abs(d) > 0.2 or abs(step - d) < distances.coarseness(own)
    sizes = [len(own.snapshot()._kernel_group) for own in (scene, few)]
    assert sizes[0] < 5000 * len(scene)
    assert sizes[1] > 50_000 * len(few)
    # What is prepared serves for a scene of one more.
    prepared = scene.snapshot()._prepared()
    again = sn.Scene([*meshes, sn.Sphere((9.0, 0.0, 0.0), 1.0)]).snapshot()._prepared()
    assert all(now is before for now, before in zip(again, prepared, strict=False))
