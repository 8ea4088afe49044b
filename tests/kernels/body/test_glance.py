"""A quick look at a segment: no shallower than all its places, and no obstacle that it looked at is missed."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body import glance as places
from sinuous.kernels.problem import Problem
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.cases import with_each
from tests.helpers import expm_chain, frames_of, kernel_scene, mat, vec

ROBOT = Robot.uniform(3, (0.5, 1.5), 2.5, radius=0.05)


def look(scene: Scene, q: Any, k: int, looks: int, mount: float = 0.0) -> tuple[float, int]:
    values = dict.fromkeys(Problem._fields, 0.0)
    problem = Problem(**{**values, "limits": ROBOT.limits, "scene": kernel_scene(scene), "mount": mount})
    frame = frames_of(q)[k]
    least, which, _ = places.deepest(
        problem, mat(frame[:9].reshape(3, 3)), vec(frame[9:]), vec(q[k]), k, float(q[:k, 2].sum()), looks
    )
    return least, which


@with_each("seed", range(15))
def test_the_deepest_place_is_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = Scene(
        [Sphere(rng.normal(size=3), rng.uniform(0.05, 0.3)) for _ in range(8)] + [Box((0, 0, 2), (1, 1, 0.2))]
    )
    q = np.stack([*rng.uniform(-1.5, 1.5, (2, 3)), rng.uniform(0.5, 1.5, 3)], axis=-1)
    for k in range(3):
        fractions = np.arange(1, 9) / 8
        points = []
        for s in fractions:
            part = q[: k + 1].copy()
            part[k] *= s
            points.append(expm_chain(part)[-1][:3, 3])
        expected = scene.distance(np.array(points)).min() - 0.05
        least, which = look(scene, q, k, 8)
        if expected < 0.0:
            assert least == pytest.approx(expected, abs=1e-12)
            assert which >= 0
        else:
            assert least >= expected - 1e-12


def test_what_lies_in_the_mount_is_not_looked_at() -> None:
    scene = Scene([Sphere((0, 0, 0.5), 0.2)])
    q = np.array([[0.0, 0.0, 1.0]] * 3)
    assert look(scene, q, 0, 16)[0] < -0.2
    assert look(scene, q, 0, 16, mount=0.8)[0] > 0.0
    assert look(scene, q, 0, 16, mount=1.5) == (math.inf, -1)
    assert look(scene, q, 1, 16, mount=1.5)[0] > 0.0
