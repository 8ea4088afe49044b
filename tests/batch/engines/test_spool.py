"""Chunks and answers travel in files; what goes through pipes fits into one write."""

import pickle
import select
from pathlib import Path

import numpy as np

import sinuous as sn
from sinuous.batch.engines import processes
from sinuous.batch.engines.spool import Spool, take
from sinuous.batch.work import Task, Work


def test_what_is_taken_is_what_was_put_and_nothing_stays() -> None:
    spool = Spool()
    values = [np.arange(1e5), {"a": 1}, "text"]
    names = [spool.put(value) for value in values]
    for name, value in zip(names[:2], values, strict=False):
        assert pickle.dumps(take(name)) == pickle.dumps(value)
        assert not Path(name).exists()
    folder = Path(names[2]).parent
    assert [file.name for file in folder.iterdir()] == [Path(names[2]).name]
    spool.close()
    assert not folder.exists()


def test_what_goes_through_pipes_is_written_whole_or_not_at_all() -> None:
    """A worker that is killed half-way through an answer would leave the others waiting for the rest of it."""
    work = Work(sn.Solver(sn.Robot.uniform(2, length=(0.8, 1.2), max_bend=2.0)))
    positions = np.random.default_rng(0).uniform((-0.3, -0.3, 1.5), (0.3, 0.3, 2.0), (200, 3))
    task = Task(0, 0, {"positions": positions})
    spool = Spool()
    processes._begin(pickle.dumps(work))
    asked = spool.put(task)
    answered = processes._do(asked)
    for message in (asked, answered):
        assert len(pickle.dumps(message)) < select.PIPE_BUF // 2
    block = take(answered)
    assert pickle.dumps(block) == pickle.dumps(work(task))
    assert len(pickle.dumps(block)) > select.PIPE_BUF
    spool.close()
