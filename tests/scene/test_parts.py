"""What kernels read of obstacles is prepared once each, and different obstacles do not wait for each other."""

import threading

import numpy as np
import pytest

from sinuous.scene import parts
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.parts import Part
from sinuous.scene.sampling import Progress
from tests.scene import shapes


def test_one_obstacle_is_prepared_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def slow(obstacle: Obstacle, name: str, progress: Progress | None) -> Part:
        made.append(name)
        threading.Event().wait(0.05)
        return Part(np.zeros(18), np.zeros(0))

    monkeypatch.setattr(parts, "_prepare", slow)
    mesh = Mesh(*shapes.cube())
    threads = [threading.Thread(target=parts.prepare, args=(mesh, "one")) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made == ["one"]
