"""How far equilibria leave the straight way between two: never more than is proved, by shapes that SciPy minimises."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import sinuous as sn
from sinuous.measures.statics import _energy, _tensions, imbalance
from sinuous.statics.between import bounded, leave
from sinuous.statics.body import body_of
from sinuous.statics.rest import Rest, Way
from tests.helpers import Floats, with_each

STEP = 1.5e-8
"""Of differences."""

GRAVITY = (0.0, 0.0, -9.81)
Q = np.array([[0.5, 0.2, 0.1], [-0.4, 0.6, 0.1], [0.3, 0.3, 0.1]])
MOVED = np.array([[0.08, -0.05, 0.004], [0.06, 0.05, -0.004], [-0.06, 0.09, 0.002]])

RODS: dict[str, tuple[sn.Stiffness, dict[str, Any]]] = {
    "bends": (sn.Stiffness(0.01), {}),
    "twists": (sn.Stiffness(0.01, 0.008), {}),
    "stretches": (sn.Stiffness(0.01, stretch=30.0), {}),
    "twists and stretches": (sn.Stiffness(0.01, 0.008, 30.0), {}),
    "tendons": (sn.Stiffness(0.01), {"tendons": sn.Tendons(3, 0.004, stiffness=400.0)}),
    "joints": (sn.Stiffness(0.01, 0.008), {}),
}

JOINTS = [
    sn.Revolute(
        (0, 1, 0.2), (-2, 2), sn.pose((0.1, 0, 0.3), direction=(1, 2, 3)), body=[((0, 0, 0), (0, 0.1, 0), 0.02)]
    ),
    sn.Prismatic((1, 0, 1), (0.01, 0.2), (0.05, 0.0, 0.1)),
    sn.Revolute((0, 0, 1), (-3, 3)),
]
"""They turn the arm about slanted axes, and shift it; a link has a body."""

TURNED = np.array([0.5, 0.05, -0.3]), np.array([0.15, 0.02, 0.2])
"""Their values, and by how much they move."""


def arm(stiffness: sn.Stiffness, **more: Any) -> sn.Robot:
    segments = [sn.Segment((0.07, 0.13), max_bend=2.0, radius=0.005, **more)] * 3
    own: dict[str, Any] = {"stiffness": stiffness, "mass": 0.05, "arcs": 3, "gravity": GRAVITY}
    return sn.Robot(segments, payload=sn.Payload(0.01, position=(0.01, 0.0, 0.02)), **own)


@with_each("kind", RODS)
@with_each("size", [0.1, 1.0])
def test_equilibria_on_the_way_are_within_the_bound(kind: str, size: float) -> None:
    stiffness, more = RODS[kind]
    robot, q, moved = arm(stiffness, **more), Q, Q + size * MOVED
    if kind == "joints":
        robot = robot.changed(joints=JOINTS)
        q, moved = robot.with_joints(Q, TURNED[0]), robot.with_joints(moved, TURNED[0] + size * TURNED[1])
    one, other = Rest(robot, q), Rest(robot, moved)
    off, way = leave(one, other), Way(one, other)
    if size == 0.1:
        assert off.aside < 0.1 * robot.mean_length, "nothing is proved"
    worst = 0.0
    for share in (0.2, 0.5, 0.7):
        rest = way.rest(share)
        assert imbalance(robot, rest.q, rest.found[0], rest.displacements) < 1e-7
        body = robot.shape(q).body
        both = np.stack([(1.0 - share) * one.arcs + share * other.arcs, rest.arcs])
        points = body.backbone(both)
        worst = max(worst, float(np.linalg.norm(points[0] - points[1], axis=1).max()))
    assert 0.0 < worst <= off.aside


@pytest.mark.parametrize("kind", ["bends", "twists", "stretches", "twists and stretches", "held tendons"])
@pytest.mark.parametrize("size", [0.0, 0.1])
def test_equilibria_aside_of_the_way_are_within_the_bound(kind: str, size: float) -> None:
    stiffness, more = (sn.Stiffness(0.01), {"tendons": sn.Tendons(3, 0.004)}) if kind == "held tendons" else RODS[kind]
    robot, random = arm(stiffness, **more), np.random.default_rng(1)
    one, other = Rest(robot, Q), Rest(robot, Q + size * MOVED)
    bow = np.tile([0.001, 0.001, 0.00005], (3, 1))
    off, straight, worst = leave(one, other, bow), leave(one, other), 0.0
    assert straight.aside < off.aside < 0.2 * robot.mean_length
    for side, share in zip(random.choice([-1.0, 1.0], (20, 3, 3)), np.linspace(0.2, 0.8, 20), strict=True):
        drive = Q + share * size * MOVED + 4.0 * share * (1.0 - share) * side * bow
        both = np.stack([(1.0 - share) * one.arcs + share * other.arcs, robot.shape(drive).arcs])
        points = robot.shape(Q).body.backbone(both)
        worst = max(worst, float(np.linalg.norm(points[0] - points[1], axis=1).max()))
    assert 0.02 * off.aside < worst <= off.aside
    with_springs = arm(sn.Stiffness(0.01), **RODS["tendons"][1])
    assert leave(Rest(with_springs, Q), Rest(with_springs, Q + 0.01 * MOVED), bow).aside == np.inf


def test_the_bound_shrinks_with_the_square_of_the_step() -> None:
    robot = arm(sn.Stiffness(0.01, 0.008))
    bounds = [leave(Rest(robot, Q), Rest(robot, Q + size * MOVED)).aside for size in (0.2, 0.1, 0.05)]
    assert bounds[0] / bounds[1] == pytest.approx(4.0, rel=0.3)
    assert bounds[1] / bounds[2] == pytest.approx(4.0, rel=0.15)
    same = Rest(robot, Q)
    assert leave(same, same).aside == 0.0


def test_a_tendon_that_becomes_slack_on_the_way_is_counted() -> None:
    robot = arm(sn.Stiffness(0.01), tendons=sn.Tendons(3, 0.004, stiffness=400.0))
    one = Rest(robot, Q)
    turned = Q * [-1.0, 1.0, 1.0]
    other = Rest(robot, Q + 0.05 * (turned - Q))
    kept, lost = leave(one, Rest(robot, Q + 0.01 * MOVED)), leave(one, other)
    assert kept.aside < lost.aside


def test_what_twists_with_tendons_or_has_straight_ones_is_not_bounded() -> None:
    assert bounded(arm(sn.Stiffness(0.01, 0.008)))
    assert bounded(arm(sn.Stiffness(0.01), tendons=sn.Tendons(3, 0.004)))
    for robot in (
        arm(sn.Stiffness(0.01, 0.008), tendons=sn.Tendons(3, 0.004)),
        arm(sn.Stiffness(0.01), tendons=sn.Tendons(3, 0.004, straight=True)),
    ):
        assert not bounded(robot)
        assert leave(Rest(robot, Q), Rest(robot, Q + 0.01 * MOVED)).aside == np.inf


@pytest.mark.parametrize("kind", ["bends", "twists and stretches", "tendons"])
def test_the_judge_finds_the_least_energy_that_scipy_finds(kind: str) -> None:
    stiffness, more = RODS[kind]
    robot = arm(stiffness, **more).changed(arcs=2)
    states, q = robot.shape(Q).states, Q
    own = body_of(robot)
    gives = np.isfinite(own.stiffness[own.owners][:, [0, 0, 1, 2]])

    def energies(moved: Floats) -> Floats:
        changed = np.repeat(states[None], len(moved), axis=0)
        changed[:, gives] += 1e-2 * moved
        total, long = (each[0] for each in _energy(robot, own, q[None], changed[None]))
        pulls = _tensions(robot, own, q[None], long, None)
        return np.asarray(1e4 * (total + 0.5 * pulls**2 @ own.lines.compliance))

    def energy(moved: Floats) -> tuple[float, Floats]:
        around = energies(np.vstack([moved, moved + STEP * np.eye(len(moved))]))
        return float(around[0]), (around[1:] - around[0]) / STEP

    begin = np.full(int(gives.sum()), 0.3) * np.where(np.nonzero(gives)[1] == 3, 0.1, 1.0)
    found = minimize(energy, begin, jac=True, method="BFGS", options={"gtol": 1e-6})
    assert np.abs(found.x).max() < 1e-2, "SciPy found another least energy"


def test_the_judge_sees_what_is_not_at_rest() -> None:
    robot = arm(sn.Stiffness(0.01, 0.008))
    states = robot.shape(Q).states
    assert imbalance(robot, Q, states) < 1e-8
    assert imbalance(robot, Q, states * [1.001, 1.0, 1.0, 1.0]) > 1e-5
    assert imbalance(robot.changed(mass=0.051), Q, states) > 1e-5
    assert imbalance(robot, Q + 1e-3, states) > 1e-5
