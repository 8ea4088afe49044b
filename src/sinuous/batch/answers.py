"""The answers of a batch beside its targets, a chunk at a time: what they are derived from."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sinuous.arguments import Parameter
from sinuous.batch.tables.kinds import open_source
from sinuous.batch.tables.layout import Block
from sinuous.batch.tables.npz_files import NpzRows
from sinuous.batch.work import Work
from sinuous.errors import InputError

if TYPE_CHECKING:
    from sinuous.derivatives.many import Derivatives

NEEDED = ["status", "q", "clearance"]
"""What a table of results says of answers that are derived."""


@dataclass(frozen=True)
class Answers:
    """Where the answers of a batch are, and what they answer.

    Attributes
    ----------
    work : Work
    targets : path, mapping of arrays, or array_like
    fingerprint : str
        Of the targets that were solved.
    chunk : int
        Rows of a chunk.
    found : Path or dict
        The table of results, or arrays by their names.
    """

    work: Work
    targets: Any
    fingerprint: str
    chunk: int
    found: Path | Block

    def derivatives(self, wrt: tuple[Parameter, ...]) -> "Iterator[Derivatives]":
        """Derive one chunk after the other."""
        with closing(open_source(self.targets)) as source, closing(_rows(self.found)) as rows:
            if source.fingerprint() != self.fingerprint:
                given = str(self.targets) if isinstance(self.targets, Path | str) else "arrays"
                raise InputError("targets", "have changed since they were solved", given, "those of this batch")
            for first in range(0, source.rows, self.chunk):
                span = first, min(source.rows, first + self.chunk)
                yield self.work.derive(source.read(*span), rows.read(*span), wrt)


class _Kept:
    """Results in memory, as `NpzRows` has them."""

    def __init__(self, arrays: Block) -> None:
        self._arrays = arrays

    def read(self, first: int, last: int) -> Block:
        """Return rows `first` to `last`, the end not included."""
        return {name: rows[first:last] for name, rows in self._arrays.items()}

    def close(self) -> None:
        """Nothing is open."""


def _rows(found: Path | Block) -> NpzRows | _Kept:
    if not isinstance(found, Path):
        return _Kept(found)
    if found.suffix.lower() != ".npz":
        raise InputError("out", "cannot be derived", str(found), "results as .npz, or in memory")
    return NpzRows(found, lambda _: NEEDED)
