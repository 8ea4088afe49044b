"""Tolerances, preferences and problems refuse what they cannot mean."""

from typing import Any

import pytest

import sinuous as sn
from tests.cases import with_each
from tests.helpers import refused
from tests.scene.shapes import cube

ROBOT = sn.Robot.uniform(5, (45, 70))


@with_each("value", [0, -1, float("nan"), float("inf"), "1", True, None])
def test_wrong_tolerances_are_refused(value: Any) -> None:
    with pytest.raises(sn.InputError, match="angle"):
        sn.Tolerance(angle=value)


@pytest.mark.parametrize("key", ["start", "bends", "clearance"])
def test_wrong_preferences_are_refused(key: str) -> None:
    for value in (-1, float("nan"), "much"):
        wrong: dict[str, Any] = {key: value}
        with pytest.raises(sn.InputError, match=key):
            sn.Preferences(**wrong)
    assert sn.Preferences(**{key: 1})
    assert not sn.Preferences()


@pytest.mark.parametrize("size", [0.01, 1e6])
def test_a_mesh_in_another_unit_is_refused(size: float) -> None:
    scene = [sn.Sphere((0, 0, 0), 1), sn.Mesh(*cube(size))]
    refused("scene[1].mesh.vertices", lambda: sn.Problem(ROBOT, sn.Target((0, 0, 9)), scene), "287.5 long")
    assert len(sn.Problem(ROBOT, sn.Target((0, 0, 9)), [sn.Mesh(*cube(50.0))]).scene) == 1
