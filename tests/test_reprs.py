"""What every public object shows of itself: one short line, without arrays."""

import inspect
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sinuous as sn
from sinuous import methods
from sinuous.answer.binding import Binding
from sinuous.answer.remedies import Remedy
from sinuous.answer.status import Reason
from sinuous.answer.step import Active
from sinuous.answer.worst import Worst
from sinuous.base.frozen import LONGEST, text
from sinuous.files.joint_chain import JointChain
from sinuous.studies.designing.design import Design
from sinuous.studies.workspace.reach import Verdict
from tests.helpers import refused, with_each
from tests.scene.shapes import cube

LONG = "a name that goes on and on and on until nobody wants to read it any more"
DRAWN = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))])
SETTINGS = DRAWN.to_actuators([[[0.02 * i, 0.3, 1.0]] for i in range(24)])
ROBOT = sn.Robot.uniform(40, (0.8, 1.2), tendons=sn.Tendons(3, 0.1), radius=0.05, base=sn.pose((1, 2, 3)), name=LONG)
TARGET = sn.Target((1.0, 0.5, 30.0), direction=(0.1, 0.2, 1.0))
SCENE = sn.Scene([sn.Sphere((0.0, 30.0, 0.0), 1.0, name=LONG)])
WRONG = refused("radius", lambda: sn.Sphere((0, 0, 0), -1))


def away(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.norm(points, axis=-1)) - 1.0


@cache
def objects() -> list[Any]:
    """One of everything; not made when tests are collected, since it compiles."""
    solution = sn.solve(ROBOT, TARGET)
    problem = solution.problem
    return [
        *ROBOT.actuators[:1],
        *(sn.Revolute((0, 0, 1), (-1 / 3, 1), name=LONG), sn.Prismatic((1, 2, 3), (0, 1 / 3))),
        *(ROBOT, ROBOT.segments[0], sn.Segment(1, chambers=sn.Chambers(4, 0.1, length=(0.5, 2.0)))),
        sn.Chambers(angles=np.arange(9.0), radius=0.123456789, names=[f"{LONG} {i}" for i in range(9)]),
        sn.Tendons(3, 0.1, displacement=(-0.1, 0.2)),
        sn.Uncertainty(0.2),
        sn.studies.calibrate(DRAWN, SETTINGS, DRAWN.tip(DRAWN.from_actuators(SETTINGS))[:, :3, 3], fit=["base"]),
        sn.Stage(40.0, 1 / 3, LONG, LONG),
        sn.Memory(ROBOT),
        sn.studies.Exploration(sn.Memory(ROBOT), 0.1, False, 1.0),
        sn.studies.Cover([sn.Target((0, 0, 1))] * 9, 0.5),
        Design(("length",), (), None, (), (), 12345, 3, 4, 1.5),
        sn.Actuators(np.ones((40, 120)), limits=(-1e3, 1e3)),
        *(SCENE, SCENE.snapshot()),
        *(sn.Sphere((1 / 3, 2 / 3, 1e-9), 1 / 7, inside=True, name=LONG), sn.HalfSpace((0, 0, 0), (1, 2, 3))),
        sn.Box((1 / 3, 2 / 3, 1.0), (1 / 7, 1.0, 2.0), rotation=(1, 2, 3, 4), inside=True, name=LONG),
        *(sn.Capsule((0, 0, 0), (1, 1, 1), 1 / 3), sn.Cylinder((0, 0, 0), (1 / 3, 1 / 3, 1), 1 / 3, name=LONG)),
        *(sn.Mesh(*cube(), name=LONG), sn.PointCloud(np.eye(3), [1, 2, 3]), sn.PointCloud(np.ones((9, 3)), 0.1)),
        sn.Moving(sn.Sphere((0, 0, 0), 1, name=LONG), np.arange(9.0), np.ones((9, 3))),
        *(sn.Grid(np.zeros((5, 6, 7), bool), (0, 0, 0), 1), sn.Field(away, (-2, -2, -2), (2, 2, 2), 1.0)),
        *(
            TARGET,
            sn.Target((1 / 3, 2 / 3, 1), rotation=(1, 2, 3, 4), segment=3),
            sn.Tolerance(0.1),
            sn.Preferences(1, 2, 3),
        ),
        *(problem, sn.Problem(ROBOT, [TARGET, TARGET], SCENE)),
        sn.Job(ROBOT, path=[TARGET] * 3, file=LONG),
        *(solution, sn.solve(ROBOT, sn.Target((0, 0, 1e3))), solution.explain(), solution.verify()),
        sn.check(ROBOT, [solution.q, solution.q]),
        *(
            motion := sn.Motion(ROBOT, [solution.q, solution.q * (0.5, 0.5, 1)], SCENE),
            motion.timed(sn.Rates(1.0, 1.0)),
        ),
        *(JointChain(ROBOT), sn.Rates(1.0, acceleration=sn.Rates(2.0))),
        *(curve := sn.Curve(np.eye(3)), motion.deviation(curve), sn.Path([0, 1, 2], positions=np.eye(3))),
        *(sn.Solver(ROBOT, SCENE), sn.Solver(ROBOT).solve_many([TARGET, sn.Target((0, 0, 1e3))]), sn.Status.SOLVED),
        *(
            sn.Planner(ROBOT, SCENE),
            sn.Solver(ROBOT, SCENE).step(solution, (0, 0, 0), dt=0.01),
            Active("clearance", 3, LONG),
        ),
        *(
            sn.Rates(1.0) * 0.1,
            sn.studies.Follow([TARGET]),
            sn.studies.Move(TARGET),
            sn.studies.assess(ROBOT, [TARGET]),
            sn.studies.solve_batch(ROBOT, np.eye(3)),
        ),
        *(sn.studies.reach(ROBOT, spacing=24, directions=6), Verdict.SOLVED, sn.studies.UnfinishedError("no room")),
        *(sn.Force((0, 0, -0.3)), sn.Payload(0.1), soft := sn.Stiffness(1.0)),
        sn.Robot.uniform(2, 1.0, stiffness=soft).shape([[0.1, 0.0, 1.0]] * 2, sn.Force((0, 0.1, 0))),
        Binding("actuator", 3, None, 1 / 3, 2 / 3, LONG, "tendons.displacement[1]"),
        Reason("route", 1 / 3, 2 / 3, LONG, True),
        Remedy("start", None, solution.q.tolist()),
        Worst("clearance", 3, LONG, 1 / 3),
        *(
            methods.Newton(),
            methods.OptiPath.faithful(),
            methods.Dls(damping=0.2),
            methods.Fabrikc(),
            methods.Fabrikx(),
            methods.FabrikAvoid(),
        ),
        *(
            methods.MonteCarlo(),
            methods.Slinki(),
            methods.Learned(),
            sn.methods.Network(ROBOT, [[np.zeros((k, 3 * len(ROBOT)))] for k in (4, 7, 13)]),
        ),
        *(WRONG, sn.NotSolvedError("stalled: no", solution), sn.SuspiciousInput("odd")),
    ]


