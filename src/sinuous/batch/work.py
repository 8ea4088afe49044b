"""What a worker does with a chunk: the rows that are targets are solved, the others are said to be none."""

import re
from typing import NamedTuple

import numpy as np

from sinuous.batch.neighbours import halves
from sinuous.batch.tables.blocks import INVALID, Block, Layout
from sinuous.batch.tables.source import Raw
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.target import GoalArrays, Goals
from sinuous.solving.solver import Solver


class Task(NamedTuple):
    """A chunk.

    Attributes
    ----------
    number : int
    first : int
        Its first row, 0 = first of all.
    raw : dict
        Rows by the names of `GoalArrays`, not checked yet.
    """

    number: int
    first: int
    raw: Raw


class Work:
    """Solves chunks; may be pickled and sent to workers.

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

    def prepare(self) -> "Work":
        """Compile, or load, what solving needs."""
        self._solver.solve_many(positions=np.empty((0, 3)), initial=self._initial, workers=1)
        return self

    def __call__(self, task: Task) -> Block:
        """Solve a chunk in this thread alone."""
        count = len(next(iter(task.raw.values())))
        block = self.layout.nothing(task.first, count, INVALID)
        rows, goals = valid(task.raw)
        if not len(rows):
            return block
        early, late, near = halves(goals) if self._warm else (np.arange(len(rows)), rows[:0], rows[:0])
        found = self._solver.solve_many(initial=self._initial, workers=1, **_arrays(goals, early))
        self.layout.fill(block, rows[early], found, self._solver.robot)
        if len(late):
            found = self._solver.solve_many(initial=found.q[near], workers=1, **_arrays(goals, late))
            self.layout.fill(block, rows[late], found, self._solver.robot)
        return block


def valid(raw: Raw) -> tuple[np.ndarray, Goals]:
    """Find the rows (k,) that are targets, and check them."""
    good = np.logical_and.reduce([np.isfinite(part).reshape(len(part), -1).all(axis=1) for part in raw.values()])
    while True:
        rows = np.flatnonzero(good)
        try:
            return rows, Goals.read({key: part[rows] for key, part in raw.items()})
        except InputError as error:
            bad = re.fullmatch(r"\w+\[(\d+)\]", error.key)  # a row that is named: a direction of length 0, say
            if bad is None:
                raise
            good[rows[int(bad[1])]] = False


def _arrays(goals: Goals, some: np.ndarray) -> GoalArrays:
    chosen = goals[some]
    return {"positions": chosen.positions, "directions": chosen.directions, "rotations": chosen.rotations}
