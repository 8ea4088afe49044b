"""Facets are small, cut where a box ends, and nothing of them is lost."""

import numpy as np
import pytest

from sinuous.view.display.surfaces import revolve_profile
from sinuous.view.pictures.paint import clip_facets, normals_of, split_facets
from tests.helpers import Floats

BALL = revolve_profile(np.stack([np.sin(a := np.linspace(0.0, np.pi, 30)), -np.cos(a)], axis=-1), 40).facets


def area(facets: Floats) -> float:
    one = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    other = np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 0])
    return float(0.5 * (np.linalg.norm(one, axis=-1) + np.linalg.norm(other, axis=-1)).sum())


def test_cutting_in_four_keeps_the_area_and_the_side() -> None:
    pieces = split_facets(BALL, 0.05)
    assert np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=-1).max() <= 0.05
    assert area(pieces) == pytest.approx(area(BALL), rel=1e-3)
    assert (np.einsum("mx,mx->m", pieces.mean(axis=1), normals_of(pieces)) > -1e-12).all()


def volume(facets: Floats) -> float:
    """By the divergence theorem: of a surface without holes that faces outwards."""
    a, b, c, d = np.moveaxis(facets, 1, 0)
    return float((np.cross(a, b) * c).sum() + (np.cross(a, c) * d).sum()) / 6.0


@pytest.mark.parametrize("limit", [-0.3, 0.0, 0.123, 0.7])
def test_a_solid_that_is_cut_is_closed_again(limit: float) -> None:
    low, far = np.array([-0.8, -2.0, -2.0]), np.array([2.0, 0.5, 2.0])
    whole, (x, y, z) = clip_facets(BALL, low, far, solid=True), far
    left = clip_facets(BALL, low, np.array([limit, y, z]), solid=True)
    right = clip_facets(BALL, np.array([limit, -2.0, -2.0]), np.array([x, y, z]), solid=True)
    assert volume(left) + volume(right) == pytest.approx(volume(whole), rel=1e-9)
    assert 0.0 < volume(whole) < volume(BALL)
    flat = np.abs(left[..., 0] - limit).max(axis=1) < 1e-9
    assert area(left[flat]) == pytest.approx(area(right[np.abs(right[..., 0] - limit).max(axis=1) < 1e-9]))
    across = np.cross(left[flat][:, 2] - left[flat][:, 0], left[flat][:, 3] - left[flat][:, 1])[:, 0]
    assert (across > -1e-12).all()
    edge = 0.2 * np.ones(3)
    assert volume(clip_facets(BALL, -edge, edge, solid=True)) == pytest.approx(0.4**3)
