"""Equilibria under load: laws of statics, and rods that were computed by other code."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import sinuous as sn
from benchmarks.judges.cosserat import shoot
from tests.helpers import Floats, present, refused

ROD = sn.Stiffness(bend=1.0, twist=0.7, stretch=40.0)
SOFT: dict[str, Any] = {"stiffness": ROD, "mass": 0.3, "arcs": 4, "gravity": (0.3, 0.0, -2.0)}
SHAPE = np.array([[0.5, 0.2, 0.5], [-0.4, 0.9, 0.4]])
FORCE = sn.Force((0.4, -0.6, 0.3), position=(0.05, 0.0, 0.1))


def arm(**more: Any) -> sn.Robot:
    return sn.Robot([sn.Segment((0.3, 0.6), radius=0.01)] * 2, **{**SOFT, **more})


def frames_of(states: Any, base: Floats) -> list[Floats]:
    """Frames of arcs and rolls by matrix exponentials, and the middles by many points."""
    frames = [base]
    for x, y, twist, length in states:
        bend, roll = np.zeros((4, 4)), np.zeros((4, 4))
        bend[:3, 2], bend[2, :2], bend[2, 3] = (x, y, 0.0), (-x, -y), length
        roll[0, 1], roll[1, 0] = -twist, twist
        frames.append(frames[-1] @ expm(bend) @ expm(roll))
    return frames


def weighed(frame: Floats, state: Floats) -> Floats:
    """Center of gravity of an arc, by Gauss's rule."""
    nodes, shares = np.polynomial.legendre.leggauss(8)
    total = np.zeros(3)
    for node, share in zip(0.5 * (nodes + 1.0), 0.5 * shares, strict=True):
        total += share * frames_of([node * state * (1.0, 1.0, 0.0, 1.0)], frame)[1][:3, 3]
    return total


