"""The summary of a batch: how many rows ended how, which were no targets, which were skipped, where the results are."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.batch.tables.layout import INVALID, STATUSES, Block
from sinuous.reprs import ShortRepr

SHOWN = 10
"""Rows without a target whose numbers are printed."""


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


@dataclass(frozen=True, eq=False, repr=False)
class Batch(ShortRepr):
    """The summary of a batch.

    Attributes
    ----------
    file : Path or None
        The table of results.
    rows : int
        How many rows are done.
    counts : dict
        How many rows ended how: statuses of `Solution`, `invalid` (no target), `skipped` (their chunk failed three
        times).
    invalid : tuple of int
        Numbers of the rows that are no targets, 1 = first; at most the first thousand.
    failed : tuple of Failed
        Chunks that were given up.
    seconds : float
        Duration of this call.
    before : int
        Rows that an earlier call had done.
    total : int
        Number of all rows; greater than `rows` after a shard.
    results : dict or None
        Without a file: arrays over all rows by name: `q` (m, n, 3), `status` (m,), see `words`, and the others.
    """

    file: Path | None
    rows: int
    counts: Mapping[str, int]
    invalid: tuple[int, ...]
    failed: tuple[Failed, ...]
    seconds: float
    before: int
    total: int
    results: Block | None = field(default=None)

    words = STATUSES
    """The status that each number in `status` stands for."""

    @property
    def solved(self) -> bool:
        """Whether every row is solved."""
        return self.counts.get("solved", 0) == self.total

    @property
    def rate(self) -> float:
        """Rows a second of this call."""
        return (self.rows - self.before) / self.seconds if self.seconds > 0.0 else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, without the results."""
        return {
            "file": None if self.file is None else str(self.file),
            "rows": self.rows,
            "total": self.total,
            "before": self.before,
            "counts": dict(self.counts),
            "invalid": list(self.invalid),
            "failed": [each._asdict() for each in self.failed],
            "seconds": self.seconds,
        }

    def _shown(self) -> Iterator[str]:
        yield f"{self.rows:,} rows"
        yield from (f"{count:,} {name}" for name, count in self.counts.items())

    def __str__(self) -> str:
        ended = ", ".join(f"{count:,} {name}" for name, count in self.counts.items())
        done = f"{self.rows:,} rows" if self.rows == self.total else f"{self.rows:,} of {self.total:,} rows"
        parts = [f"Batch: {done}{': ' if ended else ''}{ended}"]
        if self.counts.get(INVALID):
            numbers = ", ".join(map(str, self.invalid[:SHOWN]))
            more = ", ..." if self.counts[INVALID] > SHOWN else ""
            parts.append(f"  no targets rows {numbers}{more}")
        parts += [f"  skipped    rows {each.first} to {each.last}: {each.why}" for each in self.failed]
        if self.rows > self.before:
            parts.append(f"  effort     {self.seconds:.3g} s, {self.rate:,.0f} rows a second")
        if self.before:
            parts.append(f"  before     {self.before:,} rows were done by an earlier call")
        if self.file is not None and self.rows == self.total:
            parts.append(f"  results    {self.file}")
        return "\n".join(parts)
