"""What a far mesh costs."""

import numpy as np

from benchmarks.clutter.far import ball
from sinuous.scene.meshes.mesh import Mesh


def test_the_ball_is_as_large_as_is_said() -> None:
    mesh = Mesh(*ball(np.array([1.0, 2.0, 3.0]), 2.0))
    assert mesh.watertight
    assert mesh.defects == ()
    assert 99_000 < len(mesh.faces) < 101_000
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - [1, 2, 3], axis=1), 2.0)
