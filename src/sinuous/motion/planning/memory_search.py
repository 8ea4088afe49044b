"""Walks along motions that a memory holds: a roadmap (Kavraki et al. 1996), whose edges are proved again when walked.

The ends are joined to shapes nearby, A* finds the way between these, and the path is shortened and proved like any
other. An edge that is not clear any more, because the scene is another one, is closed, and the next way is tried
(lazily, Bohlin & Kavraki 2000).
"""

from collections.abc import Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.kernels.planning.walk import walk, walk_size
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric
from sinuous.motion.planning.query import FixedGoal, ProvedPath, Query, TargetGoals
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.motion.planning.tree import Chain
from sinuous.problem.target import target_table
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Prover
from sinuous.solver.memory import Memory
from sinuous.solver.shapes import POSE_SIZE, Graph, Whole

CLOSEST, LINKS = 64, 2
"""Shapes with the nearest poses of which those with the nearest configurations are tried, and to how many an end is
joined."""

STRAIGHT, DRAWS = 8, 64
"""Shapes to which straight motions are tried, and draws of trees that grow to the same where none is clear."""

SOLVES = 6
"""Shapes from which a target is solved."""

MOST_WAYS = 100
"""Ways that are tried."""

MOST_NODES = 10_000
"""Nodes of a way."""

Link = tuple[int, Chain]
"""A shape, by its number, and the configurations of a clear path that leads to it, without the shape itself."""


