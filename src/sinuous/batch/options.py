"""How a batch is run: chunks, engine, workers, shard; all are checked as they come in."""

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypedDict

from sinuous import checks
from sinuous.arguments import Rows, Truth, Whole
from sinuous.errors import InputError
from sinuous.solving.many import read_workers
from sinuous.solving.options import SolveArguments

CHUNK, MOST_CHUNK = 10_000, 10_000_000

MOST_SHARDS = 1_000_000

Shard = tuple[int, int]


class RunArguments(TypedDict, total=False):
    """How a batch is run, as keyword arguments; see `RunOptions`."""

    initial: Rows | None
    warm: Truth
    chunk: Whole
    engine: "str | Executor | Any"
    workers: Whole | None
    shard: Shard | None
    progress: Truth


class BatchArguments(SolveArguments, RunArguments, total=False):
    """Options of `solve_batch` as keyword arguments."""


@dataclass(frozen=True)
class RunOptions:
    """How a batch is run.

    Attributes
    ----------
    initial : array_like (n, 3), optional
        Where every solve begins.
    warm : bool
        Whether seven of eight targets begin from the solution of a near target of the same chunk.
    chunk : int
        Rows of a chunk.
    engine : str, Executor or Client
    workers : int
    shard : (int, int), optional
        Which part of how many, 1 = first.
    progress : bool
    """

    initial: Any = None
    warm: bool = False
    chunk: int = CHUNK
    engine: Any = "threads"
    workers: int | None = None
    shard: Shard | None = None
    progress: bool = False

    def __post_init__(self) -> None:
        values = {
            "warm": checks.truth("warm", self.warm),
            "chunk": checks.integer("chunk", self.chunk, 1, MOST_CHUNK),
            "workers": read_workers(self.workers),
            "shard": None if self.shard is None else _shard(self.shard),
            "progress": checks.truth("progress", self.progress),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def own(self, number: int) -> bool:
        """Whether a chunk belongs to this shard."""
        return self.shard is None or number % self.shard[1] == self.shard[0] - 1


def _shard(value: Any) -> Shard:
    wanted = "two whole numbers (I, N), I from 1 to N"
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError("shard", "", value, wanted)
    count = checks.integer("shard", value[1], 1, MOST_SHARDS)
    return checks.integer("shard", value[0], 1, count), count
