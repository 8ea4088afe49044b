"""Deformations: what is found must keep winding numbers, by other code; what is drawn tight must stay clear."""

import math

import numpy as np

import sinuous as sn
from sinuous.kernels.freespace.homotopy import (
    EASED,
    LEASH_SLACK,
    PASSES,
    deforms,
    draw_tight,
    halfway,
    homotopy_workspace_size,
)
from sinuous.solver.polylines import respaced
from tests.helpers import Floats

POINTS, KEEP = 96, 0.06
START, END = np.array([-2.0, 0.0, 0.0]), np.array([2.0, 0.0, 0.0])
PLACES = np.array([(-0.8, 0.3), (0.1, -0.4), (0.9, 0.2)])
PILLARS = sn.Scene([sn.Cylinder((x, y, -9.0), (x, y, 9.0), 0.1) for x, y in PLACES])
BALL = sn.Scene([sn.Sphere((0.0, 0.0, 0.0), 0.8)])


def workspace() -> Floats:
    return np.full(homotopy_workspace_size(POINTS), np.nan)  # nothing of what was there before may matter


def wild_curve(rng: np.random.Generator) -> Floats:
    """A curve from START to END that keeps twice KEEP from all pillars."""
    while True:
        corners = np.vstack([START, np.sort(rng.uniform(-1.8, 1.8, 6))[:, None] * [1, 0, 0], END])
        corners[1:-1, 1:] = rng.uniform(-1.2, 1.2, (6, 2))
        curve = respaced(corners, POINTS)
        if PILLARS.distance(curve).min() > 2.0 * KEEP:
            return curve


def windings(curve: Floats) -> tuple[float, ...]:
    """Angles that a curve turns about the pillars: equal for curves that deform into each other, and only for those."""
    turned = []
    for place in PLACES:
        off = curve[:, :2] - place
        angles = np.unwrap(np.arctan2(off[:, 1], off[:, 0]))
        turned.append(round(float(angles[-1] - angles[0]), 6))
    return tuple(turned)


def tight(scene: sn.Scene, curve: Floats, seconds: float = 60.0) -> Floats:
    out = curve.copy()
    draw_tight(scene.snapshot().group.copy(), out, KEEP, seconds, workspace())
    return out


def deform(scene: sn.Scene, a: Floats, b: Floats, seconds: float = 60.0) -> bool:
    return deforms(scene.snapshot().group.copy(), a.copy(), b.copy(), 0.5 * KEEP, seconds, workspace())


def length(curve: Floats) -> float:
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())


def test_curves_drawn_tight_keep_ends_distance_and_windings() -> None:
    rng = np.random.default_rng(0)
    for _ in range(40):
        curve = wild_curve(rng)
        drawn = tight(PILLARS, curve)
        np.testing.assert_allclose(drawn[[0, -1]], curve[[0, -1]], atol=1e-12)
        assert length(drawn) <= length(curve) + 1e-9
        assert PILLARS.distance(drawn).min() > 0.9 * LEASH_SLACK * EASED ** (PASSES - 1) * KEEP
        assert windings(drawn) == windings(curve)


def test_a_deformation_is_found_just_where_all_windings_are_the_same() -> None:
    """Beside pillars without end, windings that are equal for curves along x say that they deform into each other."""
    rng = np.random.default_rng(1)
    curves = [wild_curve(rng) for _ in range(24)]
    drawn = [tight(PILLARS, curve) for curve in curves]
    same = different = 0
    for i, a in enumerate(drawn):
        for j, b in enumerate(drawn):
            alike = windings(curves[i]) == windings(curves[j])
            assert deform(PILLARS, a, b) == alike
            same, different = same + alike, different + (not alike)
    assert same > 60
    assert different > 60


def test_curves_that_are_not_drawn_tight_are_never_told_alike_when_they_are_not() -> None:
    rng = np.random.default_rng(2)
    curves = [wild_curve(rng) for _ in range(30)]
    found = [(windings(a), windings(b)) for a in curves for b in curves if a is not b and deform(PILLARS, a, b)]
    assert found
    assert all(one == other for one, other in found)


def test_halfway_is_clear_and_leads_round() -> None:
    angle = 0.9
    up = respaced(np.array([START, (0.0, 0.0, 1.1), END]), POINTS)
    aside = respaced(np.array([START, (0.0, 1.1 * np.sin(angle), 1.1 * np.cos(angle)), END]), POINTS)
    group, middle = BALL.snapshot().group.copy(), np.full_like(up, np.nan)
    assert halfway(group, up, aside, KEEP, math.inf, workspace(), middle)
    assert BALL.distance(middle).min() > LEASH_SLACK * KEEP
    assert deform(BALL, up, middle)
    assert deform(BALL, middle, aside)


def test_without_time_nothing_is_told_alike_nor_drawn_tight() -> None:
    many = sn.Scene([sn.Sphere((x, 9.0, 0.0), 0.1) for x in range(200)])
    curve = respaced(np.array([START, (0.0, 1.0, 0.0), END]), POINTS)
    assert deform(many, curve, curve)
    assert not deform(many, curve, curve, 0.0)
    assert length(tight(many, curve)) < 1.01 * np.linalg.norm(END - START) < length(tight(many, curve, 0.0))
