import math
from typing import Any

import numpy as np
import pytest

from sinuous.methods.opti_path import path as paths
from tests.helpers import Floats, as_matrix, expm_chain, frames_of, random_pose, random_unit, twist_matrix, vec

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


def test_the_next_tangent_is_a_reflection() -> None:
    for a, b, t, _ in arcs(1, 100):
        e = (b - a) / np.linalg.norm(b - a)
        turned = np.array(paths.end_tangent(make(a, b, t)))
        np.testing.assert_allclose(turned, (2.0 * np.outer(e, e) - np.eye(3)) @ t, atol=1e-12)
        back = paths.end_tangent(make(b, a, -turned))
        np.testing.assert_allclose(back, -t, atol=1e-12)


def test_the_length_is_that_of_the_bezier_curve() -> None:
    for a, b, t, half in arcs(2, 60):
        arc = make(a, b, t)
        if half < 2.6:
            points = np.array([paths.offset(arc, u) for u in np.linspace(0.0, 1.0, 4001)])
            chords = np.linalg.norm(np.diff(points, axis=0), axis=-1).sum()
            assert chords == pytest.approx(arc.length, rel=1e-5)
        curvature = 2.0 * math.sin(arc.x) / arc.chord
        if half > 1e-4:
            assert arc.length == pytest.approx(2.0 * arc.x / curvature, rel=1e-9)


def test_bezier_points_lie_on_the_arc() -> None:
    """Seen from the beginning, a point at the fraction s of the bend has its chord at s x from the tangent."""
    for a, b, t, half in arcs(3, 60):
        arc = make(a, b, t)
        for u in (0.0, 0.13, 0.5, 0.9, 1.0):
            r = np.array(paths.offset(arc, u))
            part = math.atan2(float(np.linalg.norm(np.cross(t, r))), float(t @ r)) if np.any(r) else 0.0
            wanted = arc.chord * (math.sin(part) / math.sin(half) if half > 1e-3 else u)
            assert np.linalg.norm(r) == pytest.approx(wanted, rel=1e-6, abs=1e-9)
            assert part <= half + 1e-9
        np.testing.assert_allclose(paths.offset(arc, 1.0), b - a, atol=1e-9)


def test_the_form_with_a_control_point_is_the_same() -> None:
    """The paper's formula: weight h / sqrt(h^2 + k^2), with the sign of minor (+) and major (-) arcs."""
    for a, b, t, half in arcs(4, 60):
        if abs(half - 0.5 * math.pi) < 1e-3:
            continue  # the control point is at infinity
        arc = make(a, b, t)
        h = 0.5 * float(np.linalg.norm(b - a))
        c = a + h / arc.w * t
        assert np.linalg.norm(c - a) == pytest.approx(float(np.linalg.norm(c - b)), rel=1e-9)
        k = float(np.linalg.norm(c - 0.5 * (a + b)))
        omega, sign = h / math.hypot(h, k), math.copysign(1.0, arc.w)
        assert sign * omega == pytest.approx(arc.w, abs=1e-9)
        for u in (0.2, 0.5, 0.7):
            middle = sign * 2.0 * u * (1.0 - u) * omega
            y = ((1.0 - u) ** 2 * a + middle * c + u**2 * b) / ((1.0 - u) ** 2 + middle + u**2)
            np.testing.assert_allclose(a + paths.offset(arc, u), y, rtol=1e-7, atol=1e-7)


def slope(function: Any, x: Floats, force: Floats) -> Floats:
    """Derivative of `force . function(x)` by central differences."""
    out = np.zeros(3)
    for i in range(3):
        step = np.zeros(3)
        step[i] = 1e-6
        more, less = np.atleast_1d(function(x + step)), np.atleast_1d(function(x - step))
        out[i] = float(np.atleast_1d(force) @ (more - less)) / 2e-6
    return out


def across(t: Floats, gradient: Any) -> Floats:
    """What of a gradient is across the tangent, the only way that it can move."""
    g = np.array(gradient)
    return np.asarray(g - (g @ t) * t)


