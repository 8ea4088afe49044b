"""`reach`: every voxel in every direction, without obstacles and among them, in rounds.

Measurements showed that the single arc that a solve begins with is as good a start as the solution of a neighbour. So
all are tried from it first; neighbours help where it fails. A round depends only on the rounds before it, not on what
threads do: the calls of a solver always come in the same order, and a checkpoint may hold those that were made.
"""

import time as clock
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Rows, Truth, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.keywords import refuse_unknown
from sinuous.base.progress import ProgressBar
from sinuous.kernels.compiling.tiers import code_first
from sinuous.model.robot import Robot
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LoadedShapes
from sinuous.solver.many import read_workers
from sinuous.solver.memory import only_reading
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.statics.equilibrium import longest_body
from sinuous.studies.runs.checkpoint import Checkpoint, hash_of, problem_record
from sinuous.studies.runs.engine import Arrays
from sinuous.studies.workspace.reach import Codes, Reach, Verdict, Voxels, directions_of, reach_of, verdicts_of

Numbers = NDArray[np.int64]

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


class ReachAnswers(NamedTuple):
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


class ReachWork(NamedTuple):
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
    neighbours: Numbers
    directions: Floats
    calls: Calls


class Rounds:
    """Solves all directions of places by a solver."""

    def __init__(self, solver: Solver, work: ReachWork) -> None:
        self._solver, self._work = solver, work
        shape = len(work.places), len(work.directions)
        self.answers = ReachAnswers(
            np.full(shape, Verdict.NOT_FOUND, np.uint8), np.zeros((*shape, len(solver.robot), 3), np.float32)
        )

    def begin(self, asked: Numbers, initial: NDArray[np.float32] | None, bar: ProgressBar) -> None:
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

    def _candidates(self, tried: NDArray[np.uint8]) -> tuple[Numbers, Numbers]:
        """Questions that are open and may begin from a neighbour, and which neighbour that is."""
        codes = self.answers.codes
        ways = codes.shape[1]
        places, directions = np.nonzero((codes >= Verdict.OBSTACLE) & (tried < TRIES))
        beside = self._work.neighbours[places]
        solved = (beside >= 0) & (codes[beside, directions[:, None]] == Verdict.SOLVED)
        rank = np.cumsum(solved, axis=1) - 1
        wanted = solved & (rank == tried[places, directions][:, None])
        some = wanted.any(axis=1)
        near = beside[some, wanted[some].argmax(axis=1)]
        return places[some] * ways + directions[some], near * ways + directions[some]

    def _solve(self, asked: Numbers, initial: NDArray[np.float32] | None) -> None:
        place, direction = np.divmod(asked, len(self._work.directions))
        given = None if initial is None else initial.astype(np.float64)
        places, directions = self._work.places[place], self._work.directions[direction]
        codes, q = self._work.calls.solve(self._solver, positions=places, directions=directions, initial=given)
        flat = self.answers.codes.ravel()
        better = (flat[asked] >= Verdict.OBSTACLE) & ((codes != Verdict.NOT_FOUND) | (flat[asked] > codes))
        flat[asked[better]] = codes[better]
        self._flat_q[asked[better]] = q[better]


def neighbours_of(taken: NDArray[np.bool_]) -> Numbers:
    """Numbers (m, 6) of the voxels beside those that are taken, in their order; -1 for none."""
    numbers = np.full(np.array(taken.shape) + 2, -1, np.int64)
    numbers[1:-1, 1:-1, 1:-1][taken] = np.arange(int(taken.sum()))
    at = np.argwhere(taken) + 1
    return np.stack([numbers[tuple((at + step).T)] for step in FACES], axis=-1)


SAMPLES = 6
"""Points of a segment whose distances tell which obstacle a body runs into."""

BODIES_TOGETHER = 20_000
"""Bodies that are looked at in one step: it bounds memory."""


