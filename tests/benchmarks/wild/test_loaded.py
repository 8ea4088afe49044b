"""Robots under load in wild worlds: what is honest is not accused, and each kind of lie is seen once."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import Clearances
from benchmarks.wild import loaded
from benchmarks.wild.motions import Judged
from sinuous.answer.solution import Solution
from sinuous.kernels.tables import NO_ROUTE
from sinuous.scene.scene import Scene
from tests.benchmarks.wild.test_trials import changed

ROD = sn.Segment((0.8, 1.0), 2.0, radius=0.02, stiffness=sn.Stiffness(0.5), mass=0.01, arcs=3)
ROBOT = sn.Robot([ROD] * 2, base=sn.pose((0, 0, 0), direction=(1, 0, 0)), gravity=(0, 0, -9.81))
STRAIGHT = np.array([[0.0, 0.0, 1.0]] * 2)


@pytest.fixture(scope="module")
def solution() -> Solution:
    found = sn.solve(ROBOT, sn.Target((1.6, 0.1, -0.2)), [sn.Sphere((1.0, 0.6, 0.0), 0.3)])
    assert found.solved
    return found


def false(said: Solution) -> str:
    return loaded._false(said, said.problem.targets[0])


@pytest.mark.parametrize("kind", loaded.KINDS.values(), ids=loaded.KINDS)
def test_an_honest_answer_is_not_accused(kind: Any) -> None:
    assert [kind(0, number).false for number in range(3)] == [""] * 3


def test_lies_are_seen(solution: Solution) -> None:
    assert false(solution) == ""
    bent = solution.q + np.array([0.01, 0.0, 0.0])
    assert false(changed(solution, q=bent)) == "target missed"
    shape = ROBOT.shape(solution.q)
    gap = float(Clearances(shape.body, Scene.of(solution.problem.scene)).least(shape.arcs[None])[0])
    assert false(changed(solution, clearance=gap)) == ""
    assert false(changed(solution, clearance=gap + 1e-6)) == "clearance overstated"
    assert false(changed(solution, code=NO_ROUTE)) == "no_route"


def test_the_loaded_body_is_judged() -> None:
    sunk = ROBOT.shape(STRAIGHT).tip[:3, 3]
    assert sunk[2] < -0.1
    straight, low = Scene([sn.Sphere((2.0, 0.0, 0.0), 0.05)]), Scene([sn.Sphere(sunk, 0.05)])
    assert loaded._refuted(ROBOT, straight, STRAIGHT[None]) == ""
    assert loaded._refuted(ROBOT, low, STRAIGHT[None]) == "overlap"
    assert loaded._refuted(ROBOT, straight, 1.1 * STRAIGHT[None]) == "limits"


def test_worlds_are_drawn_again_alike() -> None:
    one, other = loaded.make(3, 1), loaded.make(3, 1)
    np.testing.assert_array_equal(one.hidden, other.hidden)
    assert loaded.solved(3, 1) == Judged(True, "")
