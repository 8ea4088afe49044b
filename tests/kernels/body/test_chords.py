"""Bounds of how near two pieces of a curve are to each other, against brute force."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from sinuous.kernels.body.chords import find_closest, sagitta_bound
from tests.helpers import Floats

ENDS = 4


def lines(rng: np.random.Generator, kind: str) -> Floats:
    """Ends of two straight lines, one of which may be a point, or parallel to the other."""
    ends = rng.normal(size=(ENDS, 3))
    if kind in ("first a point", "both points"):
        ends[1] = ends[0]
    if kind in ("second a point", "both points"):
        ends[3] = ends[2]
    if kind == "parallel":
        ends[3] = ends[2] + rng.uniform(-2.0, 2.0) * (ends[1] - ends[0])
    scaled: Floats = ends * 10.0 ** rng.uniform(-6.0, 3.0)
    return scaled


def least_distance(ends: Floats) -> float:
    """Distance of two straight lines: a convex function of two fractions, minimised by code that knows nothing else."""
    a, b, c, d = ends / np.abs(ends).max()

    def squared(fractions: Floats) -> float:
        s, t = fractions
        apart = a + s * (b - a) - c - t * (d - c)
        return float(apart @ apart)

    starts = ([0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0])
    found = min(
        minimize(squared, start, bounds=[(0.0, 1.0)] * 2, method="L-BFGS-B", options={"ftol": 1e-15}).fun
        for start in starts
    )
    return math.sqrt(found) * float(np.abs(ends).max())


@pytest.mark.parametrize("kind", ["any", "first a point", "second a point", "both points", "parallel"])
def test_two_chords_are_closest_where_it_is_said(kind: str) -> None:
    rng = np.random.default_rng(11)
    for _ in range(40):
        ends = lines(rng, kind)
        scale = float(np.abs(ends).max())
        s, t = find_closest(*(tuple(end) for end in ends))
        truth = least_distance(ends)
        seen = np.linalg.norm(ends[0] + s * (ends[1] - ends[0]) - ends[2] - t * (ends[3] - ends[2]))
        assert seen == pytest.approx(truth, abs=1e-6 * scale)


@pytest.mark.parametrize("bend", [1e-9, 0.3, 1.5, math.pi])
def test_an_arc_lies_within_its_sag_of_its_chord(bend: float) -> None:
    turned = np.linspace(0.0, bend, 1001)
    radius = 1.0 / bend
    arc = radius * np.stack([1.0 - np.cos(turned), np.sin(turned)], axis=-1)
    end = arc[-1]
    along = np.clip(arc @ end / (end @ end), 0.0, 1.0)
    assert np.linalg.norm(arc - along[:, None] * end, axis=-1).max() <= sagitta_bound(1.0, bend) * (1.0 + 1e-12)
