"""Threads that do what was asked last: what was overtaken is never begun."""

import threading
from collections.abc import Callable, Hashable

Task = Callable[[], object]

IDLE = 0.08
"""Seconds without anything new after which a worker is idle."""


def _nothing() -> None:
    """Do nothing."""


class Worker:
    """A thread that runs tasks in the order in which they were posted.

    A task takes the place of one under the same key that has not begun; so of many moves of a target only the latest
    is looked at.

    Parameters
    ----------
    name : str
    failed : callable
        Called with every exception of a task.
    after : callable, optional
        Called when all tasks that were there have run.
    idle : callable, optional
        Called once when nothing came for a while after that.
    """

    def __init__(
        self,
        name: str,
        failed: Callable[[Exception], object],
        after: Task = _nothing,
        idle: Task = _nothing,
    ) -> None:
        self._failed, self._after, self._idle = failed, after, idle
        self._tasks: dict[Hashable, Task] = {}
        self._condition = threading.Condition()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name=f"sinuous-{name}", daemon=True)
        self._thread.start()

    def post(self, key: Hashable, task: Task) -> None:
        """Have a task run; returns at once."""
        with self._condition:
            self._tasks.pop(key, None)  # what came later runs later
            self._tasks[key] = task
            self._condition.notify()

    def stop(self) -> None:
        """End after the task that runs; wait for that."""
        with self._condition:
            self._stopped = True
            self._condition.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        busy = False
        while True:
            with self._condition:
                if not self._tasks and not self._stopped:
                    self._condition.wait(IDLE if busy else None)
                if self._stopped:
                    return
                tasks, self._tasks = list(self._tasks.values()), {}
            if tasks:
                for task in tasks:
                    self._try(task)
                self._try(self._after)
            elif busy:
                self._try(self._idle)
            busy = bool(tasks)

    def _try(self, task: Task) -> None:
        try:
            task()
        except Exception as error:
            self._failed(error)