def energy(found: sn.answer.Equilibrium, states: Floats, rests: Floats, tensions: Any = ()) -> float:
    """Energy of a body of arcs, forces and weights, from their definitions."""
    robot, arcs = found.robot, len(states) // len(found.robot)
    frames, total, gravity = frames_of(states, robot.base), 0.0, robot.gravity
    assert gravity is not None
    for k, (x, y, twist, length) in enumerate(states):
        segment, own = robot.segments[k // arcs], found.q[k // arcs, 2] / arcs
        assert segment.stiffness is not None
        turn = np.exp(-0.5j * twist) * (x + 1j * y)
        total += 0.5 * segment.stiffness.bend / own * abs(turn - complex(*rests[k // arcs]) / arcs) ** 2
        total += 0.5 * (segment.stiffness.twist * twist**2 + segment.stiffness.stretch * (length - own) ** 2) / own
        total -= segment.mass * own * gravity @ weighed(frames[k], states[k])
    for load in [*robot.payload, *found.loads]:
        place = frames[arcs * (load.segment or len(robot))] @ [*load.position, 1.0]
        total -= (load.force if isinstance(load, sn.Force) else load.mass * gravity) @ place[:3]
    for tension, (last, line) in zip(tensions, lines_of(robot), strict=True):
        places = [(frame @ [*line, 0.0, 1.0])[:3] for frame in frames[: arcs * last + 1]]
        total += tension * np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    return float(total)


def lines_of(robot: sn.Robot) -> list[tuple[int, Floats]]:
    own = [(k, s.tendons.arms) for k, s in enumerate(robot.segments, 1) if s.tendons is not None]
    return [(k, line) for k, arms in own for line in arms]


def slopes(function: Any, states: Floats) -> Floats:
    result, step = np.zeros(states.size), 1e-5
    for i in range(states.size):
        more = np.zeros(states.size)
        more[i] = step
        change = more.reshape(states.shape)
        result[i] = (function(states + change) - function(states - change)) / (2.0 * step)
    return result


def test_energy_is_stationary_and_least() -> None:
    robot = arm(payload=[sn.Payload(0.1, (0.0, 0.05, 0.1)), sn.Payload(0.2, segment=1)])
    found = robot.shape(SHAPE, [FORCE, sn.Force((0.0, 0.5, 0.0), segment=1)])
    assert np.abs(found.states[:, 2]).max() > 0.01, "nothing is twisted"
    own: Any = lambda states: energy(found, states, SHAPE[:, :2])  # noqa: E731
    assert np.abs(slopes(own, found.states)).max() < 1e-8
    assert found.stable
    random = np.random.default_rng(0)
    least = own(found.states)
    assert all(own(found.states + 1e-3 * random.normal(size=(8, 4))) > least for _ in range(20))


def test_energy_of_straight_tendons_is_stationary() -> None:
    robot = arm()
    tendons = sn.Tendons(3, 0.05, straight=True)
    pulled = robot.changed(segments=[each.changed(tendons=tendons, rest=(0.1, -0.2)) for each in robot.segments])
    tensions = np.array([5.0, 0.0, 1.0, 0.0, 3.0, 0.5])
    found = pulled.equilibrium(tensions=tensions, forces=FORCE, initial=SHAPE)
    rests = np.array([[0.1, -0.2]] * 2)
    assert np.abs(slopes(lambda states: energy(found, states, rests, tensions), found.states)).max() < 1e-7


def test_the_base_holds_all_loads() -> None:
    robot = arm(payload=sn.Payload(0.2))
    assert robot.gravity is not None
    moment = np.array([0.1, -0.3, 0.2])
    found = robot.shape(SHAPE, sn.Force((0.4, -0.6, 0.3), moment, segment=1))
    weights = 0.3 * SHAPE[:, 2].sum() + 0.2
    assert found.reaction[3:] == pytest.approx(-(weights * robot.gravity + [0.4, -0.6, 0.3]), abs=1e-12)
    total = moment + np.cross(found.poses[0][:3, 3], [0.4, -0.6, 0.3]) + np.cross(found.tip[:3, 3], 0.2 * robot.gravity)
    for k, frame in enumerate(frames_of(found.states, robot.base)[:-1]):
        own = 0.3 * SHAPE[k // 4, 2] / 4.0 * robot.gravity
        total += np.cross(weighed(frame, found.states[k]), own)
    assert found.reaction[:3] == pytest.approx(-total, abs=1e-9)


def test_a_robot_that_stands_elsewhere_in_a_world_that_is_turned_is_shaped_alike() -> None:
    turn = np.eye(4)
    turn[:3, :3] = expm(np.cross(np.eye(3), [0.5, -1.0, 0.8]))
    turn[:3, 3] = 5.0, -3.0, 2.0
    robot = arm()
    here = robot.shape(SHAPE, FORCE)
    there = robot.changed(base=turn, gravity=turn[:3, :3] @ present(robot.gravity))
    moved = there.shape(SHAPE, FORCE.changed(force=turn[:3, :3] @ FORCE.force))
    assert moved.states == pytest.approx(here.states, abs=1e-9)
    assert moved.tip == pytest.approx(turn @ here.tip, abs=1e-9)


def test_more_arcs_come_nearer_to_a_cosserat_rod_with_their_square() -> None:
    robot = arm()
    load = sn.Force((0.4, -0.6, 0.3), (0.2, 0.1, -0.3))
    curvatures = np.array([[-y / length, x / length, 0.0] for x, y, length in SHAPE])
    loads = np.zeros((2, 6))
    loads[1] = [*load.force, *load.moment]
    weights = np.tile(0.3 * present(robot.gravity), (2, 1))
    true = shoot(SHAPE[:, 2], np.array([[1.0, 0.7, 40.0]] * 2), curvatures, weights, loads, np.eye(4))
    shapes = [robot.changed(arcs=m).shape(SHAPE, load) for m in (2, 4, 8, 16)]
    errors = [np.abs(found.poses - true).max() for found in shapes]
    assert errors[-1] < 2e-4
    for found in shapes[1:]:
        assert found.error == pytest.approx(np.linalg.norm(found.tip[:3, 3] - true[-1][:3, 3]), rel=0.1)
    for coarse, fine in pairwise(errors[1:]):
        assert 3.4 < coarse / fine < 4.6


@pytest.mark.parametrize("arcs", [4, 16])
@pytest.mark.parametrize("lines", [None, sn.Tendons(3, 0.005, straight=True)])
def test_heavy_loads_are_found_in_few_steps_however_many_arcs_there_are(lines: sn.Tendons | None, arcs: int) -> None:
    rod, q = sn.Stiffness(0.01, 0.008), np.array([[0.6, -0.9, 0.1], [-0.8, 0.3, 0.1], [0.2, 0.9, 0.1]])
    payload = sn.Payload(0.1 if lines is None else 1.0)
    robot = sn.Robot.uniform(3, 0.1, stiffness=rod, mass=0.05, arcs=arcs, tendons=lines, payload=payload)
    found = robot.changed(gravity=(0.0, 0.0, -9.81)).shape(q)
    assert np.linalg.norm(found.tip[:3, 3] - robot.tip(q)[:3, 3]) > 0.4
    assert found.stable
    assert found.iterations <= 30


def test_tendons_of_given_lengths_have_the_tensions_that_hold_them() -> None:
    tendons = sn.Tendons(3, 0.05, stiffness=2000.0)
    rod = sn.Stiffness(1.0, 0.7)
    robot = sn.Robot.uniform(2, 0.5, tendons=tendons, stiffness=rod, arcs=4, mass=0.2, gravity=(0, 0, -2))
    q = np.array([[0.6, -0.3, 0.5], [0.2, 0.9, 0.5]])
    found = robot.shape(q, FORCE)
    pulled = robot.equilibrium(tensions=found.tensions, forces=FORCE, initial=q)
    assert pulled.apart(found) < 1e-9
    named = dict(zip((each.name for each in robot.actuators), found.tensions.tolist(), strict=True))
    np.testing.assert_array_equal(robot.equilibrium(tensions=named, forces=FORCE, initial=q).tip, pulled.tip)
    assert found.tensions.min() == 0.0, "no tendon is slack"
    assert robot.equilibrium(robot.to_actuators(q), FORCE, initial=q).apart(found) < 1e-9
    free = robot.changed(segments=[each.changed(tendons=None) for each in robot.segments])
    moved = [np.linalg.norm(each.shape(q, FORCE).tip - each.tip(q)) for each in (robot, free)]
    assert moved[0] < 0.5 * moved[1], "tendons hold nothing"


def test_a_column_buckles_at_eulers_load() -> None:
    column = sn.Robot.uniform(1, 1.0, stiffness=1.0, arcs=16)
    euler, straight = math.pi**2 / 4.0, np.array([[0.0, 0.0, 1.0]])
    below = column.shape(straight, sn.Force((0.0, 0.0, -0.98 * euler)))
    above = column.shape(straight, sn.Force((0.0, 0.0, -1.05 * euler)))
    assert below.tip[2, 3] == pytest.approx(1.0)
    assert below.stable
    assert above.stable
    assert above.tip[2, 3] < 0.95


def test_other_equilibria_are_found_and_said_to_be_unstable() -> None:
    column = sn.Robot.uniform(1, 1.0, stiffness=1.0, arcs=8)
    found = column.shape([[0.0, 0.0, 1.0]], sn.Force((0.05, 0.0, -0.5 * math.pi**2)))
    others = found.others(starts=10)
    assert found.stable
    assert found.tip[0, 3] > 0.0
    assert any(each.tip[0, 3] < 0.0 for each in others)
    assert not any(each.stable for each in others), "it would turn round to the side that it is pushed to"


def test_a_retracted_or_rigid_segment_does_not_give() -> None:
    segments = [sn.Segment((0.0, 0.5)), sn.Segment(0.5, stiffness=1.0, arcs=4), sn.Segment((0.0, 0.5), stiffness=1.0)]
    found = sn.Robot(segments).shape([[0.3, 0.0, 0.5], [0.0, 0.1, 0.5], [0.0, 0.0, 0.0]], sn.Force((0.0, 1.0, 0.0)))
    assert found.states[0].tolist() == [0.3, 0.0, 0.0, 0.5]
    assert found.states[-1].tolist() == [0.0, 0.0, 0.0, 0.0]
    assert found.tip[1, 3] > 0.05


def test_bad_input_is_refused() -> None:
    refused("gravity", lambda: sn.Robot.uniform(2, 1.0, gravity=(0, 0, -1)), "mass")
    refused("stiffness", lambda: sn.Robot.uniform(2, 1.0).shape([[0, 0, 1], [0, 0, 1]]))
    refused("load[1]", lambda: arm().shape(SHAPE, [FORCE, 3]), "Force")  # type: ignore[list-item]
    refused("load.segment", lambda: arm().shape(SHAPE, sn.Force((0, 0, 1), segment=3)), "from 1 to 2")
    refused("load", lambda: arm().shape(SHAPE, sn.Force((4e3, 3e3, -5e3))), "no equilibrium was found beyond")
    refused("actuators", lambda: arm().equilibrium(), "either")
    refused("mass", lambda: sn.Payload(-1.0))
    refused("arcs", lambda: sn.Segment(1.0, arcs=0))
