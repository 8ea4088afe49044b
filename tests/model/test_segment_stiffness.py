"""The stiffness of a segment, said by itself or as that of a round rod."""

import math
from typing import Any

import pytest

import sinuous as sn
from tests.helpers import refused, refused_each


def test_a_round_rod_has_the_stiffness_of_its_material() -> None:
    rod = sn.Stiffness(youngs_modulus=54e9, poisson=0.3, radius=0.7e-3)
    assert rod.bend == pytest.approx(0.010184, rel=1e-4)
    assert rod.twist == pytest.approx(54e9 / 2.6 * math.pi * 0.7e-3**4 / 2.0)
    assert rod.stretch == pytest.approx(54e9 * math.pi * 0.7e-3**2)


def test_what_cannot_be_is_refused() -> None:
    for key in ("bend", "twist", "stretch"):
        bad: Any = lambda value, key=key: sn.Stiffness(**({"bend": 1.0} | {key: value}))  # noqa: E731
        refused_each(key, (0.0, -1.0, math.nan, "soft"), bad)
    refused("bend", sn.Stiffness, "youngs_modulus and radius")
    refused("radius", lambda: sn.Stiffness(1.0, radius=2.0), "either")
    refused("poisson", lambda: sn.Stiffness(youngs_modulus=1.0, radius=1.0, poisson=-1.0))
