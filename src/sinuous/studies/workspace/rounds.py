"""Solves of one map: all directions at all places, each by itself, then from what was found beside it."""

from collections.abc import Iterator
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.progress import ProgressBar
from sinuous.solver.solver import Solver
from sinuous.studies.runs.checkpoint import Checkpoint
from sinuous.studies.runs.engine import Arrays
from sinuous.studies.workspace.reach import Codes, Verdict, verdicts_of

Numbers = NDArray[np.int64]

CALL_SIZE = 200_000
"""Targets that are solved in one call: it bounds memory, and what is lost when a map is interrupted."""

TRIES = 2
"""Neighbours that a voxel begins from in one direction."""

ROUNDS = 12
"""Most rounds in which what is left begins from neighbours."""

FACES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])


class Calls:
    """Calls of `Solver.solve_many`, numbered in the order in which a map makes them.

    Parameters
    ----------
    workers : int
        Most threads.
    checkpoint : Checkpoint
        Holds the calls that were made, by their numbers.
    """

    def __init__(self, workers: int, checkpoint: Checkpoint) -> None:
        self._workers, self._checkpoint = workers, checkpoint
        self._numbers = count()

    def solve(self, solver: Solver, **goals: Any) -> tuple[Codes, NDArray[np.float32]]:
        """Return the verdicts (m,) of a call, and its configurations (m, n, 3) in single precision."""

        def make() -> Arrays:
            found = solver.solve_many(workers=self._workers, **goals)
            return {"codes": verdicts_of(found), "q": found.q.astype(np.float32)}

        call = self._checkpoint.once(next(self._numbers), make)
        return call["codes"], call["q"]


class MappedPlaces(NamedTuple):
    """Places (m, 3) that are mapped in directions (d, 3), and the numbers (m, 6) of those beside each; -1: none."""

    positions: Floats
    neighbours: Numbers
    directions: Floats


class Rounds:
    """Solves all directions of places by a solver.

    Attributes
    ----------
    codes : ndarray (m, d)
        Verdicts.
    q : ndarray (m d, n, 3)
        The best configurations, in single precision: what neighbours begin from.
    """

    def __init__(self, solver: Solver, places: MappedPlaces, calls: Calls) -> None:
        self._solver, self._places, self._calls = solver, places, calls
        self.codes = np.full((len(places.positions), len(places.directions)), Verdict.NOT_FOUND, np.uint8)
        self.q = np.zeros((self.codes.size, len(solver.robot), 3), np.float32)

    def solve(self, targets: Numbers, initial: NDArray[np.float32] | None, bar: ProgressBar) -> None:
        """Solve targets, numbers (k,) of place and direction together, each by itself or from its own of `initial`."""
        for some in _parts(targets):
            self._solve(some, None if initial is None else initial[some])
            bar.advance(len(some))

    def solve_from_neighbours(self) -> None:
        """Solve what is left from what was found beside it, until nothing more comes of it."""
        tried = np.zeros(self.codes.shape, np.uint8)
        for _ in range(ROUNDS):
            targets, near = self._beside_solved(tried)
            if not len(targets):
                return
            tried.ravel()[targets] += 1
            for some, begun in zip(_parts(targets), _parts(near), strict=True):
                self._solve(some, self.q[begun])

    def _beside_solved(self, tried: NDArray[np.uint8]) -> tuple[Numbers, Numbers]:
        """Targets that are open and may begin from a neighbour, and which neighbour that is."""
        codes, count = self.codes, self.codes.shape[1]
        places, directions = np.nonzero((codes >= Verdict.OBSTACLE) & (tried < TRIES))
        beside = self._places.neighbours[places]
        solved = (beside >= 0) & (codes[beside, directions[:, None]] == Verdict.SOLVED)
        rank = np.cumsum(solved, axis=1) - 1
        wanted = solved & (rank == tried[places, directions][:, None])
        some = wanted.any(axis=1)
        near = beside[some, wanted[some].argmax(axis=1)]
        return places[some] * count + directions[some], near * count + directions[some]

    def _solve(self, targets: Numbers, initial: NDArray[np.float32] | None) -> None:
        place, direction = np.divmod(targets, len(self._places.directions))
        given = None if initial is None else initial.astype(np.float64)
        positions, directions = self._places.positions[place], self._places.directions[direction]
        codes, q = self._calls.solve(self._solver, positions=positions, directions=directions, initial=given)
        flat = self.codes.ravel()
        better = (flat[targets] >= Verdict.OBSTACLE) & ((codes != Verdict.NOT_FOUND) | (flat[targets] > codes))
        flat[targets[better]] = codes[better]
        self.q[targets[better]] = q[better]


def _parts(targets: Numbers) -> Iterator[Numbers]:
    """Yield targets as they are solved together."""
    for first in range(0, len(targets), CALL_SIZE):
        yield targets[first : first + CALL_SIZE]


def neighbours_of(taken: NDArray[np.bool_]) -> Numbers:
    """Numbers (m, 6) of the voxels beside those that are taken, in their order; -1 for none."""
    numbers = np.full(np.array(taken.shape) + 2, -1, np.int64)
    numbers[1:-1, 1:-1, 1:-1][taken] = np.arange(int(taken.sum()))
    at = np.argwhere(taken) + 1
    return np.stack([numbers[tuple((at + step).T)] for step in FACES], axis=-1)
