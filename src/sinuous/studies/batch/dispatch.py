"""Chunks handed to an engine and answers taken back, until every chunk is solved or has failed three times."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from typing import Any

from sinuous.base.errors import InputError, UnfinishedError
from sinuous.studies.batch.batch import Failed
from sinuous.studies.batch.cluster import LOCAL, Dask
from sinuous.studies.batch.engines import Engine, GivenExecutor, LostError, Processes, Threads
from sinuous.studies.batch.tables.layout import Block
from sinuous.studies.batch.work import Chunk

MOST_TRIES = 3
"""How often a chunk is tried before it is given up."""

WHY_LENGTH = 300
"""Letters of the reason why a chunk failed that are kept."""


class Dispatcher:
    """Keeps the workers of an engine busy.

    A worker that dies takes all chunks in flight with it, and it is not known which of them killed it. So each of these
    is tried again alone: what fails alone is to blame.

    Parameters
    ----------
    engine : Engine
    chunks : iterator of Chunk
        Made when they are handed out, so that only those in flight are in memory.
    keep : callable
        Takes the answer to a chunk.

    Attributes
    ----------
    failed : list of Failed
        Chunks that were given up.
    """

    def __init__(self, engine: Engine, chunks: Iterator[Chunk], keep: Callable[[Chunk, Block], None]) -> None:
        self._engine, self._chunks, self._keep = engine, chunks, keep
        self._in_flight: dict[Future[Block], Chunk] = {}
        self._again: deque[Chunk] = deque()
        self._suspects: deque[Chunk] = deque()  # to be tried alone
        self._tries: dict[int, int] = {}
        self.failed: list[Failed] = []

    def run(self) -> None:
        """Have all chunks done.

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
        """Hand out as many chunks as the engine takes; suspects one by one."""
        while len(self._in_flight) < (1 if self._suspects else self._engine.most_in_flight):
            chunk = self._next()
            if chunk is None:
                return
            try:
                self._in_flight[self._engine.submit(chunk)] = chunk
            except BaseException:
                self._again.appendleft(chunk)
                raise

    def _next(self) -> Chunk | None:
        if self._suspects:
            return self._suspects[0] if not self._in_flight else None
        return self._again.popleft() if self._again else next(self._chunks, None)

    def _take(self, future: "Future[Block]") -> None:
        """Take the answer to a chunk, or count a try that failed."""
        chunk = self._in_flight[future]
        try:
            block = future.result()
        except BrokenExecutor:
            raise
        except CancelledError:
            raise LostError(self._engine.gone) from None
        except Exception as error:
            del self._in_flight[future]
            self._clear_of_suspicion(chunk)
            if not self._give_up(chunk, error):
                self._again.append(chunk)
            return
        del self._in_flight[future]
        self._clear_of_suspicion(chunk)
        self._keep(chunk, block)

    def _clear_of_suspicion(self, chunk: Chunk) -> None:
        """A chunk that was tried alone has ended, and its worker is alive."""
        if self._suspects and self._suspects[0] is chunk:
            self._suspects.popleft()

    def _give_up(self, chunk: Chunk, error: BaseException) -> bool:
        """Count a try that failed; return whether it was the last one."""
        self._tries[chunk.number] = self._tries.get(chunk.number, 0) + 1
        if self._tries[chunk.number] < MOST_TRIES:
            return False
        count = len(next(iter(chunk.raw.values())))
        why = f"{type(error).__name__}: {' '.join(str(error).split())}"[:WHY_LENGTH]
        self.failed.append(Failed(chunk.number, chunk.first + 1, chunk.first + count, why))
        return True

    def _restart(self, error: BrokenExecutor) -> None:
        """Begin anew after workers died."""
        self._engine.restart()
        lost = [chunk for future, chunk in self._in_flight.items() if not self._rescued(future, chunk)]
        self._in_flight.clear()
        if self._suspects and lost and self._suspects[0] is lost[0]:  # it was alone, so it killed its worker
            chunk = self._suspects.popleft()
            if not self._give_up(chunk, error):
                self._suspects.append(chunk)
            return
        for chunk in lost:
            self._tries[chunk.number] = self._tries.get(chunk.number, 0) + 1
        self._suspects.extend(lost)

    def _rescued(self, future: "Future[Block]", chunk: Chunk) -> bool:
        """Take an answer that was finished before the workers died."""
        if not future.done() or future.cancelled() or future.exception() is not None:
            return False
        self._clear_of_suspicion(chunk)
        self._keep(chunk, future.result())
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

    def keep(chunk: Chunk, block: Block) -> None:
        found[chunk.number] = block

    dispatcher = Dispatcher(engine, (Chunk(i, i, raw) for i, raw in enumerate(chunks)), keep)
    dispatcher.run()
    if dispatcher.failed:
        raise UnfinishedError(f"{undone}: {dispatcher.failed[0].why}")
    return [found[i] for i in range(len(found))]
