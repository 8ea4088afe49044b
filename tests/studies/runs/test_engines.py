"""Engines do each task once, try one that fails three times, and lose no other with one that kills its worker."""

import pickle
import select
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.studies.batch.batch import ChunkSolver
from sinuous.studies.runs.engine import MOST_TRIES, Engine, Failure, LostError, Task
from sinuous.studies.runs.engines import (
    GivenExecutor,
    Processes,
    Threads,
    do_file,
    from_file,
    pickled,
    take_work,
    to_file,
)
from tests.helpers import refused
from tests.studies.batch.questions import BALL, OPTIONS, ROBOT, points
from tests.studies.runs.poison import Poisonous

COUNT = 7


def tasks() -> Iterator[Task]:
    for number in range(COUNT):
        yield number, {"values": np.arange(number, number + 5.0)}


def done(engine: Engine) -> list[int]:
    """Numbers of the tasks that an engine does; the answers are looked at."""
    with engine:
        found = list(engine.run(tasks()))
    for number, answer in found:
        np.testing.assert_array_equal(answer["squares"], np.arange(number, number + 5.0) ** 2)
    return sorted(number for number, _ in found)


def test_a_task_that_fails_is_tried_three_times_and_reported(tmp_path: Path) -> None:
    work = Poisonous(tmp_path, raising=2)
    engine = Threads(work, 2)
    assert done(engine) == [0, 1, 3, 4, 5, 6]
    assert engine.failures == [Failure(2, "RuntimeError: as asked")]
    assert work.tried()[2] == MOST_TRIES
    with (
        Threads(work, 2) as other,
        pytest.raises(sn.studies.UnfinishedError, match=r"^no squares: RuntimeError: as asked$"),
    ):
        other.results([task for _, task in tasks()], "no squares")


def test_workers_that_die_are_replaced_and_only_the_guilty_task_is_given_up(tmp_path: Path) -> None:
    work = Poisonous(tmp_path, killing=1, unlucky=4)
    engine = Processes(work, 2)
    assert done(engine) == [0, 2, 3, 4, 5, 6]  # nothing lost, nothing twice
    (failure,) = engine.failures
    assert failure.number == 1
    assert "process" in failure.reason
    assert max(work.tried().values()) <= MOST_TRIES


class Brittle(Executor):
    """Breaks with its third task."""

    def __init__(self) -> None:
        self.taken = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        self.taken += 1
        future: Future[Any] = Future()
        if self.taken == 3:
            future.set_exception(BrokenExecutor("gone"))
        else:
            future.set_result(fn(*args))
        return future


def closed_pool() -> Executor:
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    return pool


@pytest.mark.parametrize(("executor", "told"), [(Brittle, "broke"), (closed_pool, "takes no more")])
def test_an_executor_that_breaks_is_not_ours_to_mend(executor: Any, told: str, tmp_path: Path) -> None:
    with pytest.raises(LostError, match=told):
        done(GivenExecutor(Poisonous(tmp_path), executor(), 1))


def test_what_goes_through_pipes_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    """A worker that is killed half-way through an answer would leave the others waiting for the rest of it."""
    work = Poisonous(tmp_path)
    task = {"values": np.arange(1e5)}
    take_work(pickle.dumps(work))
    asked = to_file(task, str(tmp_path))
    answered = do_file(asked)
    assert not Path(asked).exists()
    for message in (asked, answered):
        assert len(pickle.dumps(message)) < select.PIPE_BUF // 2
    np.testing.assert_array_equal(from_file(answered)["squares"], task["values"] ** 2)
    assert not Path(answered).exists()


def plane(at: Floats) -> Floats:
    return at[:, 0] - 10.0


def test_a_field_of_a_function_of_a_module_travels_and_one_of_a_lambda_is_refused() -> None:
    low, high = (20, 20, 20), (60, 60, 60)
    work = ChunkSolver(sn.Solver(ROBOT, [BALL, sn.Field(plane, low, high, 10)], **OPTIONS))
    rows = {"positions": points(6)}
    here, there = work(rows), pickle.loads(pickled(work)).prepare()(rows)
    for name, column in here.items():
        np.testing.assert_array_equal(column, there[name])
    other = ChunkSolver(sn.Solver(ROBOT, [BALL, sn.Field(lambda at: at[:, 0] - 10.0, low, high, 10)], routes=False))
    refused("scene[1]", lambda: pickled(other), "cannot be sent to ", "; expected a function of a module")