@with_each("value", objects)
def test_it_is_one_short_line(value: Any) -> None:
    shown = repr(value)
    assert "\n" not in shown
    assert len(shown) <= LONGEST
    assert "array" not in shown
    assert "[[" not in shown
    assert " object at " not in shown
    assert shown.lstrip("<").startswith(type(value).__name__)


def test_every_public_class_is_shown() -> None:
    classes = {noun for name in sn.__all__ if inspect.isclass(noun := getattr(sn, name))}
    assert classes <= {type(value) for value in objects()}


def test_what_is_short_is_shown_whole_and_can_be_typed() -> None:
    assert repr(sn.Sphere((0, 80, -120), 25, name="ball")) == "Sphere(center=(0, 80, -120), radius=25, name='ball')"
    turned = sn.Box((0, 0, 0), (1, 2, 3), rotation=(1, 0, 0, 1))
    assert repr(turned) == "Box(center=(0, 0, 0), size=(1, 2, 3), rotation=(0.707107, 0, 0, 0.707107))"
    assert eval(repr(turned), {"Box": sn.Box}).rotation == pytest.approx(turned.rotation, abs=1e-5)
    assert repr(sn.Tolerance(0.1)) == "Tolerance(position=0.1)"
    assert repr(methods.OptiPath(iterations=100)) == "OptiPath(iterations=100)"
    assert repr(sn.Mesh(*cube(), name="crate")) == "Mesh(8 vertices, 12 triangles, solid, name='crate')"
    assert repr(ROBOT.segments[0]) == "Segment(length=(0.8, 1.2), max_bend=3.14159, radius=0.05, 3 tendons)"


@with_each("seed", range(20))
def test_rotations_are_quaternions_that_turn_the_same(seed: int) -> None:
    given = np.random.default_rng(seed).normal(size=4)
    matrix = sn.pose(rotation=given)[:3, :3]
    shown = eval(text(matrix))
    np.testing.assert_allclose(sn.pose(rotation=shown)[:3, :3], matrix, atol=1e-5)
