"""What is suspicious is said, and what is ordinary is not."""

import math
import warnings

import numpy as np
import pytest

import sinuous as sn
from sinuous.problem.problem import input_warnings, problem_warnings
from tests.scene.shapes import cube

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)


def said(robot: sn.Robot, scene: list[sn.Sphere] | list[sn.Mesh] | list[sn.Box] | None = None) -> list[str]:
    return input_warnings(robot, sn.Scene(scene or []).snapshot())


def test_ordinary_problems_are_not_suspicious() -> None:
    scene = [sn.Sphere((1, 0, 1), 0.01), sn.Box((0, 0, -40), (100, 100, 60)), sn.HalfSpace((0, 0, -1), (0, 0, 1))]
    stage = sn.Robot([sn.Segment((0.0, 1.0), 0.0), sn.Segment((0.0, 1.0), 3.0)], radius=0.1)
    full = sn.Robot.uniform(2, 1.0, 2.0 * np.pi, radius=0.01)
    for robot in (ROBOT, stage, full):
        assert problem_warnings(robot, sn.Scene(scene).snapshot(), [[sn.Target((0, 1, 2))]]) == []


def test_degrees_for_radians() -> None:
    assert said(sn.Robot.uniform(3, 1.0, 90.0)) == [
        "max_bend of all segments is 90 rad, more than a full turn; is it in degrees?"
    ]
    mixed = sn.Robot([sn.Segment(1.0, 2.0), sn.Segment(1.0, 45.0)])
    assert said(mixed) == ["max_bend of segment 2 is 45 rad, more than a full turn; is it in degrees?"]


def arm(unit: float, tendons: float, limit: float, radius: float, tool: float) -> sn.Robot:
    """A robot of some 0.3 m in a length unit of so many metres, of which some lengths are given in another."""
    lines = sn.Tendons(3, tendons, displacement=(-limit, limit))
    pose = np.eye(4)
    pose[2, 3] = tool
    return sn.Robot([sn.Segment(0.1 / unit, 1.5, radius=radius, tendons=lines)] * 3, tool=pose)


def arms() -> list[tuple[float, dict[str, float]]]:
    """Units, and lengths of 60 arms in metres."""
    random = np.random.default_rng(4)
    units = random.choice([1.0, 0.01, 0.001, 0.0254], 60).tolist()
    sizes = [(0.002, 0.02), (0.002, 0.03), (0.001, 0.02), (0.005, 0.2)]
    drawn = [[float(np.exp(random.uniform(*np.log(size)))) for size in sizes] for _ in units]
    return [
        (unit, {"tendons": t, "limit": max(x, 2.0 * t), "radius": r, "tool": tool})
        for unit, (t, x, r, tool) in zip(units, drawn, strict=True)
    ]


@pytest.mark.parametrize("key", ["tendons", "limit", "radius", "tool", "target"])
def test_one_length_in_another_unit_is_said_once(key: str) -> None:
    for unit, own in arms():
        factor = 1000.0 if unit in (1.0, 0.0254) else 0.001
        lengths = {name: value / unit * (factor if name == key else 1.0) for name, value in own.items()}
        place = np.array([0.1, 0.0, 0.2]) / unit * (factor if key == "target" else 1.0)
        found = problem_warnings(arm(unit, **lengths), sn.Scene().snapshot(), [[sn.Target(place)]])
        assert any("one length unit?" in text for text in found), (unit, own, key)


def test_degrees_of_tendons_and_of_rest() -> None:
    def texts(lines: sn.Tendons) -> list[str]:
        return said(sn.Robot([sn.Segment(1.0, 1.0, tendons=lines, stiffness=1.0)]))

    for wrong in (sn.Tendons(angles=[0, 90, 180, 270], radius=0.05), sn.Tendons(4, 0.05, angle=90)):
        (text,) = texts(wrong)
        assert text.startswith("tendons of segment 1 stand at ")
        assert text.endswith("rad, more than a full turn; are these degrees?")
    right = (
        sn.Tendons(4, 0.05, angle=1.0),
        sn.Tendons(angles=[-3.0, 0.0, 3.0, 6.5], radius=0.05),
        sn.Tendons(3, 0.05, 6),
    )
    assert [texts(lines) for lines in right] == [[]] * 3
    assert (
        said(sn.Robot([sn.Segment(1.0, 1.0, rest=(45, 0))]))[-1]
        == "rest of segment 1 is more than a full turn; is it in degrees?"
    )


def test_a_body_that_is_too_thick_for_its_bends() -> None:
    (text,) = said(sn.Robot.uniform(2, 1.0, 3.0, radius=0.5))
    assert "a radius of 0.5 is above the smallest radius of curvature, 0.3333" in text


@pytest.mark.parametrize("size", [400.0, 1100.0])
def test_a_mesh_in_millimetres_beside_a_robot_in_metres(size: float) -> None:
    robot = sn.Robot.uniform(3, 0.4, 2.0)
    (text,) = said(robot, [sn.Mesh(*cube(size, (0.5 * size,) * 3), name="part")])
    assert text.startswith("part is ")
    assert "the robot 1.2 long; are both in one length unit?" in text


def test_a_mesh_in_metres_beside_a_robot_in_millimetres() -> None:
    robot = sn.Robot.uniform(3, 400.0, 2.0)
    (text,) = said(robot, [sn.Mesh(*cube(1.3, (0.65,) * 3))])
    assert text.startswith("all obstacles lie within 2.252, the robot is 1200 long")


def test_a_base_that_touches_what_it_stands_on() -> None:
    floor = sn.Scene([sn.Box((0, 0, -0.5), (4, 4, 1), name="floor")]).snapshot()
    expected = "the base touches floor; where the robot stands on it or sits in it, say so with mount"
    assert problem_warnings(ROBOT, floor, []) == [expected]
    assert input_warnings(ROBOT, floor) == []
    assert problem_warnings(ROBOT.changed(mount=0.2), floor, []) == []


def test_a_target_in_another_unit() -> None:
    (text,) = problem_warnings(ROBOT, sn.Scene().snapshot(), [[sn.Target((0, 1, 2))], [sn.Target((0, 1000, 2000))]])
    assert text.startswith("a target is 2236 from the base, the robot 3.6 long")


def test_python_is_warned_where_the_solver_is_made() -> None:
    with pytest.warns(sn.SuspiciousInput, match="is it in degrees") as caught:
        sn.Solver(sn.Robot.uniform(3, 1.0, 90.0))
    assert [warning.filename for warning in caught] == [__file__]


def test_the_warning_can_be_switched_off_and_is_given_once() -> None:
    robot = sn.Robot.uniform(3, 1.0, 90.0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default", sn.SuspiciousInput)
        for _ in range(3):
            sn.Solver(robot)
    assert len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sn.SuspiciousInput)
        solution = sn.solve(robot, sn.Target((0, 0, 9)))
    solution.explain(time=1.0)  # what is tried again does not warn again


def test_degrees_of_planes_and_joints() -> None:
    planar = sn.Robot([sn.Segment(50.0, 1.0, plane=90.0)])
    assert said(planar) == ["plane of segment 1 is at 90 rad, more than a full turn; is it in degrees?"]
    arm = [sn.Segment(50.0, 1.0)]
    for limits, told in (((-170.0, 170.0), True), ((-2.0 * math.pi, 2.0 * math.pi), False), (None, False)):
        notes = said(sn.Robot(arm, joints=[sn.Revolute((0, 0, 1), limits, name="roll")]))
        told_of = ["joint 'roll' turns up to 170 rad, more than two full turns; are its limits in degrees?"]
        assert notes == (told_of if told else [])
