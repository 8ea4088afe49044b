"""`reach`: every voxel, and every direction there, without obstacles and among them, in rounds.

Measurements showed that the single arc that a solve begins with is as good a start as the solution of a neighbour. So
all are tried from it first; neighbours help where it fails. A round depends only on the rounds before it, not on what
threads do: the calls of a solver always come in the same order, and a checkpoint may hold those that were made.
"""

import math
import time as clock
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Rows, Truth, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import refuse_unknown
from sinuous.base.progress import ProgressBar
from sinuous.kernels.compile import code_first
from sinuous.model.robot import Robot
from sinuous.problem.target import Tolerance, Workspace
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LoadedShapes
from sinuous.solver.many import read_workers
from sinuous.solver.memory import only_reading
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.statics.equilibrium import longest_body
from sinuous.studies.runs.engine import Arrays, Checkpoint, hash_of, problem_record
from sinuous.studies.workspace.reach import Codes, Reach, Verdict, Voxels, reach_of, verdicts_of

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
            return {"codes": verdicts_of(found), "q": found.configuration.astype(np.float32)}

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


SEGMENT_SAMPLES = 6
"""Points of a segment whose distances tell which obstacle a body runs into."""

CHUNK_BODIES = 20_000
"""Bodies that are looked at in one step: it bounds memory."""

PATIENCE = 2.0
"""Seconds after which a person wants to know how long it takes."""

NO_AXES: Floats = np.empty((0, 3))


