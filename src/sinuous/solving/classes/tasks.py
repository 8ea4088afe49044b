"""Searches for routes that are still to be done, and in what order."""

from collections import deque
from typing import NamedTuple


class Task(NamedTuple):
    """A search that is still to be done.

    Attributes
    ----------
    closed : frozenset of int
        Numbers of the screens that stand in its scene.
    plan : int
        Number of its plan.
    again : bool
        Whether a route was found so already, but no solution along it.
    """

    closed: frozenset[int]
    plan: int
    again: bool = False


class Tasks:
    """Searches still to be done: those where there probably is no route come last, and of these the quick ones first.

    Parameters
    ----------
    plans : int
        How many plans there are; a task beyond the last is dropped.
    """

    def __init__(self, plans: int) -> None:
        self._queues: list[deque[Task]] = [deque() for _ in range(plans + 1)]

    def add(self, task: Task, last: bool = False) -> None:
        """Add a search."""
        if task.plan + 1 < len(self._queues):
            self._queues[task.plan + 1 if last else 0].append(task)

    def next(self) -> Task | None:
        """Take out what is to be done next; `None` where there is nothing."""
        return next((queue.popleft() for queue in self._queues if queue), None)
