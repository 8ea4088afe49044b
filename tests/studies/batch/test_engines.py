"""Chunks and answers travel in files, the work as it is; what goes through pipes fits into one write."""

import pickle
import select
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.studies.batch import engines
from sinuous.studies.batch.engines import from_file, pickled, solve_file, to_file
from sinuous.studies.batch.work import Chunk, ChunkSolver
from tests.studies.batch.questions import BALL, OPTIONS, ROBOT, points

LOW, HIGH = (20, 20, 20), (60, 60, 60)


def test_a_value_is_read_once_and_its_file_is_deleted(tmp_path: Path) -> None:
    values = [np.arange(1e5), {"a": 1}, "text"]
    names = [to_file(value, str(tmp_path)) for value in values]
    for name, value in zip(names, values, strict=True):
        assert pickle.dumps(from_file(name)) == pickle.dumps(value)
    assert not list(tmp_path.iterdir())


def test_what_goes_through_pipes_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    """A worker that is killed half-way through an answer would leave the others waiting for the rest of it."""
    work = ChunkSolver(sn.Solver(sn.Robot.uniform(2, length=(0.8, 1.2), max_bend=2.0)))
    positions = np.random.default_rng(0).uniform((-0.3, -0.3, 1.5), (0.3, 0.3, 2.0), (200, 3))
    chunk = Chunk(0, 0, {"positions": positions})
    engines._take_work(pickle.dumps(work))
    asked = to_file(chunk, str(tmp_path))
    answered = solve_file(asked)
    for message in (asked, answered):
        assert len(pickle.dumps(message)) < select.PIPE_BUF // 2
    block = from_file(answered)
    assert pickle.dumps(block) == pickle.dumps(work(chunk))
    assert len(pickle.dumps(block)) > select.PIPE_BUF


def plane(at: Floats) -> Floats:
    return at[:, 0] - 10.0


def test_a_field_of_a_lambda_cannot_travel_and_that_is_said() -> None:
    field = sn.Field(lambda at: at[:, 0] - 10.0, LOW, HIGH, 10)
    work = ChunkSolver(sn.Solver(ROBOT, [BALL, field], routes=False))
    with pytest.raises(sn.InputError, match=r"^scene\[1\]: expected a function of a module .*cannot travel"):
        pickled(work)


def test_a_field_of_a_function_of_a_module_travels_and_what_comes_solves_alike() -> None:
    work = ChunkSolver(sn.Solver(ROBOT, [BALL, sn.Field(plane, LOW, HIGH, 10)], **OPTIONS))
    chunk = Chunk(0, 0, {"positions": points(6)})
    here, there = work(chunk), pickle.loads(pickled(work)).prepare()(chunk)
    for name, column in here.items():
        np.testing.assert_array_equal(column, there[name])
