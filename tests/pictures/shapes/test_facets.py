"""Facets are cut where a box ends, and nothing of them is lost."""

import numpy as np
import pytest

from sinuous.pictures.shapes.facets import cut, lathe, normals, within
from tests.helpers import Floats

BALL = lathe(np.stack([np.sin(a := np.linspace(0.0, np.pi, 30)), -np.cos(a)], axis=-1), 40)


def area(facets: Floats) -> float:
    one = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    other = np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 0])
    return float(0.5 * (np.linalg.norm(one, axis=-1) + np.linalg.norm(other, axis=-1)).sum())


def test_cutting_in_four_keeps_the_area_and_the_side() -> None:
    pieces = cut(BALL, 0.05)
    assert np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=-1).max() <= 0.05
    assert area(pieces) == pytest.approx(area(BALL), rel=1e-3)
    assert (np.einsum("mx,mx->m", pieces.mean(axis=1), normals(pieces)) > -1e-12).all()


@pytest.mark.parametrize("limit", [-0.3, 0.0, 0.123, 0.7])
def test_a_box_cuts_exactly(limit: float) -> None:
    low, far = np.array([-2.0, -2.0, -2.0]), np.array([2.0, 2.0, 2.0])
    left, right = within(BALL, low, np.array([limit, 2.0, 2.0])), within(BALL, np.array([limit, -2.0, -2.0]), far)
    assert left[..., 0].max() - 1e-12 <= limit <= right[..., 0].min() + 1e-12
    assert area(left) + area(right) == pytest.approx(area(BALL))
    broad = left[np.linalg.norm(np.cross(left[:, 2] - left[:, 0], left[:, 3] - left[:, 1]), axis=-1) > 1e-9]
    assert (np.einsum("mx,mx->m", broad.mean(axis=1), normals(broad)) > 0.0).all()


def test_what_is_outside_is_gone_and_what_is_inside_stays() -> None:
    one = np.ones(3)
    assert len(within(BALL, 2.0 * one, 3.0 * one)) == 0
    np.testing.assert_array_equal(within(BALL, -2.0 * one, 2.0 * one), BALL)


def test_a_large_facet_around_a_small_box_keeps_the_box() -> None:
    square = np.array([[[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]]])
    assert area(within(square, -np.ones(3), np.ones(3))) == pytest.approx(4.0)
