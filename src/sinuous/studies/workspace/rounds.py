"""Solves of one map: all directions at all places, each by itself, then from what was found beside it."""

import math
from collections.abc import Iterator
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.progress import ProgressBar
from sinuous.problem.target import Tolerance
from sinuous.solver.certificates.steps import LoadedShapes
from sinuous.solver.solver import Solver
from sinuous.statics.equilibrium import longest_body
from sinuous.studies.runs.checkpoint import Checkpoint
from sinuous.studies.runs.engine import Arrays
from sinuous.studies.workspace.reach import Codes, Verdict, verdicts_of

Numbers = NDArray[np.int64]

Shapes = NDArray[np.float32]
"""Configurations, in single precision: what others begin from."""

CALL_SIZE = 20_000
"""Targets that are solved in one call: it bounds what is lost when a map is interrupted, and how seldom it is told."""

EDGE, RING, RING_COUNT = 0.95, 0.7, 6
"""Shares of the half-angle of a cone at which directions are tried, beside the tangent and all round; how many."""

CONE_SLACK = 1e-6
"""What rounding to single precision may turn a tangent by, rad."""

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

    def solve(self, solver: Solver, **goals: Any) -> tuple[Codes, Shapes]:
        """Return the verdicts (m,) of a call, and its configurations (m, n, 3) in single precision."""

        def make() -> Arrays:
            found = solver.solve_many(workers=self._workers, **goals)
            return {"codes": verdicts_of(found), "q": found.q.astype(np.float32)}

        call = self._checkpoint.once(next(self._numbers), make)
        return call["codes"], call["q"]


class MappedPlaces(NamedTuple):
    """Places (m, 3) that are mapped, and the numbers (m, 6) of those beside each; -1: none."""

    positions: Floats
    neighbours: Numbers


class PlaceQuery:
    """What is asked of each place: its position alone, or each of some directions, exactly or within an angle.

    Parameters
    ----------
    solver : Solver
    axes : ndarray (d, 3)
        Directions; none for positions alone.
    within : float, optional
        How far the tangent may be off a direction, rad.

    Attributes
    ----------
    count : int
        How many targets a place has.
    """

    def __init__(self, solver: Solver, axes: Floats, within: float | None) -> None:
        self._solver, self._axes, self._within = solver, axes, within
        self.count = max(1, len(axes))
        if within is not None:
            tolerance = Tolerance(solver.tolerance.position, within)
            self._wide = Solver(solver.robot, solver.scene, **{**vars(solver.options), "tolerance": tolerance})
            self._loaded = LoadedShapes(solver.robot) if solver.robot.has_external_load else None

    def solve(self, calls: Calls, positions: Floats, which: Numbers, initial: Floats | None) -> tuple[Codes, Shapes]:
        """Return verdicts (k,) and shapes (k, n, 3) of positions (k, 3) in directions (k,) of these numbers."""
        if not len(self._axes):
            return calls.solve(self._solver, positions=positions, initial=initial)
        axes = self._axes[which]
        if self._within is None:
            return calls.solve(self._solver, positions=positions, directions=axes, initial=initial)
        return self._solve_cones(calls, positions, axes, initial)

    def _solve_cones(
        self, calls: Calls, positions: Floats, axes: Floats, initial: Floats | None
    ) -> tuple[Codes, Shapes]:
        """Try the axis of a cone, then positions alone from what came of it, then directions within the cone.

        A solve weighs a direction against the position, however wide its tolerance. So it may end beside a position
        that is within reach, and solves of the position alone, which begin there, end with nearly the same tangent.
        """
        assert self._within is not None
        within = self._within
        codes, q = calls.solve(self._wide, positions=positions, directions=axes, initial=initial)
        begun = [q] if initial is None else [initial.astype(np.float32), q]
        tangents = axes.copy()

        def take(left: Numbers, found: Codes, shapes: Shapes) -> None:
            own = self._tangents(shapes)
            near = (own * axes[left]).sum(axis=-1) > math.cos(max(0.0, within - CONE_SLACK))
            good = (found == Verdict.SOLVED) & near
            codes[left[good]], q[left[good]] = Verdict.SOLVED, shapes[good]
            tangents[left[found == Verdict.SOLVED]] = own[found == Verdict.SOLVED]

        for start in begun:
            left = np.flatnonzero(codes >= Verdict.OBSTACLE)
            take(left, *calls.solve(self._solver, positions=positions[left], initial=start[left].astype(np.float64)))
        for share, turn in ((EDGE, None), *((RING, k * math.tau / RING_COUNT) for k in range(RING_COUNT))):
            left = np.flatnonzero(codes >= Verdict.OBSTACLE)
            aims = _aside(axes[left], tangents[left], share * within, turn)
            given = q[left].astype(np.float64) if turn is None else None
            take(left, *calls.solve(self._solver, positions=positions[left], directions=aims, initial=given))
        return codes, q

    def _tangents(self, q: Shapes) -> Floats:
        """Directions (k, 3) of the tip in configurations."""
        robot, own = self._solver.robot, q.astype(np.float64)
        if self._loaded is not None and len(own):
            robot, own = longest_body(robot), np.array([self._loaded.at(each).shown for each in own])
        return robot.tip(own)[:, :3, 2]


