"""What becomes of a chunk: targets are solved, or derived; of other rows it is said that they are none."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solutions import Solutions
from sinuous.base.arguments import Parameter
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.problem.target import TipGoals
from sinuous.problem.target_sets import ManyProblems
from sinuous.solver.many import read_initial
from sinuous.solver.solver import Solver
from sinuous.studies.batch.tables.reading import Raw
from sinuous.studies.batch.tables.results import INVALID, Layout
from sinuous.studies.runs.engine import Arrays

if TYPE_CHECKING:
    from sinuous.answer.derivatives.many import Derivatives

Whole = NDArray[np.int64]

CURVE_BITS = 6
"""Bits of each coordinate along the Z-order curve: up to nine coordinates fit into one whole number."""

RUN_LENGTH = 8
"""Neighbours along the curve of which the first is solved by itself, and the others from its solution."""


class ChunkSolver:
    """Solves chunks of rows; may be pickled and sent to workers.

    Parameters
    ----------
    solver : Solver
    initial : ndarray (n, 3), optional
        Where every solve begins.
    warm : bool
        Whether solves begin from the solution of a near target of the same chunk, see `halves`.
    """

    def __init__(self, solver: Solver, initial: Floats | None = None, warm: bool = False) -> None:
        self._solver, self._initial, self._warm = solver, initial, warm
        self.layout, self.scene = Layout.of(solver.robot), solver.scene

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
        for part, initial in self._parts(goals, block, rows):
            found, own = self._solver._solve_sets(goals[part], initial), rows[part]
            self.layout.fill(block, slice(None) if len(own) == count else own, found, self._solver.robot)
        return block

    def derive(self, raw: Raw, block: Arrays, wrt: tuple[Parameter, ...]) -> "Derivatives":
        """Derive the answers to the rows of a chunk; derivatives of those that are not solved are NaN."""
        from sinuous.answer.derivatives.many import Derivatives  # noqa: PLC0415

        solver, (rows, goals) = self._solver, valid(raw)
        answers, derived = self.layout.records(block, solver.robot), []
        for part, initial in self._parts(goals, block, rows):
            own = rows[part]
            given = read_initial(solver.robot, len(own), initial)
            asked = ManyProblems(solver.robot, goals[part], solver.scene.snapshot(), solver.tolerance, given)
            derived.append((own, Solutions(asked, answers[own], solver._resolver).derivative(wrt)))
        return Derivatives.of_parts(len(answers), derived)

    def _parts(self, goals: TipGoals, block: Arrays, rows: Whole) -> Iterator[tuple[Whole | slice, Floats | None]]:
        """Which targets are solved first, then which others; and where these solves begin.

        `block` holds the answers of the chunk, and `rows` says which of them are those of targets.
        """
        if not self._warm or not len(goals):
            yield slice(None), self._initial
            return
        early, late, near = halves(goals)
        yield early, self._initial
        if len(late):
            yield late, self.layout.configurations(block, self._solver.robot)[rows[early[near]]]


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


def halves(goals: TipGoals) -> tuple[Whole, Whole, Whole]:
    """Divide targets into those that are solved first and those that begin from one of these.

    Neighbours are found along a Z-order curve (Morton 1966) over positions and columns of rotations.

    Returns
    -------
    early, late : ndarray of int
        Numbers of targets; together all of them.
    near : ndarray of int
        For each of `late`, the place in `early` of the one that it begins from.
    """
    order = np.argsort(_codes(_features(goals)), kind="stable")
    places = np.arange(len(order))
    first = places % RUN_LENGTH == 0
    return order[first], order[~first], places[~first] // RUN_LENGTH


def _features(goals: TipGoals) -> Floats:
    """Numbers (m, k) that are close to each other where targets are: positions, and columns of the rotation."""
    turns = None if goals.rotations is None else goals.rotations[:, :, ::2].reshape(len(goals), -1)
    return np.concatenate([part for part in (goals.positions, goals.directions, turns) if part is not None], axis=1)


def _codes(features: Floats) -> NDArray[np.uint64]:
    """Places (m,) along the curve: the bits of all coordinates in turn."""
    low, extent = features.min(axis=0), np.ptp(features, axis=0)
    cells = ((features - low) / np.where(extent > 0.0, extent, 1.0) * (2**CURVE_BITS - 1)).astype(np.uint64)
    count = cells.shape[1]
    codes = np.zeros(len(cells), np.uint64)
    for bit in range(CURVE_BITS):
        for k in range(count):
            codes |= ((cells[:, k] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(bit * count + k)
    return codes