def test_derivatives_are_those_of_differences() -> None:
    rng = np.random.default_rng(5)
    for a, b, t, half in arcs(6, 80):
        if half > 2.8:
            continue  # the curve changes faster than differences see
        arc, force = make(a, b, t), rng.normal(size=3)

        def turned(x: Floats) -> Floats:
            return np.asarray(x / np.linalg.norm(x))

        cases: list[tuple[Any, Any, Any, Floats]] = [
            (
                lambda d, a=a, t=t: make(a, a + d, t).length,
                lambda s, a=a, b=b: make(a, b, turned(s)).length,
                paths.pull_length(arc, 1.0),
                np.ones(1),
            ),
            (
                lambda d, a=a, t=t: make(a, a + d, t).w,
                lambda s, a=a, b=b: make(a, b, turned(s)).w,
                paths.pull_weight(arc, 1.0),
                np.ones(1),
            ),
            (
                lambda d, a=a, t=t: np.array(paths.end_tangent(make(a, a + d, t))),
                lambda s, a=a, b=b: np.array(paths.end_tangent(make(a, b, turned(s)))),
                paths.pull_tangent(arc, vec(force)),
                force,
            ),
            (
                lambda d, a=a, t=t: np.array(paths.offset(make(a, a + d, t), 0.3)),
                lambda s, a=a, b=b: np.array(paths.offset(make(a, b, turned(s)), 0.3)),
                paths.pull_point(arc, 0.3, paths.offset(arc, 0.3), vec(force)),
                force,
            ),
        ]
        for of_chord, of_tangent, (on_chord, on_tangent), push in cases:
            scale = 1.0 + float(np.abs(on_chord).max() + np.abs(on_tangent).max())
            np.testing.assert_allclose(on_chord, slope(of_chord, b - a, push), atol=2e-6 * scale)
            np.testing.assert_allclose(across(t, on_tangent), slope(of_tangent, t, push), atol=2e-6 * scale)


def test_a_moved_point_turns_all_later_tangents_alternately() -> None:
    """The cause of what the paper calls exploding gradients: reflections, which neither grow nor fade."""
    n, delta = 12, 1e-6
    points = np.stack([np.zeros(n + 1), np.zeros(n + 1), np.arange(n + 1.0)], axis=-1)

    def tangents(moved: float) -> Floats:
        p, t, out = points.copy(), np.array([0.0, 0.0, 1.0]), []
        p[3, 0] += moved
        for k in range(n):
            t = np.array(paths.end_tangent(make(p[k], p[k + 1], t)))
            out.append(t)
        return np.array(out)

    turn = (tangents(delta) - tangents(-delta))[:, 0] / (2.0 * delta)
    np.testing.assert_allclose(turn[:2], 0.0, atol=1e-9)
    np.testing.assert_allclose(turn[2:], [2.0, *([-4.0, 4.0] * n)][: n - 2], atol=1e-6)


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


def test_a_configuration_goes_through_its_points() -> None:
    rng = np.random.default_rng(8)
    for _ in range(100):
        base = random_pose(rng)
        points = np.concatenate([[base[:3, 3]], base[:3, 3] + rng.normal(size=(6, 3))])
        frames, q = np.zeros((7, 12)), np.empty((6, 3))
        frames[0] = [*base[:3, :3].ravel(), *base[:3, 3]]
        paths.configuration_of(points, frames, q)
        poses = expm_chain(q, base)
        np.testing.assert_allclose([pose[:3, 3] for pose in poses], points, atol=1e-7)
        t = base[:3, 2]
        for k in range(6):
            arc = make(points[k], points[k + 1], t)
            assert q[k, 2] == pytest.approx(arc.length, rel=1e-9)
            assert math.hypot(q[k, 0], q[k, 1]) == pytest.approx(2.0 * arc.x, rel=1e-9)
            t = np.array(paths.end_tangent(arc))
            np.testing.assert_allclose(t, poses[k + 1][:3, 2], atol=1e-7)


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


def test_along_arc_is_the_exponential() -> None:
    from scipy.linalg import expm

    for bend in (0.0, 1e-10, 0.4, 3.0, 6.0):
        for s in (0.0, 0.3, 1.0):
            pose = expm(s * twist_matrix(np.array([bend, 0.0, 2.0])))
            p = paths.along_arc((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), bend, 2.0, s)
            np.testing.assert_allclose(as_matrix(np.eye(3), p)[:3, 3], pose[:3, 3], atol=1e-9)
