"""Tasks handed to an engine and answers taken back, until every chunk is solved or has failed three times."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from typing import Any

from sinuous.batch.batch import Failed
from sinuous.batch.cluster import LOCAL, Dask
from sinuous.batch.engines import Engine, GivenExecutor, LostError, Processes, Threads
from sinuous.batch.tables.layout import Block
from sinuous.batch.work import Chunk
from sinuous.errors import InputError, UnfinishedError

MOST_TRIES = 3
"""How often a chunk is tried before it is given up."""

WHY_LENGTH = 300
"""Letters of the reason why a chunk failed that are kept."""


class Dispatcher:
    """Keeps the workers of an engine busy.

    A worker that dies takes all tasks in flight with it, and it is not known which of them killed it. So each of these
    is tried again alone: what fails alone is to blame.

    Parameters
    ----------
    engine : Engine
    tasks : iterator of Task
        Made when they are handed out, so that only those in flight are in memory.
    keep : callable
        Takes the answer to a task.

    Attributes
    ----------
    failed : list of Failed
        Chunks that were given up.
    """

    def __init__(self, engine: Engine, tasks: Iterator[Chunk], keep: Callable[[Chunk, Block], None]) -> None:
        self._engine, self._tasks, self._keep = engine, tasks, keep
        self._in_flight: dict[Future[Block], Chunk] = {}
        self._again: deque[Chunk] = deque()
        self._suspects: deque[Chunk] = deque()  # to be tried alone
        self._tries: dict[int, int] = {}
        self.failed: list[Failed] = []

    def run(self) -> None:
        """Have all tasks done.

        Raises
        ------
        LostError
            When the engine is gone.
        """
        while True:
            try:
                self._hand_out()
                if not self._in_flight:
                    return
                finished, _ = wait(self._in_flight, return_when=FIRST_COMPLETED)
                for future in finished:
                    self._take(future)
            except BrokenExecutor as error:
                self._restart(error)

    def _hand_out(self) -> None:
        """Hand out as many tasks as the engine takes; suspects one by one."""
        while len(self._in_flight) < (1 if self._suspects else self._engine.most_in_flight):
            task = self._next()
            if task is None:
                return
            try:
                self._in_flight[self._engine.submit(task)] = task
            except BaseException:
                self._again.appendleft(task)
                raise

    def _next(self) -> Chunk | None:
        if self._suspects:
            return self._suspects[0] if not self._in_flight else None
        return self._again.popleft() if self._again else next(self._tasks, None)

    def _take(self, future: "Future[Block]") -> None:
        """Take the answer to a task, or count a try that failed."""
        task = self._in_flight[future]
        try:
            block = future.result()
        except BrokenExecutor:
            raise
        except CancelledError:
            raise LostError(self._engine.gone) from None
        except Exception as error:
            del self._in_flight[future]
            self._clear_of_suspicion(task)
            if not self._give_up(task, error):
                self._again.append(task)
            return
        del self._in_flight[future]
        self._clear_of_suspicion(task)
        self._keep(task, block)

    def _clear_of_suspicion(self, task: Chunk) -> None:
        """A task that was tried alone has ended, and its worker is alive."""
        if self._suspects and self._suspects[0] is task:
            self._suspects.popleft()

    def _give_up(self, task: Chunk, error: BaseException) -> bool:
        """Count a try that failed; return whether it was the last one."""
        self._tries[task.number] = self._tries.get(task.number, 0) + 1
        if self._tries[task.number] < MOST_TRIES:
            return False
        count = len(next(iter(task.raw.values())))
        why = f"{type(error).__name__}: {' '.join(str(error).split())}"[:WHY_LENGTH]
        self.failed.append(Failed(task.number, task.first + 1, task.first + count, why))
        return True

    def _restart(self, error: BrokenExecutor) -> None:
        """Begin anew after workers died."""
        self._engine.restart()
        lost = [task for future, task in self._in_flight.items() if not self._rescued(future, task)]
        self._in_flight.clear()
        if self._suspects and lost and self._suspects[0] is lost[0]:  # it was alone, so it killed its worker
            task = self._suspects.popleft()
            if not self._give_up(task, error):
                self._suspects.append(task)
            return
        for task in lost:
            self._tries[task.number] = self._tries.get(task.number, 0) + 1
        self._suspects.extend(lost)

    def _rescued(self, future: "Future[Block]", task: Chunk) -> bool:
        """Take an answer that was finished before the workers died."""
        if not future.done() or future.cancelled() or future.exception() is not None:
            return False
        self._clear_of_suspicion(task)
        self._keep(task, future.result())
        return True


def begin(engine: Any, work: Any, workers: int) -> Engine:
    """Make the engine that is meant ready; `work` need not be a `ChunkSolver`, but has to be like it.

    Raises
    ------
    InputError
        When no engine has this name, a package is missing, or no scheduler answers.
    LostError
        When its workers cannot begin.
    """
    work.prepare()  # compiled once, before several workers ask for it
    if engine == "threads":
        return Threads(work, workers)
    if engine == "processes":
        return Processes(work, workers)
    if engine == "dask":
        return Dask(work, LOCAL, workers)
    if (isinstance(engine, str) and "://" in engine) or type(engine).__module__.partition(".")[0] == "distributed":
        return Dask(work, engine, workers)
    if isinstance(engine, Executor):
        return GivenExecutor(work, engine, workers)
    wanted = "threads, processes, dask, the address of a Dask scheduler, a client of one, or an executor"
    raise InputError("engine", "", engine, wanted)


def all_done(engine: Engine, chunks: Iterable[Block], undone: str) -> list[Block]:
    """Have chunks done by an engine; return what became of each, in their order.

    Raises
    ------
    UnfinishedError
        When one of them failed three times, which the text `undone` says.
    """
    found: dict[int, Block] = {}

    def keep(task: Chunk, block: Block) -> None:
        found[task.number] = block

    dispatcher = Dispatcher(engine, (Chunk(i, i, raw) for i, raw in enumerate(chunks)), keep)
    dispatcher.run()
    if dispatcher.failed:
        raise UnfinishedError(f"{undone}: {dispatcher.failed[0].why}")
    return [found[i] for i in range(len(found))]
