"""Chunks given out and taken back, until all are answered or have failed three times."""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from typing import NamedTuple

from sinuous.batch.engines.engine import Engine, LostError
from sinuous.batch.tables.blocks import Block
from sinuous.batch.work import Task

TRIES = 3
"""How often a chunk is tried."""


class Failed(NamedTuple):
    """A chunk that was given up.

    Attributes
    ----------
    number, first, last : int
        Its number, and its rows, 1 = first of all.
    why : str
        What its last try ended with.
    """

    number: int
    first: int
    last: int
    why: str


class Conductor:
    """Keeps an engine busy.

    A worker that dies takes all chunks with it that were given out, and nobody knows which of them killed it. So each
    of these is tried again alone: only what fails alone is to blame.

    Parameters
    ----------
    engine : Engine
    tasks : iterator of Task
        Made when they are given out, so that no more of them are in memory than are in hand.
    keep : callable
        Takes what was found.
    """

    def __init__(self, engine: Engine, tasks: Iterator[Task], keep: Callable[[Task, Block], None]) -> None:
        self._engine, self._tasks, self._keep = engine, tasks, keep
        self._given: dict[Future[Block], Task] = {}
        self._again: deque[Task] = deque()
        self._alone: deque[Task] = deque()
        self._tries: dict[int, int] = {}
        self.failed: list[Failed] = []

    def run(self) -> None:
        """Do all.

        Raises
        ------
        LostError
            When the engine is gone.
        """
        while True:
            try:
                self._give()
                if not self._given:
                    return
                finished, _ = wait(self._given, return_when=FIRST_COMPLETED)
                for future in finished:
                    self._take(future)
            except BrokenExecutor as error:
                self._mend(error)

    def _give(self) -> None:
        """Give out as many chunks as the engine takes; suspects one by one."""
        while len(self._given) < (1 if self._alone else self._engine.hands):
            task = self._next()
            if task is None:
                return
            try:
                self._given[self._engine.submit(task)] = task
            except BaseException:
                self._again.appendleft(task)
                raise

    def _next(self) -> Task | None:
        if self._alone:
            return self._alone[0] if not self._given else None
        return self._again.popleft() if self._again else next(self._tasks, None)

    def _take(self, future: "Future[Block]") -> None:
        task = self._given[future]
        try:
            block = future.result()
        except BrokenExecutor:
            raise
        except CancelledError:
            raise LostError(self._engine.gone) from None
        except Exception as error:
            del self._given[future]
            self._settle(task)
            self._blame(task, error)
            return
        del self._given[future]
        self._settle(task)
        self._keep(task, block)

    def _settle(self, task: Task) -> None:
        """Of a chunk that was tried alone it is known what becomes of it."""
        if self._alone and self._alone[0] is task:
            self._alone.popleft()

    def _blame(self, task: Task, error: BaseException) -> None:
        """Count a try that failed."""
        self._tries[task.number] = self._tries.get(task.number, 0) + 1
        if self._tries[task.number] < TRIES:
            self._again.append(task)
            return
        count = len(next(iter(task.raw.values())))
        why = f"{type(error).__name__}: {' '.join(str(error).split())}"[:300]
        self.failed.append(Failed(task.number, task.first + 1, task.first + count, why))

    def _mend(self, error: BrokenExecutor) -> None:
        """Begin anew after workers died."""
        self._engine.mend()
        lost = [task for future, task in self._given.items() if not self._rescued(future, task)]
        self._given.clear()
        if self._alone and lost and self._alone[0] is lost[0]:
            self._blame_alone(error)
            return
        for task in lost:
            self._tries[task.number] = self._tries.get(task.number, 0) + 1
        self._alone.extend(lost)

    def _rescued(self, future: "Future[Block]", task: Task) -> bool:
        """Take what was finished before the others died."""
        if not future.done() or future.cancelled() or future.exception() is not None:
            return False
        self._settle(task)
        self._keep(task, future.result())
        return True

    def _blame_alone(self, error: BrokenExecutor) -> None:
        """A chunk that was alone has killed its worker: it stays alone, or is given up."""
        task = self._alone.popleft()
        before = len(self.failed)
        self._blame(task, error)
        if len(self.failed) == before:
            self._again.remove(task)
            self._alone.append(task)
