"""A sweep changes just the fields that are named, and refuses what is none."""

from typing import Any

import pytest

import sinuous as sn

ROBOT = sn.Robot.uniform(3, length=(45, 70), max_bend=1.5, radius=4, tendons=sn.Tendons(3, radius=4))


def test_every_combination_is_there_in_order() -> None:
    robots = sn.studies.sweep(ROBOT, {"segments.count": [2, 5], "radius": [1, 2.5]})
    assert list(robots) == [f"segments.count={n}, radius={r}" for n in (2, 5) for r in (1, 2.5)]
    assert [(len(robot), robot.radii[0]) for robot in robots.values()] == [(2, 1.0), (2, 2.5), (5, 1.0), (5, 2.5)]


@pytest.mark.parametrize(
    ("field", "value", "changed"),
    [
        ("segments.length", [30, 40], lambda r: r.segments[2].length == (30.0, 40.0)),
        ("segments[1].max_bend", 0.5, lambda r: [s.max_bend for s in r.segments] == [1.5, 0.5, 1.5]),
        ("segments.tendons.displacement", [-5, 5], lambda r: r.actuators[8].limits == (-5.0, 5.0)),
        ("mount", 20, lambda r: r.mount == 20.0),
        ("base", {"position": [1, 2, 3]}, lambda r: r.base[0, 3] == 1.0),
        ("self_collision", "allow", lambda r: not r.avoids_itself),
        ("radius", 2, lambda r: set(r.radii) == {2.0}),
    ],
)
def test_any_field_of_the_robot_file(field: str, value: Any, changed: Any) -> None:
    (robot,) = sn.studies.sweep(ROBOT, {field: [value]}).values()
    assert changed(robot)
    assert not changed(ROBOT)


def test_its_own_value_changes_nothing() -> None:
    (robot,) = sn.studies.sweep(ROBOT, {"segments.max_bend": [1.5]}).values()
    assert robot.equals(ROBOT)


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"colour": ["red"]}, "colour"),
        ({"segments": [3]}, "names no field"),
        ({"segments[7].length": [3]}, "there is no such segment"),
        ({"segments.chambers.length": [3]}, "this robot has no chambers"),
        ({"segments.length": [-1]}, "length"),
        ({"radius": 3}, "a list of values"),
        ({"radius": []}, "make 0 robots"),
        ({}, "a mapping of fields"),
    ],
)
def test_wrong_fields_are_refused(fields: Any, told: str) -> None:
    with pytest.raises(sn.InputError, match=told):
        sn.studies.sweep(ROBOT, fields)