def reach(
    robot: Robot,
    scene: SceneLike | None = None,
    spacing: Number | None = None,
    directions: Whole | Rows = 26,
    *,
    low: Vector | None = None,
    high: Vector | None = None,
    workers: Whole | None = None,
    progress: Truth = False,
    out: str | Path | None = None,
    **options: Unpack[SolveArguments],
) -> Reach:
    """Map what a robot reaches: the share of directions that is solved and proved in each voxel, and why not more.

    First all is solved without obstacles, from the single arc and then from neighbours. What is solved so is solved
    among obstacles from the free shape, then anew, then from neighbours. What is not solved without obstacles is not
    tried among them. The answer is the same whatever the number of workers.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
    spacing : float, optional
        Edge of a voxel; by default a 35th of the robot's reach.
    directions : int or array_like (d, 3)
        Of the tangent at the tip: 26 to the neighbours of a cube, another number along a spiral on a sphere, or these.
    low, high : array_like (3,), optional
        Corners of what is looked at; by default all that the robot may reach. Equal entries make a slice.
    workers : int, optional
        Most threads; by default one a core.
    progress : bool
        Whether to show on a terminal how far it is.
    out : path, optional
        A file (`.npz`) for the map, see `Reach.save`. Until it is complete, what is found is kept in a folder beside
        it: the same call goes on where an earlier one ended.
    **options
        As for `Solver`, but `max_starts` is 1 and `routes` false by default: what more starts find costs much.

    Returns
    -------
    Reach

    Raises
    ------
    InputError
        When an argument is not what it should be, there would be too many voxels, or `out` was begun with another
        problem, grid or version.
    """
    began = clock.perf_counter()
    refuse_unknown(options, SolveArguments.__annotations__)
    checks.instance("robot", robot, Robot, "a Robot")
    threads, shown = read_workers(workers), checks.truth("progress", progress)
    voxels, axes, place = Voxels.about(robot, spacing, low, high), directions_of(directions), as_scene(scene)
    given = only_reading({"max_starts": 1, "routes": False, **options})
    free, solver = Solver(robot, None, **given), Solver(robot, place, **given)
    checkpoint = Checkpoint(None if out is None else Path(out), _record(solver, voxels, axes), "this map")
    checkpoint.open()
    calls = Calls(threads, checkpoint)
    with code_first():
        taken = _within_reach(free, voxels, calls)
    points = voxels.middles[taken]
    work = ReachWork(solver.robot, solver.scene.snapshot(), points, neighbours_of(taken), axes, calls)
    with code_first(), ProgressBar((2 if len(place) else 1) * len(points) * len(axes) if shown else 0) as bar:
        alone = _without_obstacles(work, free, bar)
        among, blamed = (alone.codes, None) if not len(place) else _among_obstacles(work, solver, alone, bar)
    verdicts, unhindered = (_whole(codes, taken) for codes in (among, alone.codes))
    obstacles = np.full(voxels.shape, -1, np.int16)
    if blamed is not None:
        obstacles[taken] = blamed
    found = Reach(
        voxels=voxels,
        directions=np.array(axes),
        verdicts=verdicts,
        free=unhindered,
        obstacles=obstacles,
        names=tuple(work.scene.name(i) for i in range(len(work.scene))),
        base=np.array(robot.base[:3, 3]),
        farthest=np.inf if robot.hangs else reach_of(robot),  # loads may stretch it
        seconds=clock.perf_counter() - began,
    )
    if out is not None:
        found.save(out)
        checkpoint.remove()
    return found


def _record(solver: Solver, voxels: Voxels, directions: Floats) -> dict[str, str]:
    """Return all that a map depends on."""
    return {
        **problem_record(solver.robot, solver.scene.snapshot(), solver.options),
        "spacing": str(voxels.spacing),
        "low": str(voxels.first.tolist()),
        "high": f"{' x '.join(map(str, voxels.shape))} voxels from there",
        "directions": f"{len(directions)}, {hash_of(directions.tobytes())}",
    }


def _within_reach(free: Solver, voxels: Voxels, calls: Calls) -> NDArray[np.bool_]:
    """Which voxels (x, y, z) are not proved to be out of reach, whatever the direction."""
    points = voxels.middles.reshape(-1, 3)
    near = []
    for first in range(0, len(points), TOGETHER):
        codes, _ = calls.solve(free, positions=points[first : first + TOGETHER])
        near.append(codes != Verdict.OUT_OF_REACH)
    return np.concatenate(near).reshape(voxels.shape)


