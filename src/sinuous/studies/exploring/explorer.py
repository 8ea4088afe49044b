"""What a worker does while a place is explored: it finds shapes, and proves motions from them to shapes nearby.

A task brings all that it needs, so its answer depends on nothing else: neither on the number of workers, nor on time,
unless an attempt takes longer than `ATTEMPT_SECONDS`.
"""

from dataclasses import replace
from enum import IntEnum
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric, random_configuration, violated_by
from sinuous.motion.plan import PlanWork, Workspaces
from sinuous.motion.planning.query import Deadline
from sinuous.problem.target import Target
from sinuous.scene.scene import Scene
from sinuous.solver.options import SolveOptions
from sinuous.solver.shapes import Whole
from sinuous.solver.solver import Solver
from sinuous.studies.runs.engine import Arrays

ATTEMPT_SECONDS = 20.0
"""Seconds of one attempt, after which it is given up whatever was to be done."""

MOST_LINKS, LINK_TRIES = 4, 8
"""Most motions to shapes nearby that are kept of a shape that is found, and how many are tried."""

LINK_DRAWS = 64
"""Draws of trees where none of these is clear."""

JOIN_DRAWS = 1024
"""Draws of trees between two parts."""

LEAST_FRACTION = 1e-3
"""Least share of the way towards a random shape; shares are drawn evenly on a logarithmic scale."""

MOST_HALVINGS = 4
"""How often a motion that is not clear is tried again, half as far."""


class TaskKind(IntEnum):
    """What a task is."""

    EVEN = 0
    """Meet a position anywhere."""
    BESIDE = 1
    """Meet a position near the tip of a shape, from there."""
    ASIDE = 2
    """Move a shape towards a random one."""
    JOIN = 3
    """Find a way from a shape to one of another part."""


