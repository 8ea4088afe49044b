"""Every direction of every voxel, solved in rounds: each by itself, then what is left from neighbours.

Measured, the single arc that a solve begins with is as good a start as the solution of a neighbour, so that all are
tried from it first; neighbours help where it fails. A round depends only on the rounds before it, and so on nothing
that threads do: the calls of a solver always come in the same order, and a checkpoint may hold those that were made.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.batch.checkpoint import Checkpoint
from sinuous.checks import Floats
from sinuous.progress import ProgressBar
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.solver import Solver
from sinuous.workspace.verdicts import Codes, Verdict, verdicts_of

Whole = NDArray[np.int64]

TOGETHER = 200_000
"""Questions that are solved in one call: it bounds memory, and what is lost when a map is interrupted."""

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
    checkpoint : Checkpoint, optional
        Holds the calls that were made, by their numbers.
    """

    def __init__(self, workers: int, checkpoint: Checkpoint | None = None) -> None:
        self._workers, self._checkpoint = workers, checkpoint
        self._made = set[int]() if checkpoint is None else set(checkpoint.done())
        self._next = 0

    def solve(self, solver: Solver, **goals: Any) -> tuple[Codes, NDArray[np.float32]]:
        """Return the verdicts (m,) of a call, and its configurations (m, n, 3) in single precision."""
        number, self._next = self._next, self._next + 1
        if self._checkpoint is not None and number in self._made:
            call = self._checkpoint.read(number)
            return call["codes"], call["q"]
        found = solver.solve_many(workers=self._workers, **goals)
        codes, q = verdicts_of(found), found.q.astype(np.float32)
        if self._checkpoint is not None:
            self._checkpoint.write(number, {"codes": codes, "q": q})
        return codes, q


class Answers(NamedTuple):
    """What was found for places (m, 3) in directions (d, 3).

    Attributes
    ----------
    codes : ndarray (m, d)
        Verdicts.
    q : ndarray (m, d, n, 3)
        The best configurations, in single precision: what neighbours begin from.
    """

    codes: Codes
    q: NDArray[np.float32]


class Work(NamedTuple):
    """What is to be found out of a robot in a scene.

    Attributes
    ----------
    robot : Robot
    scene : Snapshot
    places : ndarray (m, 3)
    neighbours : ndarray (m, 6)
        Numbers of the places beside each, -1 where there is none.
    directions : ndarray (d, 3)
    calls : Calls
    """

    robot: Robot
    scene: Snapshot
    places: Floats
    neighbours: Whole
    directions: Floats
    calls: Calls


class Rounds:
    """Solves all directions of places by a solver."""

    def __init__(self, solver: Solver, work: Work) -> None:
        self._solver, self._work = solver, work
        shape = len(work.places), len(work.directions)
        self.answers = Answers(
            np.full(shape, Verdict.NOT_FOUND, np.uint8), np.zeros((*shape, len(solver.robot), 3), np.float32)
        )

    def begin(self, asked: Whole, initial: NDArray[np.float32] | None, bar: ProgressBar) -> None:
        """Solve some questions, numbers (k,) of place and direction together, each by itself or from its own."""
        for first in range(0, len(asked), TOGETHER):
            some = asked[first : first + TOGETHER]
            self._solve(some, None if initial is None else initial[some])
            bar.advance(len(some))

    def from_neighbours(self) -> None:
        """Solve what is left from what was found beside it, until nothing more comes of it."""
        codes = self.answers.codes
        tried = np.zeros(codes.shape, np.uint8)
        for _ in range(ROUNDS):
            asked, begun = self._candidates(tried)
            if not len(asked):
                return
            tried.ravel()[asked] += 1
            for first in range(0, len(asked), TOGETHER):
                some = slice(first, first + TOGETHER)
                self._solve(asked[some], self._flat_q[begun[some]])

    @property
    def _flat_q(self) -> NDArray[np.float32]:
        q = self.answers.q
        return q.reshape(-1, *q.shape[2:])

    def _candidates(self, tried: NDArray[np.uint8]) -> tuple[Whole, Whole]:
        """Questions that are open and may begin from a neighbour, and which neighbour that is."""
        codes = self.answers.codes
        count = codes.shape[1]
        places, directions = np.nonzero((codes >= Verdict.OBSTACLE) & (tried < TRIES))
        beside = self._work.neighbours[places]
        solved = (beside >= 0) & (codes[beside, directions[:, None]] == Verdict.SOLVED)
        rank = np.cumsum(solved, axis=1) - 1
        wanted = solved & (rank == tried[places, directions][:, None])
        some = wanted.any(axis=1)
        near = beside[some, wanted[some].argmax(axis=1)]
        return places[some] * count + directions[some], near * count + directions[some]

    def _solve(self, asked: Whole, initial: NDArray[np.float32] | None) -> None:
        place, direction = np.divmod(asked, len(self._work.directions))
        given = None if initial is None else initial.astype(np.float64)
        places, directions = self._work.places[place], self._work.directions[direction]
        codes, q = self._work.calls.solve(self._solver, positions=places, directions=directions, initial=given)
        flat = self.answers.codes.ravel()
        better = (flat[asked] >= Verdict.OBSTACLE) & ((codes != Verdict.NOT_FOUND) | (flat[asked] > codes))
        flat[asked[better]] = codes[better]
        self._flat_q[asked[better]] = q[better]


def neighbours_of(taken: NDArray[np.bool_]) -> Whole:
    """Numbers (m, 6) of the voxels beside those that are taken, in their order; -1 for none."""
    numbers = np.full(np.array(taken.shape) + 2, -1, np.int64)
    numbers[1:-1, 1:-1, 1:-1][taken] = np.arange(int(taken.sum()))
    at = np.argwhere(taken) + 1
    return np.stack([numbers[tuple((at + step).T)] for step in FACES], axis=-1)
