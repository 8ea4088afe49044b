"""Trees whose edges are retracted from contact: where an edge runs into an obstacle, the body is pushed off it.

Hardly any straight edge leads from one fold of a long body in a cell to another: something touches at once. A body that
slides along the walls, and bends where they want it to, gets much farther. So an extension is a step towards a
configuration, and one descent that leads the body off what it overlaps, with the tip about where it is: a retraction as
in Zhang & Manocha (2008). Every edge is proved clear.
"""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.motion.configurations import random_configuration
from sinuous.motion.planning.local_planner import CLEARANCES, LocalPlanner
from sinuous.motion.planning.tree import Chain, Tree

FIRST, LONGEST, SHORTEST = 0.1, 0.5, 0.01
"""Steps, in robot lengths: twice as long after one that succeeds, half as long after one that does not."""

NEARER = 0.1
"""A step must lead nearer by this share of its length."""

FAR = 0.5
"""How far a tree grows towards what was drawn, in robot lengths; towards the other tree it grows as far as it can."""

ACROSS = 0.5
"""Share of draws that are a node of the other tree."""

RUN = 0.75
"""Up to this share of draws, a run of segments of a node changes; in the others, all segments change."""

LITTLE = 0.05, 0.5
"""How much of the way from a node to what was drawn is gone when all segments change."""


class Reached(NamedTuple):
    """The last node on the way to a configuration, and whether that is the configuration."""

    node: int
    there: bool


class ContactRetractionTrees:
    """Two trees, of the start and of the goals, that grow towards each other.

    Parameters
    ----------
    local : LocalPlanner
    seed : int
    """

    def __init__(self, local: LocalPlanner, seed: int) -> None:
        self._local, self._rng = local, np.random.default_rng(seed)
        robot = local.robot
        self._planted = [0, 0]
        self._trees = (Tree(robot), Tree(robot))
        self._draws = 0

    def plant(self, side: int, chains: list[Chain]) -> None:
        """Plant those chains of all that are known on one side that are not in its tree yet."""
        for chain in chains[self._planted[side] :]:
            self._trees[side].plant(chain)
        self._planted[side] = len(chains)

    def grow(self, draws: int) -> Chain | None:
        """Grow by so many draws; return configurations (n, 3) from the start to a goal where the trees meet."""
        for _ in range(draws):
            if self._local.deadline.left() <= 0.0:
                break
            self._draws += 1
            met = self._grow_once(self._draws % 2, self._room())
            if met is not None:
                return met
        return None

    def random_branch(self, side: int) -> Chain:
        """Return the configurations from a root of a tree to a node that is drawn at random."""
        tree = self._trees[side]
        return tree.chain(int(self._rng.integers(len(tree))))

    def _room(self) -> float:
        """The room of the next steps, in radii: little mostly, none or more of it now and then."""
        return (CLEARANCES[1], CLEARANCES[1], CLEARANCES[0], 0.0)[self._draws // 2 % 4]

    def _grow_once(self, side: int, room: float) -> Chain | None:
        own, other = self._trees[side], self._trees[1 - side]
        kind = self._rng.random()
        if kind < ACROSS:
            goal = other.q[int(self._rng.integers(len(other)))].copy()
            reached = self._connect(own, own.nearest(goal), goal, np.inf, room)
        else:
            node = int(self._rng.integers(len(own)))
            q = own.q[node]
            goal = self._change_run(q) if kind < RUN else self._change_all(q)
            reached = self._connect(own, node, goal, FAR, room)
        end = own.q[reached.node].copy()
        met = self._connect(other, other.nearest(end), end, np.inf, room)
        if not met.there:
            return None
        chains = own.chain(reached.node), other.chain(met.node)
        return [*chains[side], *chains[1 - side][-2::-1]]

    def _connect(self, tree: Tree, node: int, goal: Floats, far: float, room: float) -> Reached:
        """Extend a tree from a node towards a configuration (n, 3), again and again, up to `far` (robot lengths)."""
        unit = self._local.robot.mean_length
        left = all_the_way = tree.apart(tree.q[node], goal)
        step = FIRST * unit
        while left > 0.0 and all_the_way - left < far * unit and step >= SHORTEST * unit:
            part = min(1.0, step / left)
            new = self._extend(tree, node, goal, part, room)
            if new is None:
                step *= 0.5
            else:
                node, left = new, tree.apart(tree.q[new], goal)
                step = min(2.0 * step, LONGEST * unit)
        return Reached(node, left == 0.0)

    def _extend(self, tree: Tree, node: int, goal: Floats, part: float, room: float) -> int | None:
        """Add a node a part of the way to a goal (n, 3), retracted from contact; `None` where no edge is clear."""
        q, local = tree.q[node], self._local
        if part == 1.0 and local.is_clear(q, goal):
            return tree.add(goal, node)
        new = local.retract(q + part * (goal - q), room)
        if new is None or tree.apart(new, goal) > (1.0 - NEARER * part) * tree.apart(q, goal):
            return None
        return tree.add(new, node) if local.is_clear(q, new) else None

    def _change_run(self, q: Floats) -> Floats:
        """The configuration (n, 3), but for a random run of segments."""
        first, last = np.sort(self._rng.integers(0, len(q), 2))
        result, drawn = q.copy(), random_configuration(self._local.robot, self._rng)
        result[first : last + 1] = drawn[first : last + 1]
        return result

    def _change_all(self, q: Floats) -> Floats:
        """A configuration some way from one (n, 3) to a random one."""
        return q + self._rng.uniform(*LITTLE) * (random_configuration(self._local.robot, self._rng) - q)
