"""Workers: in order, the latest of a key, and nothing that is raised ends them."""

import threading
from functools import partial

from sinuous.view.page.session import Worker


def test_of_one_key_only_the_latest_that_has_not_begun_is_run() -> None:
    hold, done = threading.Event(), threading.Event()
    ran: list[object] = []
    worker = Worker("test", ran.append)
    worker.post("first", hold.wait)
    for i in range(100):
        worker.post("move", partial(ran.append, i))
    worker.post("other", lambda: ran.append("other"))
    worker.post("move", lambda: ran.append("last"))
    worker.post("end", done.set)
    hold.set()
    assert done.wait(30.0)
    worker.stop()
    assert ran == ["other", "last"]


def test_what_is_raised_is_told_and_the_next_task_runs() -> None:
    done, told = threading.Event(), list[Exception]()
    worker = Worker("test", told.append)

    def fail() -> None:
        raise ValueError("no")

    worker.post(1, fail)
    worker.post(2, done.set)
    assert done.wait(30.0)
    worker.stop()
    assert [str(error) for error in told] == ["no"]


def test_after_every_batch_and_once_when_idle() -> None:
    calls: list[str] = []
    idle = threading.Event()

    def rest() -> None:
        calls.append("idle")
        idle.set()

    worker = Worker("test", lambda error: calls.append(str(error)), lambda: calls.append("after"), rest)
    worker.post(1, lambda: calls.append("task"))
    assert idle.wait(30.0)
    worker.stop()
    assert calls == ["task", "after", "idle"]
