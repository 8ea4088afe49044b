"""`explore`: a roadmap of one robot in one place (PRM, Kavraki et al. 1996), in rounds that workers share.

What a round tries is drawn from the seed, its number, and what the rounds before it found. Positions anywhere are met
by the solver; positions near the tip of a shape are met from there, and shapes are moved aside, both about tips where
there are few (Hsu, Latombe & Motwani 1997); and ways are looked for between parts that no motion joins. Of every
position anywhere it is noted, before its shape is kept, whether a shape was near, and whether one motion joins it: so
the share that is covered is one of positions that the roadmap was not made of.
"""

import json
import math
import time as clock
from collections.abc import Iterator
from typing import Any, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Batch, Number, Truth, Whole
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, duration, refuse_unknown, warn_of
from sinuous.base.frozen import ShortRepr
from sinuous.base.progress import ProgressBar
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric, violated_by
from sinuous.problem.problem import check_sizes, input_warnings
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.solver.many import read_workers
from sinuous.solver.memory import Explored, Memory
from sinuous.solver.options import SolveArguments, SolveOptions
from sinuous.solver.shapes import Graph
from sinuous.solver.shapes import Whole as Numbers
from sinuous.studies.exploring.explorer import Explorer, TaskKind
from sinuous.studies.runs.engine import Arrays, Engine, hash_of
from sinuous.studies.runs.engines import open_engine
from sinuous.studies.workspace.reach import reach_of

MOST_PARTS = 20
"""Sizes of parts that are told."""


