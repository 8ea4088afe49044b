"""The interface of engines: workers that do tasks, until each task is done or has failed three times.

A task, its answer and what it is a part of are plain arrays by name, so that they travel between processes and machines
and stand in a checkpoint.
"""

from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from typing import Any, NamedTuple, Protocol, Self

from numpy.typing import NDArray

from sinuous.base.errors import UnfinishedError
from sinuous.scene.scene import Scene

Arrays = dict[str, NDArray[Any]]
"""Arrays by name."""

MOST_TRIES = 3
"""How often a task is tried before it is given up."""

REASON_LENGTH = 300
"""Letters of the reason why a task failed that are kept."""

Task = tuple[int, Arrays]
"""A task: its number in the run, and what it consists of."""


class Work(Protocol):
    """What workers do, in a scene; it is pickled when they are other processes."""

    scene: Scene

    def prepare(self) -> Self:
        """Compile, or load, what it needs."""
        ...

    def __call__(self, task: Arrays, /) -> Arrays:
        """Do a task."""
        ...


class LostError(Exception):
    """The workers are gone, and no task can be done any more; its text says what happened."""


class Failure(NamedTuple):
    """A task that was given up.

    Attributes
    ----------
    number : int
    reason : str
        What its last try ended with.
    """

    number: int
    reason: str


class _Queue:
    """Tasks that are to be done, and those that are to be done again."""

    def __init__(self, tasks: Iterable[Task], failures: list[Failure]) -> None:
        self._coming, self._failures = iter(tasks), failures
        self._again, self._alone = deque[Task](), deque[Task]()
        self._one_is_alone = False
        self._tries = Counter[int]()

    def take(self, idle: bool) -> Task | None:
        """Return the next task, if one may begin now: some begin only while the workers do nothing else."""
        if not idle and (self._alone or self._one_is_alone):
            return None
        self._one_is_alone = bool(self._alone)
        if self._alone:
            return self._alone.popleft()
        return self._again.popleft() if self._again else next(self._coming, None)

    def put_back(self, task: Task, error: BaseException) -> None:
        """Count a try that failed; it will be done again, unless that was the last try."""
        if not self._is_last_try(task[0], error):
            self._again.append(task)

    def put_back_lost(self, tasks: list[Task], error: BaseException) -> None:
        """Count a try of tasks whose worker died; where it is not known which of them killed it, none is given up."""
        if len(tasks) == 1 and self._is_last_try(tasks[0][0], error):
            return
        for number, _ in tasks if len(tasks) > 1 else ():
            self._tries[number] = min(self._tries[number] + 1, MOST_TRIES - 1)
        self._alone += tasks

    def _is_last_try(self, number: int, error: BaseException) -> bool:
        self._tries[number] += 1
        if self._tries[number] < MOST_TRIES:
            return False
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        self._failures.append(Failure(number, reason[:REASON_LENGTH]))
        return True


class Engine(ABC):
    """Workers that do tasks.

    Attributes
    ----------
    most_in_flight : int
        Most tasks that are handed out at the same time, so that no worker waits.
    gone : str
        What has happened when tasks are cancelled that were not cancelled here.
    failures : list of Failure
        Tasks that were given up.
    """

    most_in_flight: int
    gone = "the workers are gone"

    def __init__(self) -> None:
        self.failures: list[Failure] = []

    @abstractmethod
    def submit(self, task: Arrays) -> "Future[Any]":
        """Hand a task to a worker.

        Raises
        ------
        LostError, BrokenExecutor
        """

    def read(self, answer: Any) -> Arrays:
        """Return the answer that a worker gave, as it is."""
        found: Arrays = answer
        return found

    def restart(self) -> None:
        """Begin anew after workers died; tasks in flight are forgotten.

        Raises
        ------
        LostError
            When this engine cannot.
        """
        raise LostError("the executor broke: a worker died")

    @abstractmethod
    def close(self, now: bool) -> None:
        """End; with `now`, do not wait for tasks in flight."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """End; what was interrupted, or went wrong, ends now."""
        self.close(now=kind is not None)

    def run(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """Yield the answers to tasks with their numbers, as they come; what is given up is in `failures`.

        A worker that dies takes all tasks in flight with it, and it is not known which of them killed it. So each of
        these is tried again alone: what fails alone is to blame.

        Parameters
        ----------
        tasks : iterable of Task
            Read when they are handed out, so that only those in flight are in memory.

        Raises
        ------
        LostError
            When the workers are gone.
        """
        queue, in_flight = _Queue(tasks, self.failures), dict[Future[Any], Task]()
        while True:
            died, lost = None, list[Task]()
            try:
                while len(in_flight) < self.most_in_flight and (task := queue.take(idle=not in_flight)) is not None:
                    lost = [task]
                    in_flight[self.submit(task[1])] = task
                lost = []
            except BrokenExecutor as error:
                died = error
            if not in_flight and died is None:
                return
            for future in wait(in_flight, return_when=FIRST_COMPLETED).done:
                task = in_flight.pop(future)
                try:
                    answer = self.read(future.result())
                except BrokenExecutor as error:
                    died, lost = error, [*lost, task]
                except CancelledError:
                    raise LostError(self.gone) from None
                except Exception as error:
                    queue.put_back(task, error)
                else:
                    yield task[0], answer
            if died is not None:
                self.restart()
                queue.put_back_lost([*lost, *in_flight.values()], died)
                in_flight.clear()

    def results(self, tasks: Iterable[Arrays], undone: str) -> list[Arrays]:
        """Return the answers to tasks, in their order.

        Raises
        ------
        UnfinishedError
            When one of them failed three times, which the text `undone` says.
        LostError
            When the workers are gone.
        """
        found = dict(self.run(enumerate(tasks)))
        if self.failures:
            raise UnfinishedError(f"{undone}: {self.failures[0].reason}")
        return [found[number] for number in sorted(found)]
