"""`reach`: every voxel in every direction, without obstacles and among them, in rounds.

Measurements showed that the single arc that a solve begins with is as good a start as the solution of a neighbour. So
all are tried from it first; neighbours help where it fails. A round depends only on the rounds before it, not on what
threads do: the calls of a solver always come in the same order, and a checkpoint may hold those that were made.
"""

import time as clock
from pathlib import Path
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Rows, Truth, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import refuse_unknown
from sinuous.base.progress import ProgressBar
from sinuous.kernels.compile import code_first
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
from sinuous.studies.workspace.reach import Codes, Reach, Verdict, Voxels, directions_of, reach_of
from sinuous.studies.workspace.rounds import CALL_SIZE, Calls, MappedPlaces, Rounds, neighbours_of

SEGMENT_SAMPLES = 6
"""Points of a segment whose distances tell which obstacle a body runs into."""

CHUNK_BODIES = 20_000
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
    places, snapshot = MappedPlaces(voxels.middles[taken], neighbours_of(taken), axes), solver.scene.snapshot()
    alone = Rounds(free, places, calls)
    codes, obstacles = alone.codes, np.full(voxels.shape, -1, np.int16)
    with code_first(), ProgressBar((2 if len(place) else 1) * codes.size if shown else 0) as bar:
        alone.solve(np.arange(codes.size), None, bar)
        alone.solve_from_neighbours()
        if len(place):
            codes = _among_obstacles(Rounds(solver, places, calls), alone, bar)
            blocked = _blocked_places(solver, places, calls)
            if len(blocked):
                codes[blocked] = np.where(
                    codes[blocked] == Verdict.OUT_OF_REACH, codes[blocked], Verdict.TARGET_BLOCKED
                )
            obstacles[taken] = _blame(solver.robot, snapshot, places, codes, alone)
    found = Reach(
        voxels=voxels,
        directions=np.array(axes),
        verdicts=_whole(codes, taken),
        free=_whole(alone.codes, taken),
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
    for first in range(0, len(points), CALL_SIZE):
        codes, _ = calls.solve(free, positions=points[first : first + CALL_SIZE])
        near.append(codes != Verdict.OUT_OF_REACH)
    return np.concatenate(near).reshape(voxels.shape)


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


def _blocked_places(solver: Solver, places: MappedPlaces, calls: Calls) -> NDArray[np.int64]:
    """Numbers of the places where the body of the tip would overlap an obstacle, whatever the direction."""
    distances = solver.scene.snapshot().distance(places.positions)
    near = np.flatnonzero(distances < max(solver.robot.needed_radii))
    if not len(near):
        return near
    codes, _ = calls.solve(solver, positions=places.positions[near])
    return near[codes == Verdict.TARGET_BLOCKED]


def _blame(robot: Robot, scene: Snapshot, places: MappedPlaces, codes: Codes, alone: Rounds) -> NDArray[np.int16]:
    """Which obstacle (m,) takes most directions away from each place, -1 where none does."""
    hit, blocked = np.nonzero(codes == Verdict.OBSTACLE), np.nonzero(codes == Verdict.TARGET_BLOCKED)
    at = np.concatenate([hit[0], blocked[0]])
    of_bodies = _deepest(robot, scene, alone.q[np.ravel_multi_index(hit, codes.shape)])
    which = np.concatenate([of_bodies, scene.nearest(places.positions[blocked[0]])]).astype(np.int64)
    result = np.full(len(codes), -1, np.int16)
    pairs, counts = np.unique(at * len(scene) + which, return_counts=True)
    order = np.argsort(counts, kind="stable")  # the most frequent one is written last
    place, obstacle = np.divmod(pairs[order], len(scene))
    result[place] = obstacle
    return result


def _deepest(robot: Robot, scene: Snapshot, q: NDArray[np.float32]) -> NDArray[np.int16]:
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


def _whole(codes: Codes, taken: NDArray[np.bool_]) -> Codes:
    """Verdicts (x, y, z, d) of all voxels."""
    result = np.full((*taken.shape, codes.shape[1]), Verdict.OUT_OF_REACH, np.uint8)
    result[taken] = codes
    return result