def reach(
    robot: Robot,
    scene: SceneLike | None = None,
    spacing: Number | None = None,
    directions: Whole | Vector | Rows = 0,
    *,
    within: Number | None = None,
    low: Vector | None = None,
    high: Vector | None = None,
    workers: Whole | None = None,
    progress: Truth = True,
    out: str | Path | None = None,
    **options: Unpack[SolveArguments],
) -> Reach:
    """Map what a robot reaches: the positions, or directions at each, that are solved and proved, and why not more.

    First all is solved without obstacles, from the single arc and then from neighbours. What is solved so is solved
    among obstacles from the free shape, then anew, then from neighbours. What is not solved without obstacles is not
    tried among them. The answer is the same whatever the number of workers.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
    spacing : float, optional
        Edge of a voxel; by default a 35th of the robot's reach.
    directions : int or array_like (3,) or (d, 3)
        Of the tangent at the tip, beside positions, which are always mapped. 0: none; 26: those to the neighbours of a
        cube; another number: along a spiral on a sphere; or these.
    within : float, optional
        Half-angle of the cone about each direction that the tangent must be in, rad; by default the angle of the
        tolerance.
    low, high : array_like (3,), optional
        Corners of what is looked at; by default all that the robot may reach. Equal entries make a slice.
    workers : int, optional
        Most threads; by default one a core.
    progress : bool
        Whether to say after 2 seconds how far it is, and how long it will take: a bar on a terminal, otherwise a line
        a minute.
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
    asked = Workspace(spacing, directions, within, low, high)
    voxels, place = Voxels.about(robot, asked), as_scene(scene)
    given = only_reading({"max_starts": 1, "routes": False, **options})
    solvers = Solver(robot, None, **given), Solver(robot, place, **given)
    checkpoint = Checkpoint(None if out is None else Path(out), _record(solvers[1], voxels, asked), "this map")
    checkpoint.open()
    total = int(np.prod(voxels.shape)) if shown else 0
    with code_first(), ProgressBar(total, shown, "mapping", PATIENCE, "targets") as bar:
        mapped = _Map(solvers, voxels, Calls(threads, checkpoint), bar)
        alone, codes = mapped.solve(NO_AXES, None)
        free_places, places = alone.codes, codes
        if len(asked.axes):
            alone, codes = mapped.solve(asked.axes, asked.within)
            free_places, places = _joined(free_places, alone.codes), _joined(places, codes)
        obstacles = np.full(voxels.shape, -1, np.int16)
        if len(place):
            obstacles[mapped.taken] = mapped.blame(codes, alone)
    snapshot = solvers[1].scene.snapshot()
    found = Reach(
        voxels=voxels,
        directions=np.array(asked.axes),
        within=asked.within,
        sampled=asked.sampled,
        positions=mapped.whole(places)[..., 0],
        free_positions=mapped.whole(free_places)[..., 0],
        verdicts=mapped.whole(codes),
        free=mapped.whole(alone.codes),
        obstacles=obstacles,
        names=tuple(snapshot.name(i) for i in range(len(snapshot))),
        base=np.array(robot.base[:3, 3]),
        farthest=np.inf if robot.has_external_load else reach_of(robot),  # loads may stretch it
        seconds=clock.perf_counter() - began,
    )
    if out is not None:
        found.save(out)
        checkpoint.remove()
    return found


def _record(solver: Solver, voxels: Voxels, asked: Workspace) -> dict[str, str]:
    """Return all that a map depends on."""
    return {
        **problem_record(solver.robot, solver.scene.snapshot(), solver.options),
        "spacing": str(voxels.spacing),
        "low": str(voxels.first.tolist()),
        "high": f"{' x '.join(map(str, voxels.shape))} voxels from there",
        "directions": f"{len(asked.axes)}, {hash_of(asked.axes.tobytes())}",
        "within": str(asked.within),
    }


def _joined(places: Codes, codes: Codes) -> Codes:
    """Verdicts (m, 1) of positions, of which some were solved in a direction alone."""
    return np.where((codes == Verdict.SOLVED).any(axis=-1, keepdims=True), Verdict.SOLVED, places).astype(np.uint8)


class _Map:
    """Solves of one map; first, positions without obstacles.

    Parameters
    ----------
    solvers : (Solver, Solver)
        Without obstacles and among them.
    voxels : Voxels
    calls : Calls
    bar : ProgressBar

    Attributes
    ----------
    taken : ndarray (x, y, z) of bool
        Voxels that are not proved to be out of reach, whatever the direction.
    """

    def __init__(self, solvers: tuple[Solver, Solver], voxels: Voxels, calls: Calls, bar: ProgressBar) -> None:
        self._solvers, self._calls, self._bar = solvers, calls, bar
        points = voxels.middles.reshape(-1, 3)
        codes, shapes = np.full(len(points), Verdict.OUT_OF_REACH, np.uint8), []
        for some in parts_of(np.arange(len(points))):
            codes[some], q = calls.solve(solvers[0], positions=points[some])
            shapes.append(q[codes[some] != Verdict.OUT_OF_REACH])
            bar.advance(len(some))
        self.taken = (codes != Verdict.OUT_OF_REACH).reshape(voxels.shape)
        self._begun = codes[self.taken.ravel()], np.concatenate(shapes)
        self._places = MappedPlaces(voxels.middles[self.taken], neighbours_of(self.taken))

    def solve(self, axes: Floats, within: float | None) -> tuple[Rounds, Codes]:
        """Solve all directions (d, 3), or positions: without obstacles, and the verdicts (m, d) among them."""
        free, solver = self._solvers
        alone = self._rounds(free, axes, within)
        self._bar.expect(alone.codes.size * ((1 if len(axes) else 0) + (1 if len(solver.scene) else 0)))
        if len(axes):
            alone.solve(np.arange(alone.codes.size), None, self._bar)
        else:
            alone.codes[:, 0], alone.q[:] = self._begun
        alone.solve_from_neighbours()
        if not len(solver.scene):
            return alone, alone.codes
        codes = _among_obstacles(self._rounds(solver, axes, within), alone, self._bar)
        blocked = self._blocked_places()
        codes[blocked] = np.where(codes[blocked] == Verdict.OUT_OF_REACH, codes[blocked], Verdict.TARGET_BLOCKED)
        return alone, codes

    def _rounds(self, solver: Solver, axes: Floats, within: float | None) -> Rounds:
        return Rounds(PlaceQuery(solver, axes, within), len(solver.robot), self._places, self._calls)

    def _blocked_places(self) -> NDArray[np.int64]:
        """Numbers of the places where the body of the tip would overlap an obstacle, whatever the direction."""
        solver, positions = self._solvers[1], self._places.positions
        distances = solver.scene.snapshot().distance(positions)
        near = np.flatnonzero(distances < max(solver.robot.needed_radii))
        if not len(near):
            return near
        codes, _ = self._calls.solve(solver, positions=positions[near])
        return near[codes == Verdict.TARGET_BLOCKED]

    def blame(self, codes: Codes, alone: Rounds) -> NDArray[np.int16]:
        """Which obstacle (m,) takes most directions away from each place, -1 where none does."""
        solver, positions = self._solvers[1], self._places.positions
        scene = solver.scene.snapshot()
        hit, blocked = np.nonzero(codes == Verdict.OBSTACLE), np.nonzero(codes == Verdict.TARGET_BLOCKED)
        at = np.concatenate([hit[0], blocked[0]])
        of_bodies = _deepest(solver.robot, scene, alone.q[np.ravel_multi_index(hit, codes.shape)])
        which = np.concatenate([of_bodies, scene.nearest(positions[blocked[0]])]).astype(np.int64)
        result = np.full(len(codes), -1, np.int16)
        pairs, counts = np.unique(at * len(scene) + which, return_counts=True)
        order = np.argsort(counts, kind="stable")  # the most frequent one is written last
        place, obstacle = np.divmod(pairs[order], len(scene))
        result[place] = obstacle
        return result

    def whole(self, codes: Codes) -> Codes:
        """Verdicts (x, y, z, d) of all voxels."""
        result = np.full((*self.taken.shape, codes.shape[1]), Verdict.OUT_OF_REACH, np.uint8)
        result[self.taken] = codes
        return result


def _among_obstacles(rounds: Rounds, alone: Rounds, bar: ProgressBar) -> Codes:
    """Verdicts (m, d) among obstacles of what is solved without them; of the rest the verdict without obstacles."""
    codes, free = rounds.codes, alone.codes == Verdict.SOLVED
    rounds.solve(np.flatnonzero(free), alone.q, bar)
    rounds.solve(np.flatnonzero(free & (codes >= Verdict.OBSTACLE)), None, bar)
    codes[~free] = Verdict.OUT_OF_REACH  # not to be tried, until the free verdict takes its place
    rounds.solve_from_neighbours()
    codes[~free] = alone.codes[~free]
    codes[free & (codes >= Verdict.OBSTACLE)] = Verdict.OBSTACLE
    return codes


def _deepest(robot: Robot, scene: Snapshot, q: Shapes) -> NDArray[np.int16]:
    """Numbers (m,) of the obstacles that bodies (m, n, 3) run into deepest, by some points of each segment."""
    found = np.empty(len(q), np.int16)
    ways, body = (LoadedShapes(robot), longest_body(robot)) if robot.has_external_load else (None, robot)
    radii = np.repeat(np.array(body.needed_radii), SEGMENT_SAMPLES)
    for first in range(0, len(q), CHUNK_BODIES):
        some = q[first : first + CHUNK_BODIES].astype(np.float64)
        if ways is not None:
            some = np.array([ways.at(q).shown for q in some])
        points = body.backbone(some, SEGMENT_SAMPLES)[:, 1:]
        along = np.cumsum(np.repeat(some[..., 2] / SEGMENT_SAMPLES, SEGMENT_SAMPLES, axis=1), axis=1)
        gaps = np.where(along >= robot.mount, scene.distance(points) - radii, np.inf)
        worst = gaps.argmin(axis=1)
        found[first : first + CHUNK_BODIES] = scene.nearest(points[np.arange(len(some)), worst])
    return found