class Exploration(ShortRepr):
    """What `explore` did, and what the memory holds then.

    The shares are of positions that were drawn evenly in the ball of the robot's reach, before anything was known of
    them, and that the solver met without the memory; of the last 400 such positions.

    Attributes
    ----------
    memory : Memory
    shapes, motions : int
        That are kept.
    parts : tuple of int
        Numbers of shapes that motions join, the largest 20.
    tests : int
        Positions that the shares are of.
    covered : float
        Share of positions with the tip of a shape of the largest part within `spacing`; NaN where there are none.
    joined : float
        Share of positions whose shape one proved motion joined to a shape of the largest part; NaN likewise.
    spacing : float
    rounds : int
        Done until now, also by earlier calls.
    full : bool
        Whether it ended because the memory was full.
    seconds : float
        Of this call.
    """

    def __init__(self, memory: Memory, spacing: float, full: bool, seconds: float) -> None:
        self.memory, self.spacing, self.full, self.seconds = memory, spacing, full, seconds
        graph, known = memory._shapes.everything, memory._explored
        self.shapes, self.motions = len(graph), len(graph.edges)
        self.parts = tuple(np.bincount(graph.parts)[:MOST_PARTS].tolist())
        tests = [] if known is None else known.tests
        self.rounds, self.tests = 0 if known is None else known.rounds, len(tests)
        self.covered, self.joined = (
            math.nan if not tests else sum(each[i] for each in tests) / len(tests) for i in (0, 1)
        )

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values; a share of nothing is `None`."""
        return result_of(self, "shapes motions tests spacing rounds full seconds parts covered joined")

    def __str__(self) -> str:
        told = [f"{self.shapes:,} shapes", f"{self.motions:,} motions"]
        if self.parts:
            largest = f"{self.parts[0] / self.shapes:.0%} of the shapes in the largest part"
            told.append(largest)
        if self.tests:
            told.append(
                f"of {self.tests} positions that the robot reaches, {self.covered:.0%} near a shape of it "
                f"and {self.joined:.0%} one motion from it"
            )
        if self.full:
            told.append("the memory is full")
        return f"{', '.join(told)}; {self.rounds} rounds, {duration(self.seconds)}"

    def _shown(self) -> Iterator[str]:
        yield f"{self.shapes} shapes"
        yield f"{self.motions} motions"


DEFAULT_SECONDS = 60.0
"""Seconds, by default."""

DEFAULT_STARTS = 24
"""Most starts of a position anywhere, by default."""

ROUND_TASKS, CHUNK_TASKS = 128, 8
"""Tasks of a round, and those of a chunk."""

EVEN_TASKS, MOST_JOIN_TASKS = 24, 8
"""Of these the positions anywhere, and the most that join parts; half of the others are beside shapes, half aside."""

SPACINGS_IN_REACH = 20
"""Spacings from the base to the farthest place, where none is given."""

LEAST_OFFSET, LARGEST_OFFSET = 0.05, 2.0
"""Range of the largest distance of a position beside a shape from its tip, in spacings; even on a logarithmic scale."""

NEIGHBOUR_COUNT = 16
"""Shapes nearby that a task gets."""

MOST_TESTS = 400
"""Latest positions anywhere that the shares are of."""

CHUNK_PAIRS = 64
"""Motions that are proved again together."""


def explore(
    robot: Robot,
    scene: SceneLike | None = None,
    *,
    starts: Batch | None = None,
    rounds: Whole | None = None,
    spacing: Number | None = None,
    engine: object = "threads",
    workers: Whole | None = None,
    progress: Truth = False,
    **options: Unpack[SolveArguments],
) -> Exploration:
    """Fill a memory ahead: shapes of a robot in a place that stays, and proved motions between them.

    Solves with this memory begin from these shapes, and `plan` walks along the motions. It is done in rounds, and what
    a round found is in the memory when it ends: after an interrupt, the same call with the memory goes on. Rounds are
    the same for a seed, whatever the number of workers. Where the memory was filled in another scene, all of it is
    proved again first, and what is not clear any more is forgotten.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
        In which nothing moves.
    time : float
        Seconds, by default 60; the round that is under way is finished.
    memory : Memory, optional
        To be filled; by default a new one. Shapes that it holds are joined, too.
    starts : array_like (n, 3) or (m, n, 3), optional
        Shapes to be joined first, like the one in which the robot waits; by default straight, where that is clear.
    rounds : int, optional
        Most rounds; by default as many as the time allows. With enough time, as many give the same memory, in one call
        or in several.
    spacing : float, optional
        How near the tip of a shape has to be to a position that it covers; by default a 20th of the robot's reach.
    engine : str, executor or Dask client
        As for `solve_batch`.
    workers : int, optional
        By default one a core.
    progress : bool
        Whether to show on a terminal how many of the seconds are over.
    **options
        As for `Solver`, of positions anywhere: by default `max_starts` is 24.

    Returns
    -------
    Exploration
        What there is now; its `memory` is the one that was filled.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    UnfinishedError
        When a worker fails again and again.
    """
    began = clock.perf_counter()
    checks.instance("robot", robot, Robot, "a Robot")
    refuse_unknown(options, SolveArguments.__annotations__)
    given: dict[str, Any] = {"time": DEFAULT_SECONDS, "max_starts": DEFAULT_STARTS, **options}
    place, seconds = as_scene(scene), checks.number("time", given.pop("time"), low=0.0)
    memory = given.pop("memory", None)
    chosen = SolveOptions.of(given)
    most = math.inf if rounds is None else checks.integer("rounds", rounds, 0, 2**31 - 1)
    near = reach_of(robot) / SPACINGS_IN_REACH if spacing is None else checks.number("spacing", spacing, above=0.0)
    kept = Memory(robot) if memory is None else memory
    checks.instance("memory", kept, Memory, "a Memory")
    kept.check(robot)
    if robot.has_external_load:
        raise InputError("gravity", "memories hold motions without load", robot.gravity, "none")
    snapshot = place.snapshot()
    snapshot.refuse_moving()
    check_sizes(robot, place)
    warn_of(input_warnings(robot, snapshot))
    wanted = _starts(chosen.demanded_of(robot), starts)
    explorer = Explorer(chosen.demanded_of(robot), Scene.of(snapshot), chosen)
    count = read_workers(workers)
    with (
        open_engine(engine, explorer, count) as ready,
        ProgressBar(math.ceil(seconds) if checks.truth("progress", progress) else 0) as bar,
    ):
        run = _ExplorationRun(explorer, kept, near, ready)
        run.prepare(wanted, chosen.seed)
        shown, done = 0, 0
        while done < most and clock.perf_counter() - began < seconds and run.round():
            done += 1
            passed = min(math.ceil(seconds), int(clock.perf_counter() - began))
            bar.advance(passed - shown)
            shown = passed
    return Exploration(kept, near, run.full, clock.perf_counter() - began)


def _starts(robot: Robot, given: Batch | None) -> Floats:
    """Shapes (m, n, 3) to be joined first."""
    if given is None:
        start = np.array(robot.straight[None])
        return start if violated_by(robot, start[0]) is None else start[:0]
    shapes = robot.configuration("starts", given).reshape(-1, len(robot), 3)
    for i, q in enumerate(shapes):
        violated = violated_by(robot, q)
        if violated is not None:
            raise InputError(f"starts[{i}]", str(violated), q.tolist(), "a configuration within all limits")
    return shapes


class _ExplorationRun:
    """Rounds of one exploration.

    Attributes
    ----------
    full : bool
        Whether there was no room for what was found.
    """

    def __init__(self, explorer: Explorer, memory: Memory, spacing: float, engine: Engine) -> None:
        self._explorer, self._memory, self._spacing, self._engine = explorer, memory, spacing, engine
        self._robot, self._reach = explorer.robot, reach_of(explorer.robot)
        self.full = False

    def prepare(self, starts: Floats, seed: int) -> None:
        """Prove again what was proved in another scene, and keep the shapes to be joined first."""
        scene = self._explorer.scene.snapshot()
        robot = json.dumps(self._robot.to_dict(), sort_keys=True).encode()
        name = hash_of(scene.group.tobytes(), robot)
        shapes, known = self._memory._shapes, self._memory._explored
        if known is None or known.scene != name:
            graph = shapes.everything
            still = self._clear(np.stack([graph.q, graph.q], axis=1))
            shapes.keep(still, self._clear(graph.q[graph.edges]))
            known = Explored(name, seed, 0, [])
        self._memory._explored = known._replace(seed=seed)
        fresh = starts[shapes.is_new(starts.copy())]  # what compares shapes is compiled for writable arrays alone
        shapes.add(fresh[self._clear(np.stack([fresh, fresh], axis=1))])

    def round(self) -> bool:
        """Do one round; say whether there was room for what it found."""
        known = self._memory._explored
        assert known is not None
        graph = self._memory._shapes.everything
        tasks = _Draws(self._robot, graph, self._reach, self._spacing, [known.seed, known.rounds]).tasks()
        parts = [slice(at, at + CHUNK_TASKS) for at in range(0, len(tasks["kind"]), CHUNK_TASKS)]
        chunks = [{name: values[part] for name, values in tasks.items()} for part in parts]
        blocks = self._done(chunks)
        tests = [*known.tests, *self._tests(graph, tasks, blocks)][-MOST_TESTS:]
        for block in blocks:
            self._keep(block)
        self._memory._explored = known._replace(rounds=known.rounds + 1, tests=tests)
        return not self.full

    def _keep(self, block: Arrays) -> None:
        """Keep what a chunk found; its own numbers, from -1 down, go on from those that are kept."""
        shapes = self._memory._shapes
        edges = np.where(block["edges"] < 0, len(shapes) - 1 - block["edges"], block["edges"])
        self.full |= shapes.add(block["q"], edges) < len(block["q"])

    def _tests(self, graph: Graph, tasks: Arrays, blocks: list[Arrays]) -> list[tuple[int, int]]:
        """Say of positions anywhere that were met whether they were covered before, and joined by one motion."""
        own = np.concatenate([block["own"] for block in blocks])
        largest = graph.parts == 0
        found = []
        for i in np.flatnonzero((tasks["kind"] == TaskKind.EVEN) & (own < 0)).tolist():
            edges = blocks[i // CHUNK_TASKS]["edges"]
            ends = edges[edges[:, 0] == own[i], 1]
            apart = np.linalg.norm(graph.tips[largest] - tasks["target"][i], axis=1)
            found.append((int(apart.min(initial=np.inf) <= self._spacing), int(largest[ends[ends >= 0]].any())))
        return found

    def _clear(self, pairs: Floats) -> Any:
        """Say of pairs (m, 2, n, 3) of shapes between which the motion is proved clear."""
        chunks: list[Arrays] = [{"pairs": pairs[at : at + CHUNK_PAIRS]} for at in range(0, len(pairs), CHUNK_PAIRS)]
        return np.concatenate([np.empty(0, np.bool_), *(block["clear"] for block in self._done(chunks))])

    def _done(self, chunks: list[Arrays]) -> list[Arrays]:
        """Have chunks done by the workers."""
        return self._engine.results(chunks, "a part of the place could not be explored")


class _Draws:
    """Draws the tasks of one round."""

    def __init__(self, robot: Robot, graph: Graph, reach: float, spacing: float, seeds: list[int]) -> None:
        self._robot, self._graph, self._reach, self._spacing = robot, graph, reach, spacing
        self._rng = np.random.default_rng(seeds)

    def tasks(self) -> Arrays:
        """Return what the tasks are: arrays with one row a task."""
        n, count, rng = len(self._robot), len(self._graph), self._rng
        kinds = np.full(ROUND_TASKS if count else EVEN_TASKS, TaskKind.EVEN)
        if count:
            others = np.resize([TaskKind.BESIDE, TaskKind.ASIDE], ROUND_TASKS - EVEN_TASKS)
            joins = min(MOST_JOIN_TASKS, int(self._graph.parts.max()))
            others[:joins] = TaskKind.JOIN
            kinds = np.concatenate([kinds[:EVEN_TASKS], others])
        begins = self._where_few(len(kinds)) if count else np.full(len(kinds), -1)
        joining = np.flatnonzero(kinds == TaskKind.JOIN)
        begins[joining] = self._of_others(len(joining))
        targets = self._robot.base[:3, 3] + self._reach * _in_ball(rng, len(kinds))  # anywhere within reach
        beside = np.flatnonzero(kinds == TaskKind.BESIDE)
        far = self._spacing * np.exp(rng.uniform(np.log(LEAST_OFFSET), np.log(LARGEST_OFFSET), (len(beside), 1)))
        targets[beside] = self._graph.tips[begins[beside]] + far * _in_ball(rng, len(beside))
        near = self._near(kinds, begins, targets)
        return {
            "kind": kinds,
            "seed": rng.integers(0, 2**31 - 1, len(kinds)),
            "target": targets,
            "own": begins,
            "begin": self._graph.q[begins] if count else np.zeros((len(kinds), n, 3)),
            "numbers": near,
            "near": self._graph.q[near] if count else np.zeros((len(kinds), 0, n, 3)),
        }

    def _where_few(self, count: int) -> Numbers:
        """Numbers (count,) of shapes: every cell with a tip is as likely."""
        cells = np.floor(self._graph.tips / self._spacing).astype(np.int64)
        _, which, sizes = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
        weights = 1.0 / sizes[which.ravel()]
        return self._rng.choice(len(cells), count, p=weights / weights.sum())

    def _of_others(self, count: int) -> Numbers:
        """Numbers (count,) of shapes: every part but the largest is as likely."""
        if not count:
            return np.empty(0, np.int64)
        others = np.flatnonzero(self._graph.parts > 0)
        weights = 1.0 / np.bincount(self._graph.parts)[self._graph.parts[others]]
        return self._rng.choice(others, count, p=weights / weights.sum())

    def _near(self, kinds: Numbers, begins: Numbers, targets: Floats) -> Numbers:
        """Numbers (t, k) of the shapes nearby that tasks are told; -1: there are no more."""
        graph = self._graph
        found = np.full((len(kinds), min(NEIGHBOUR_COUNT, len(graph))), -1, np.int64)
        if not found.size:
            return found
        from scipy.spatial import cKDTree  # noqa: PLC0415

        places = np.where((kinds == TaskKind.ASIDE)[:, None], graph.tips[begins], targets)
        found[:] = cKDTree(graph.tips).query(places, found.shape[1])[1].reshape(found.shape)
        nodes = (graph.q * lever_metric(self._robot)).reshape(len(graph), 3 * len(self._robot))
        for i in np.flatnonzero(kinds == TaskKind.JOIN).tolist():
            others = np.flatnonzero(graph.parts != graph.parts[begins[i]])
            apart = np.linalg.norm(nodes[others] - nodes[begins[i]], axis=1)
            nearest = others[np.argsort(apart, kind="stable")[: found.shape[1]]]
            found[i, : len(nearest)], found[i, len(nearest) :] = nearest, -1
        return found


def _in_ball(rng: np.random.Generator, count: int) -> Floats:
    """Points (count, 3) drawn evenly in the unit ball."""
    aside = rng.normal(size=(count, 3))
    return aside / np.linalg.norm(aside, axis=1, keepdims=True) * rng.random((count, 1)) ** (1.0 / 3.0)