def _aside(axes: Floats, tangents: Floats, angle: float, turn: float | None) -> Floats:
    """Directions (k, 3) at an angle from axes: nearest to tangents, or turned about the axis."""
    first = np.cross(axes, np.eye(3)[np.abs(axes).argmin(axis=-1)])
    across = first if turn is None else math.cos(turn) * first + math.sin(turn) * np.cross(axes, first)
    if turn is None:
        aside = tangents - (tangents * axes).sum(axis=-1, keepdims=True) * axes
        across = np.where(np.linalg.norm(aside, axis=-1, keepdims=True) > CONE_SLACK, aside, first)
    across = across / np.linalg.norm(across, axis=-1, keepdims=True)
    return math.cos(angle) * axes + math.sin(angle) * across


class Rounds:
    """Solves all directions of places by a solver.

    Attributes
    ----------
    codes : ndarray (m, d)
        Verdicts.
    q : ndarray (m d, n, 3)
        The best configurations: what neighbours begin from.
    """

    def __init__(self, query: PlaceQuery, segments: int, places: MappedPlaces, calls: Calls) -> None:
        self._query, self._places, self._calls = query, places, calls
        self.codes = np.full((len(places.positions), query.count), Verdict.NOT_FOUND, np.uint8)
        self.q = np.zeros((self.codes.size, segments, 3), np.float32)

    def solve(self, targets: Numbers, initial: Shapes | None, bar: ProgressBar) -> None:
        """Solve targets, numbers (k,) of place and direction together, each by itself or from its own of `initial`."""
        for some in parts_of(targets):
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
            for some, begun in zip(parts_of(targets), parts_of(near), strict=True):
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

    def _solve(self, targets: Numbers, initial: Shapes | None) -> None:
        place, direction = np.divmod(targets, self._query.count)
        given = None if initial is None else initial.astype(np.float64)
        codes, q = self._query.solve(self._calls, self._places.positions[place], direction, given)
        flat = self.codes.ravel()
        better = (flat[targets] >= Verdict.OBSTACLE) & ((codes != Verdict.NOT_FOUND) | (flat[targets] > codes))
        flat[targets[better]] = codes[better]
        self.q[targets[better]] = q[better]


def parts_of(targets: Numbers) -> Iterator[Numbers]:
    """Yield targets as they are solved together."""
    for first in range(0, len(targets), CALL_SIZE):
        yield targets[first : first + CALL_SIZE]


def neighbours_of(taken: NDArray[np.bool_]) -> Numbers:
    """Numbers (m, 6) of the voxels beside those that are taken, in their order; -1 for none."""
    numbers = np.full(np.array(taken.shape) + 2, -1, np.int64)
    numbers[1:-1, 1:-1, 1:-1][taken] = np.arange(int(taken.sum()))
    at = np.argwhere(taken) + 1
    return np.stack([numbers[tuple((at + step).T)] for step in FACES], axis=-1)