def _without_obstacles(work: ReachWork, free: Solver, bar: ProgressBar) -> ReachAnswers:
    rounds = Rounds(free, work)
    rounds.begin(np.arange(rounds.answers.codes.size), None, bar)
    rounds.from_neighbours()
    return rounds.answers


def _among_obstacles(
    work: ReachWork, solver: Solver, alone: ReachAnswers, bar: ProgressBar
) -> tuple[Codes, NDArray[np.int16]]:
    """Verdicts (m, d), and the obstacle (m,) that takes most directions away, -1 where none does."""
    rounds = Rounds(solver, work)
    codes = rounds.answers.codes
    free = alone.codes == Verdict.SOLVED
    rounds.begin(np.flatnonzero(free), alone.q.reshape(-1, *alone.q.shape[2:]), bar)
    rounds.begin(np.flatnonzero(free & (codes >= Verdict.OBSTACLE)), None, bar)
    codes[~free] = Verdict.OUT_OF_REACH  # not to be tried, until the free verdict takes its place
    rounds.from_neighbours()
    codes[~free] = alone.codes[~free]
    codes[free & (codes >= Verdict.OBSTACLE)] = Verdict.OBSTACLE
    blocked = _blocked_places(work, solver)
    if len(blocked):
        codes[blocked] = np.where(codes[blocked] == Verdict.OUT_OF_REACH, codes[blocked], Verdict.TARGET_BLOCKED)
    return codes, _blame(work, codes, alone)


def _blocked_places(work: ReachWork, solver: Solver) -> NDArray[np.int64]:
    """Numbers of the places where the body of the tip would overlap an obstacle, whatever the direction."""
    near = np.flatnonzero(work.scene.distance(work.places) < max(work.robot.needed_radii))
    if not len(near):
        return near
    codes, _ = work.calls.solve(solver, positions=work.places[near])
    return near[codes == Verdict.TARGET_BLOCKED]


def _blame(work: ReachWork, codes: Codes, alone: ReachAnswers) -> NDArray[np.int16]:
    """Which obstacle takes most directions away from each place."""
    hit, taken = np.nonzero(codes == Verdict.OBSTACLE), np.nonzero(codes == Verdict.TARGET_BLOCKED)
    at = np.concatenate([hit[0], taken[0]])
    of_bodies = _deepest(work.robot, work.scene, alone.q[hit])
    which = np.concatenate([of_bodies, work.scene.nearest(work.places[taken[0]])]).astype(np.int64)
    result = np.full(len(codes), -1, np.int16)
    pairs, counts = np.unique(at * len(work.scene) + which, return_counts=True)
    order = np.argsort(counts, kind="stable")  # the most frequent one is written last
    place, obstacle = np.divmod(pairs[order], len(work.scene))
    result[place] = obstacle
    return result


def _deepest(robot: Robot, scene: Snapshot, q: NDArray[np.float32]) -> NDArray[np.int16]:
    """Numbers (m,) of the obstacles that bodies (m, n, 3) run into deepest, by some points of each segment."""
    found = np.empty(len(q), np.int16)
    ways, body = (LoadedShapes(robot), longest_body(robot)) if robot.hangs else (None, robot)
    radii = np.repeat(np.array(body.needed_radii), SAMPLES)
    for first in range(0, len(q), BODIES_TOGETHER):
        some = q[first : first + BODIES_TOGETHER].astype(np.float64)
        if ways is not None:
            some = np.array([ways.at(q).shown for q in some])
        points = body.backbone(some, SAMPLES)[:, 1:]
        along = np.cumsum(np.repeat(some[..., 2] / SAMPLES, SAMPLES, axis=1), axis=1)
        gaps = np.where(along >= robot.mount, scene.distance(points) - radii, np.inf)
        worst = gaps.argmin(axis=1)
        found[first : first + BODIES_TOGETHER] = scene.nearest(points[np.arange(len(some)), worst])
    return found


def _whole(codes: Codes, taken: NDArray[np.bool_]) -> Codes:
    """Verdicts (x, y, z, d) of all voxels."""
    result = np.full((*taken.shape, codes.shape[1]), Verdict.OUT_OF_REACH, np.uint8)
    result[taken] = codes
    return result