class MemorySearch:
    """Finds paths for a robot in a scene along the motions of a graph, one after the other.

    Parameters
    ----------
    robot : Robot
    scene : Snapshot
    graph : Graph
    trees : RRTConnect
        Of this robot and scene.
    """

    def __init__(self, robot: Robot, scene: Snapshot, graph: Graph, trees: RRTConnect) -> None:
        self.graph, self.scene = graph, scene
        self._robot, self._trees, self._prover = robot, trees, Prover(robot, scene)
        metric = lever_metric(robot)
        self._nodes = (graph.q * metric).reshape(len(graph), 3 * len(self._robot))
        self._begins, self._neighbours, self._motions = graph.neighbours
        self._closed = np.zeros(max(1, len(graph.edges)), np.bool_)
        self._ends = np.full(len(graph), np.inf)
        self._way = np.empty(MOST_NODES, np.int64)
        self._workspace = np.empty(walk_size(len(graph), len(self._neighbours)))
        self._metric = metric
        self._walk(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))  # compiled, or loaded

    def find_path(self, query: Query, goals: FixedGoal | TargetGoals) -> ProvedPath | None:
        """Return a path to a goal, shortened as the query asks; `None` where no walk leads to one."""
        begins = self._links(query, query.start)
        if not begins:
            return None
        parts = np.unique(self.graph.parts[[node for node, _ in begins]])
        for goal in self._offered(query, goals, parts):
            ends = self._links(query, goal, parts)
            path = self._joined(query, goal, begins, ends) if ends else None
            if path is not None:
                shortcuts = query.shortcuts
                return self._trees.shorten(path.q, query.seed, query.deadline, shortcuts) if shortcuts else path
        return None

    def _offered(self, query: Query, goals: FixedGoal | TargetGoals, parts: Whole) -> Iterator[Floats]:
        """Yield the goal, or configurations (n, 3) that meet the targets, each solved from a shape near them."""
        if isinstance(goals, FixedGoal):
            yield goals.q
            return
        rows = target_table(self._robot, tuple(goals.targets))[None]
        for node in self._within(self.graph.near(rows, CLOSEST)[0], parts)[:SOLVES]:
            if query.deadline.left() <= 0.0:
                return
            goal = goals.near(self.graph.q[node].copy())
            if goal is not None:
                yield goal

    def _links(self, query: Query, q: Floats, parts: Whole | None = None) -> list[Link]:
        """Join a configuration (n, 3) to shapes nearby, of some parts of the graph or of any."""
        deadline = query.deadline
        near = self._within(self.graph.near_shapes(q[None], CLOSEST)[0], parts)
        near = near[np.argsort(self._apart(q, near), kind="stable")][:STRAIGHT]
        found: list[Link] = []
        for node in near.tolist():
            if deadline.left() > 0.0 and self.joins(q, self.graph.q[node]):
                found.append((node, [q]))
                if len(found) == LINKS:
                    return found
        if not found and len(near) and deadline.left() > 0.0:
            path = self._trees.grow(np.stack([q, *self.graph.q[near]]), query.seed, (0, DRAWS), deadline)
            if path is not None:
                node = next(int(i) for i in near if np.array_equal(self.graph.q[i], path.q[-1]))
                found.append((node, list(path.q[:-1])))
        return found

    def joins(self, one: Floats, other: Floats) -> bool:
        """Whether the motion from one configuration (n, 3) to another is proved clear."""
        return self._prover.is_clear(one, other)

    def _within(self, nodes: Whole, parts: Whole | None) -> Whole:
        return nodes if parts is None else nodes[np.isin(self.graph.parts[nodes], parts)]

    def _apart(self, q: Floats, nodes: Whole) -> Floats:
        moves = self._nodes[nodes] - (q * self._metric).ravel()
        return np.sqrt(np.einsum("mk,mk->m", moves, moves))

    def _joined(self, query: Query, goal: Floats, begins: list[Link], ends: list[Link]) -> ProvedPath | None:
        """Walk from one of the shapes that a start is joined to, to one that a goal is joined to."""
        before, after = dict(begins), dict(ends)
        starts, goals = np.array(list(before)), np.array(list(after))
        costs = self._apart(query.start, starts)
        self._ends[goals] = self._apart(goal, goals)
        try:
            for _ in range(MOST_WAYS):
                way = self._walk(starts, goals, costs)
                if not len(way) or query.deadline.left() <= 0.0:
                    return None
                chain = [*before[int(way[0])], *self.graph.q[way], *after[int(way[-1])][::-1]]
                path = self._trees.shorten(np.stack(chain), query.seed, query.deadline)
                if (path.answers[:, VERDICT] == CLEAR).all():
                    return path
                if not self._close(way):
                    return None
        finally:
            self._ends[goals] = np.inf
        return None

    def _walk(self, starts: Whole, goals: Whole, costs: Floats) -> Whole:
        """Numbers (w,) of the shapes from one of the starts to one of the goals; none where there is no way."""
        graph = self._nodes, self._begins, self._neighbours, self._motions, self._closed
        count = walk(*graph, starts, goals, costs, self._ends, self._workspace, self._way)
        return self._way[:count].copy()

    def _close(self, way: Whole) -> bool:
        """Close the edges of a way that are not clear; say whether there are any."""
        any_ = False
        for one, other in zip(way[:-1].tolist(), way[1:].tolist(), strict=True):
            if not self.joins(self.graph.q[one], self.graph.q[other]):
                at = self._begins[one] + np.searchsorted(
                    self._neighbours[self._begins[one] : self._begins[one + 1]], other
                )
                self._closed[self._motions[at]] = any_ = True
        return any_


def search_memory(
    memory: Memory | None, robot: Robot, scene: Snapshot, trees: RRTConnect, before: MemorySearch | None
) -> MemorySearch | None:
    """Return what walks along the motions of a memory in a scene: `before`, while both are the same.

    There is none where a memory holds no motions, nor under load, for which none of them was proved.
    """
    graph = None if memory is None or robot.has_external_load else memory._shapes.graph
    if graph is None or not len(graph):
        return None
    same = before is not None and before.graph is graph and before.scene is scene
    return before if same else MemorySearch(robot, scene, graph, trees)


def remember(memory: Memory | None, robot: Robot, path: ProvedPath | None) -> None:
    """Let a memory learn a path that trees have found."""
    if memory is not None and path is not None and not robot.has_external_load:
        memory._learn_way(path.q)


def load_memory_search(robot: Robot, scene: Snapshot) -> None:
    """Compile what walks, or load it."""
    nothing = np.empty((0, len(robot), 3)), np.empty((0, len(robot), POSE_SIZE)), np.empty((0, 2), np.int64)
    MemorySearch(robot, scene, Graph(robot, *nothing), RRTConnect(robot, scene))
