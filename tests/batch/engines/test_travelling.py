"""What goes to other processes: everything but a scene with a function of the main program."""

import pickle

import numpy as np
import pytest

import sinuous as sn
from sinuous.batch.engines.engine import pickled
from sinuous.batch.work import Task, Work
from sinuous.checks import Floats
from tests.batch.questions import BALL, OPTIONS, ROBOT, points

LOW, HIGH = (20, 20, 20), (60, 60, 60)


def plane(at: Floats) -> Floats:
    return at[:, 0] - 10.0


def test_a_field_of_a_lambda_cannot_travel_and_that_is_said() -> None:
    field = sn.Field(lambda at: at[:, 0] - 10.0, LOW, HIGH, 10)
    work = Work(sn.Solver(ROBOT, [BALL, field], routes=False))
    with pytest.raises(sn.InputError, match=r"^scene\[1\]: expected a function of a module .*cannot travel"):
        pickled(work)


def test_a_field_of_a_function_of_a_module_travels_and_what_comes_solves_alike() -> None:
    work = Work(sn.Solver(ROBOT, [BALL, sn.Field(plane, LOW, HIGH, 10)], **OPTIONS))
    task = Task(0, 0, {"positions": points(6)})
    here, there = work(task), pickle.loads(pickled(work)).prepare()(task)
    for name, column in here.items():
        np.testing.assert_array_equal(column, there[name])
