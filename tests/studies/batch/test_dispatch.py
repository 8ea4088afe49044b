"""A chunk that fails is tried three times, one that kills its worker takes no other with it."""

from collections import Counter
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from sinuous.studies.batch.dispatch import MOST_TRIES, Dispatcher
from sinuous.studies.batch.engines import Engine, GivenExecutor, LostError, Processes, Threads
from sinuous.studies.batch.tables.layout import Block
from sinuous.studies.batch.work import Chunk
from tests.studies.batch.poison import Poisonous
from tests.studies.batch.questions import points

CHUNKS, ROWS = 7, 5


def chunks() -> Iterator[Chunk]:
    for number in range(CHUNKS):
        yield Chunk(number, number * ROWS, {"positions": points(CHUNKS * ROWS)[number * ROWS : (number + 1) * ROWS]})


def dispatch(engine: Engine) -> tuple[Dispatcher, list[int]]:
    kept: list[int] = []
    dispatcher = Dispatcher(engine, chunks(), lambda chunk, block: kept.append(chunk.number))
    try:
        dispatcher.run()
    finally:
        engine.close(now=False)
    return dispatcher, kept


def tried(folder: Path) -> Counter[int]:
    return Counter(map(int, (folder / "tried").read_text(encoding="utf-8").split()))


def test_a_chunk_that_fails_is_tried_three_times_and_reported(tmp_path: Path) -> None:
    dispatcher, kept = dispatch(Threads(Poisonous(tmp_path, raising=2), 2))
    (failed,) = dispatcher.failed
    assert (failed.number, failed.first, failed.last) == (2, 11, 15)
    assert failed.why == "RuntimeError: as asked"
    assert sorted(kept) == [0, 1, 3, 4, 5, 6]
    assert tried(tmp_path)[2] == MOST_TRIES


def test_workers_that_die_are_replaced_and_only_the_guilty_chunk_is_given_up(tmp_path: Path) -> None:
    dispatcher, kept = dispatch(Processes(Poisonous(tmp_path, killing=1, unlucky=4), 2))
    (failed,) = dispatcher.failed
    assert failed.number == 1
    assert "process" in failed.why
    assert sorted(kept) == [0, 2, 3, 4, 5, 6]  # nothing lost, nothing twice
    assert tried(tmp_path)[1] <= MOST_TRIES
    assert max(tried(tmp_path).values()) <= MOST_TRIES


class Brittle(Executor):
    """Breaks with its third chunk."""

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


def test_an_executor_that_breaks_is_not_ours_to_mend(tmp_path: Path) -> None:
    with pytest.raises(LostError, match="broke"):
        dispatch(GivenExecutor(Poisonous(tmp_path), Brittle(), 1))


def test_an_executor_that_takes_no_more_is_lost(tmp_path: Path) -> None:
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(LostError, match="takes no more"):
        dispatch(GivenExecutor(Poisonous(tmp_path), pool, 1))


def test_what_cannot_be_kept_ends_it(tmp_path: Path) -> None:
    def keep(chunk: Chunk, block: Block) -> None:
        raise OSError(28, "No space left on device")

    engine = Threads(Poisonous(tmp_path), 2)
    with pytest.raises(OSError, match="No space"):
        Dispatcher(engine, chunks(), keep).run()
    engine.close(now=True)