class Explorer:
    """Does tasks; may be pickled and sent to workers.

    Parameters
    ----------
    robot : Robot
    scene : Scene
        Nothing in it moves.
    options : SolveOptions
        Of positions anywhere.
    """

    def __init__(self, robot: Robot, scene: Scene, options: SolveOptions) -> None:
        self.robot, self.scene, self._options = robot, scene, options
        self._workspaces = Workspaces(robot)
        self._solvers: tuple[Solver, Solver] | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.robot, self.scene, self._options)

    def prepare(self) -> "Explorer":
        """Compile, or load, what exploring needs."""
        once = replace(self._options, max_starts=1, routes=False)
        anywhere, near = (Solver._of_checked(self.robot, self.scene, each) for each in (self._options, once))
        anywhere.warm("solve")
        self._solvers = anywhere, near
        with self._workspaces.lent(self.scene.snapshot()) as work:
            work.trees.load()
        return self

    def __call__(self, tasks: Arrays) -> Arrays:
        """Do the tasks of a chunk, or prove the motions between pairs of shapes."""
        with self._workspaces.lent(self.scene.snapshot()) as work:
            if "pairs" in tasks:
                return {"clear": np.array([work.prover.is_clear(*pair) for pair in tasks["pairs"]], np.bool_)}
            found = _Found(len(self.robot))
            for i in range(len(tasks["kind"])):
                task = {name: values[i] for name, values in tasks.items()}
                found.own.append(self._do(work, found, task))
            return found.block()

    def _do(self, work: PlanWork, found: "_Found", raw: dict[str, Any]) -> int:
        """Do one task; return the number of the shape that was found, 0: none."""
        kind, numbers = TaskKind(int(raw["kind"])), raw["numbers"][raw["numbers"] >= 0]
        near, begin, seed = raw["near"][: len(numbers)], raw["begin"], int(raw["seed"])
        task = _Task(numbers, near, seed, Deadline(ATTEMPT_SECONDS))
        if kind is TaskKind.JOIN:
            self._join(work, found, begin, int(raw["own"]), task)
            return 0
        q = self._moved(work, begin, seed) if kind is TaskKind.ASIDE else self._met(kind, raw["target"], begin)
        if q is None:
            return 0
        order = np.argsort(self._apart(q, near), kind="stable")
        return self._link(work, found, q, task._replace(numbers=numbers[order], near=near[order]))

    def _met(self, kind: TaskKind, target: Floats, begin: Floats) -> Floats | None:
        """Meet a position: from anywhere, or from one shape."""
        assert self._solvers is not None
        if kind is TaskKind.EVEN:
            solution = self._solvers[0].solve(Target(target), time=ATTEMPT_SECONDS)
        else:
            solution = self._solvers[1].solve(Target(target), begin, time=ATTEMPT_SECONDS)
        return np.array(solution.configuration) if solution.solved else None

    def _moved(self, work: PlanWork, begin: Floats, seed: int) -> Floats | None:
        """Move a shape towards a random one, as far as that is proved."""
        rng = np.random.default_rng(seed)
        away = random_configuration(self.robot, rng) - begin
        if rng.random() < 0.5:  # of all segments at once hardly any motion is clear in a narrow place
            first, last = np.sort(rng.integers(0, len(begin), 2))
            away[:first], away[last + 1 :] = 0.0, 0.0
        share = np.exp(rng.uniform(np.log(LEAST_FRACTION), 0.0))
        for _ in range(MOST_HALVINGS):
            q: Floats = begin + share * away
            if violated_by(self.robot, q) is None and work.prover.is_clear(begin, q):
                return q
            share *= 0.5
        return None

    def _link(self, work: PlanWork, found: "_Found", q: Floats, task: "_Task") -> int:
        """Keep a shape, and motions to shapes nearby; return its number."""
        own = found.add(q[None])
        count = 0
        for number, other in zip(task.numbers[:LINK_TRIES].tolist(), task.near, strict=False):
            if task.deadline.left() > 0.0 and work.prover.is_clear(q, other):
                found.edges.append((own, number))
                count += 1
                if count == MOST_LINKS:
                    return own
        if count == 0 and len(task.near) and task.deadline.left() > 0.0:
            path = work.trees.grow(np.stack([q, *task.near[:LINK_TRIES]]), task.seed, (0, LINK_DRAWS), task.deadline)
            if path is not None:
                found.add_way(own, path.q, task)
        return own

    def _join(self, work: PlanWork, found: "_Found", begin: Floats, own: int, task: "_Task") -> None:
        """Find a way from a shape to one of those nearby."""
        path = work.trees.grow(np.stack([begin, *task.near]), task.seed, (0, JOIN_DRAWS), task.deadline)
        if path is not None:
            found.add_way(own, path.q, task)

    def _apart(self, q: Floats, others: Floats) -> Floats:
        moves = ((others - q) * lever_metric(self.robot)).reshape(len(others), q.size)
        return np.sqrt(np.einsum("mk,mk->m", moves, moves))


class _Task(NamedTuple):
    """What a task is told: numbers (k,) of shapes nearby, these (k, n, 3), its seed, and the time that it has."""

    numbers: Whole
    near: Floats
    seed: int
    deadline: Deadline


class _Found:
    """Shapes and motions that the tasks of a chunk found: shape i of these has the number -1 - i.

    Attributes
    ----------
    edges : list of (int, int)
    own : list of int
        Of each task the number of its shape, 0: it found none.
    """

    def __init__(self, segments: int) -> None:
        self._q, self._count = [np.empty((0, segments, 3))], 0
        self.edges, self.own = list[tuple[int, int]](), list[int]()

    def add(self, q: Floats) -> int:
        """Keep shapes (m, n, 3); return the number of the first."""
        self._q.append(q)
        self._count += len(q)
        return -1 - (self._count - len(q))

    def add_way(self, own: int, q: Floats, task: "_Task") -> None:
        """Keep the motions along a path (T, n, 3) from a shape that is kept to one of those nearby."""
        known = zip(task.numbers, task.near, strict=True)
        last = next(int(number) for number, other in known if np.array_equal(other, q[-1]))
        first = self.add(q[1:-1])
        way = [own, *(first - i for i in range(len(q) - 2)), last]
        self.edges += pairwise(way)

    def block(self) -> Arrays:
        """Return what travels."""
        edges = np.array(self.edges, np.int64).reshape(-1, 2)
        return {"q": np.concatenate(self._q), "edges": edges, "own": np.array(self.own, np.int64)}
