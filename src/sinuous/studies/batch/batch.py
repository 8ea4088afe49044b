"""What became of all rows of a batch, and the derivatives of its answers.

A chunk is worked at as a whole: its targets are solved, or derived; of other rows it is said that they are none.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solutions import Solutions
from sinuous.base.arguments import Parameter, Rows, Stack
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr
from sinuous.base.parameter_groups import read_tangent
from sinuous.problem.target import TipGoals
from sinuous.problem.target_sets import ManyProblems
from sinuous.solver.many import read_initial
from sinuous.solver.solver import Solver
from sinuous.studies.batch.tables.reading import NpzRows, Raw, open_source
from sinuous.studies.batch.tables.results import INVALID, STATUSES, Layout
from sinuous.studies.runs.engine import Arrays

if TYPE_CHECKING:
    from sinuous.answer.derivatives.many import Derivatives


class ChunkSolver:
    """Solves chunks of rows; may be pickled and sent to workers.

    Parameters
    ----------
    solver : Solver
    initial : ndarray (n, 3), optional
        Where every solve begins.
    """

    def __init__(self, solver: Solver, initial: Floats | None = None) -> None:
        self._solver, self._initial = solver, initial
        self.layout, self.scene = Layout(solver.robot), solver.scene

    def prepare(self) -> "ChunkSolver":
        """Compile, or load, what solving needs."""
        self._solver.solve_many(positions=np.empty((0, 3)), initial=self._initial, workers=1)
        return self

    def __call__(self, raw: Raw) -> Arrays:
        """Solve rows by the names of `GoalArrays`, which are not checked yet, in this thread alone."""
        count = len(next(iter(raw.values())))
        block = self.layout.nothing(0, count, INVALID)
        rows, goals = valid(raw)
        if not len(rows):
            return block
        found = self._solver._solve_sets(goals, self._initial)
        self.layout.fill(block, slice(None) if len(rows) == count else rows, found)
        return block

    def derive(self, raw: Raw, block: Arrays, wrt: tuple[Parameter, ...]) -> "Derivatives":
        """Derive the answers to the rows of a chunk; derivatives of those that are not solved are NaN."""
        solver, (rows, goals) = self._solver, valid(raw)
        answers = self.layout.records(block)
        given = read_initial(solver.robot, len(rows), self._initial)
        asked = ManyProblems(solver.robot, goals, solver.scene.snapshot(), solver.tolerance, given)
        return Solutions(asked, answers[rows], solver._resolver).derivative(wrt).spread(len(answers), rows)


def valid(raw: Raw) -> tuple[NDArray[np.int64], TipGoals]:
    """Find the rows (k,) that are targets, and check them."""
    good = np.ones(len(next(iter(raw.values()))), np.bool_)
    for part in raw.values():
        if not np.isfinite(part).all():  # row by row it takes longer
            good &= np.isfinite(part).reshape(len(part), -1).all(axis=1)
    while True:
        rows = np.flatnonzero(good)
        try:
            return rows, TipGoals.read({key: part if good.all() else part[rows] for key, part in raw.items()})
        except InputError as error:
            if error.row is None:
                raise
            good[rows[error.row[1]]] = False  # a direction of length 0, say


DERIVED_ARRAYS = ["status", "q", "clearance"]
"""What a table of results says of answers that are derived."""

MOST_SHOWN = 10
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


@dataclass(frozen=True)
class Answers:
    """Where the answers of a batch are, and what they answer.

    Attributes
    ----------
    work : ChunkSolver
    targets : path, mapping of arrays, or array_like
    fingerprint : str
        Of the targets that were solved.
    chunk : int
        Rows of a chunk.
    found : Path or dict
        The table of results, or arrays by their names.
    """

    work: ChunkSolver
    targets: Any
    fingerprint: str
    chunk: int
    found: Path | Arrays

    def derivatives(self, wrt: tuple[Parameter, ...]) -> "Iterator[Derivatives]":
        """Derive one chunk after the other."""
        with closing(open_source(self.targets)) as source, _reader(self.found) as read:
            if source.fingerprint() != self.fingerprint:
                given = str(self.targets) if isinstance(self.targets, Path | str) else "arrays"
                raise InputError("targets", "have changed since they were solved", given, "those of this batch")
            for first in range(0, source.rows, self.chunk):
                span = first, min(source.rows, first + self.chunk)
                yield self.work.derive(source.read(*span), read(*span), wrt)


@contextmanager
def _reader(found: Path | Arrays) -> Iterator[Callable[[int, int], Arrays]]:
    """Yield what reads rows of results, from the first up to, without it, the last."""
    if not isinstance(found, Path):
        yield lambda first, last: {name: rows[first:last] for name, rows in found.items()}
        return
    if found.suffix.lower() != ".npz":
        raise InputError("out", "cannot be derived", str(found), "results as .npz, or in memory")
    with closing(NpzRows(found, lambda _: DERIVED_ARRAYS)) as rows:
        yield rows.read


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
    results: Arrays | None = field(default=None)
    _answers: Answers | None = field(default=None)

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

    def derivatives(self, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "Iterator[Derivatives]":
        """Derive all answers, a chunk of rows at a time and in their order, as `Solutions.derivative` does.

        It takes microseconds a row, less than to write derivatives and to read them again; so no table holds them.

        Parameters
        ----------
        wrt : str or sequence of str
            Groups of parameters.

        Yields
        ------
        Derivatives
            Of the rows of a chunk; NaN where a row is not solved, or is no target.

        Raises
        ------
        InputError
            When there is no such group, the results are in another file than `.npz`, shards are missing, or the targets
            have changed.
        """
        from sinuous.answer.derivatives.parameters import read_wrt  # noqa: PLC0415

        if self._answers is None or self.rows < self.total:
            raise InputError("batch", "is not whole", f"{self.rows} of {self.total} rows", "one with all rows")
        return self._answers.derivatives(read_wrt(wrt))

    def vjp(self, cotangent: Stack, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "dict[Parameter, Floats]":
        """Derivatives (m, p) of `sum(cotangent * q)` of each row by each group, for cotangents (m, n, 3).

        Of a robot, a base or obstacles that all rows have in common the sum over the rows counts. An array on disk
        (`numpy.load` with `mmap_mode`) is read a chunk at a time.

        Raises
        ------
        InputError
            As for `derivatives`, or when the cotangents have another shape.
        """
        given = self._by_rows("cotangent", cotangent)
        parts = [part.vjp(given[rows]) for rows, part in self._spans(wrt)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def jvp(self, tangent: Rows | Mapping[Parameter, Rows]) -> Floats:
        """Motions (m, n, 3) of the configurations when the parameters of each row move along tangents (m, p).

        Raises
        ------
        InputError
            As for `derivatives`, or when a tangent has another shape.
        """
        given = read_tangent(tangent, tuple(tangent) if isinstance(tangent, Mapping) else ("target",))
        ways = {name: self._by_rows(f"tangent[{name!r}]", way) for name, way in given.items()}
        spans = self._spans(tuple(ways))
        motions = [part.jvp({name: way[rows] for name, way in ways.items()}) for rows, part in spans]
        return np.concatenate(motions)

    def _spans(self, wrt: Any) -> "Iterator[tuple[slice, Derivatives]]":
        """Rows of each chunk, and the derivatives of their answers."""
        first = 0
        for part in self.derivatives(wrt):
            yield slice(first, first + len(part)), part
            first += len(part)

    def _by_rows(self, key: str, value: Any) -> NDArray[Any]:
        """An array with a row for each of the batch; what is on disk stays there."""
        try:
            given = np.asanyarray(value)
        except ValueError:
            raise InputError(key, "", value, "an array of numbers") from None
        if given.shape[:1] != (self.total,):
            raise InputError(key, "", f"shape {given.shape}", f"one for each row: {self.total}")
        return given

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, without the results."""
        return result_of(self, "file rows total before counts invalid failed seconds")

    def _shown(self) -> Iterator[str]:
        yield f"{self.rows:,} rows"
        yield from (f"{count:,} {name}" for name, count in self.counts.items())

    def __str__(self) -> str:
        ended = ", ".join(f"{count:,} {name}" for name, count in self.counts.items())
        done = f"{self.rows:,} rows" if self.rows == self.total else f"{self.rows:,} of {self.total:,} rows"
        parts = [f"Batch: {done}{': ' if ended else ''}{ended}"]
        if self.counts.get(INVALID):
            numbers = ", ".join(map(str, self.invalid[:MOST_SHOWN]))
            more = ", ..." if self.counts[INVALID] > MOST_SHOWN else ""
            parts.append(f"  invalid    rows {numbers}{more}")
        parts += [f"  skipped    rows {each.first} to {each.last}: {each.why}" for each in self.failed]
        if self.rows > self.before:
            parts.append(f"  effort     {self.seconds:.3g} s, {self.rate:,.0f} rows a second")
        if self.before:
            parts.append(f"  before     {self.before:,} rows were done by an earlier call")
        if self.file is not None and self.rows == self.total:
            parts.append(f"  results    {self.file}")
        return "\n".join(parts)
