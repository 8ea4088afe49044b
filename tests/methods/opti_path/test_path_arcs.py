import math
from typing import Any

import numpy as np
import pytest

from sinuous.methods.opti_path import path as paths
from tests.helpers import Floats, expm_chain, frames_of, random_pose, random_unit, twist_matrix, vec

HALVES = (0.0, 1e-9, 1e-4, 0.0199, 0.0201, 0.3, 1.2, math.pi / 2 - 1e-9, math.pi / 2, 2.0, 3.0)
"""Half bends: straight, both sides of the end of the series, around a half turn, and major arcs."""


def arcs(seed: int, count: int) -> list[tuple[Floats, Floats, Floats, float]]:
    """Sample arcs: beginning, end, tangent, half bend."""
    rng = np.random.default_rng(seed)
    out = []
    for i in range(count):
        half = HALVES[i % len(HALVES)] if i < 2 * len(HALVES) else rng.uniform(0.0, 3.1)
        t, other = random_unit(rng), random_unit(rng)
        across = np.cross(t, other)
        across /= np.linalg.norm(across)
        a, chord = rng.normal(size=3), rng.uniform(0.2, 3.0)
        out.append((a, a + chord * (math.cos(half) * t + math.sin(half) * across), t, half))
    return out


def make(a: Floats, b: Floats, t: Floats) -> Any:
    return paths.arc_between(vec(a), vec(b), vec(t))


def chain(rng: np.random.Generator, n: int, most: float) -> Floats:
    bends, angles = rng.uniform(0.0, most, n), rng.uniform(-math.pi, math.pi, n)
    return np.stack([bends * np.cos(angles), bends * np.sin(angles), rng.uniform(0.3, 2.0, n)], axis=-1)


def test_an_arc_is_the_exponential_of_its_twist() -> None:
    from scipy.linalg import expm

    for a, b, t, half in arcs(0, 100):
        arc = make(a, b, t)
        assert arc.x == pytest.approx(half, abs=1e-9)
        side = (b - a) - ((b - a) @ t) * t
        norm = np.linalg.norm(side)
        side = side / norm if norm > 1e-12 else np.cross(t, random_unit(np.random.default_rng(1)))
        side /= np.linalg.norm(side)
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = np.stack([side, np.cross(t, side), t], axis=-1), a
        end = frame @ expm(twist_matrix(np.array([2.0 * half, 0.0, arc.length])))
        np.testing.assert_allclose(end[:3, 3], b, atol=1e-8)
        np.testing.assert_allclose(paths.end_tangent(arc), end[:3, 2], atol=1e-8)


def across(t: Floats, gradient: Any) -> Floats:
    """What of a gradient is across the tangent, the only way that it can move."""
    g = np.array(gradient)
    return np.asarray(g - (g @ t) * t)


def test_points_give_the_configuration_that_they_came_from() -> None:
    rng = np.random.default_rng(7)
    for n in (1, 2, 6):
        for _ in range(70):
            base, q = random_pose(rng), chain(rng, n, 1.98 * math.pi)
            frames = frames_of(q, base)
            points, found = np.empty((n + 1, 3)), np.empty((n, 3))
            paths.put_points(frames, points)
            np.testing.assert_allclose(points, [pose[:3, 3] for pose in expm_chain(q, base)], atol=1e-9)
            paths.configuration_of(points, frames.copy(), found)
            np.testing.assert_allclose(found, q, atol=1e-7)


def test_nothing_is_divided_by_zero() -> None:
    z = np.array([0.0, 0.0, 1.0])
    nothing = make(z, z, z)
    assert nothing.length < 1e-20
    closed = make(np.zeros(3), -z, z)
    assert math.isfinite(closed.length)
    assert closed.length > 1e5
    for arc in (nothing, closed):
        pulled = (
            paths.pull_length(arc, 0.0),
            paths.pull_tangent(arc, (0.0, 0.0, 0.0)),
            paths.pull_point(arc, 0.5, paths.offset(arc, 0.5), (0.0, 0.0, 0.0)),
        )
        assert np.isfinite(np.array(pulled)).all()
    frames, q = np.zeros((2, 12)), np.empty((1, 3))
    frames[0] = [*np.eye(3).ravel(), 0.0, 0.0, 0.0]
    paths.configuration_of(np.zeros((2, 3)), frames, q)
    np.testing.assert_array_equal(q, 0.0)
