"""Trees whose bodies give way: where an edge runs into an obstacle, the body is pushed off, and goes on beside it.

Hardly any straight edge leads from one fold of a long body in a cell to another: something touches at once. A body that
slides along the walls, and bends where they want it to, gets much farther. A step towards a configuration is made
there, and one descent leads it off what it overlaps, with the tip about where it is; that is a retraction as in Zhang &
Manocha (2008). Every step is proved.
"""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import within_limits
from sinuous.motion.planning.ends import Chain
from sinuous.motion.planning.means import ROOMS, Means
from sinuous.motion.planning.nodes import Nodes

FIRST, LONGEST, SHORTEST = 0.1, 0.5, 0.01
"""Steps, in robot lengths: twice as long after one that succeeds, half as long after one that does not."""

NEARER = 0.1
"""A step must lead nearer by this share of its length."""

FAR = 0.5
"""How far a tree grows towards what was drawn, in robot lengths; towards the other tree it grows as far as it can."""

ACROSS, RUN = 0.5, 0.75
"""Up to the first share of draws, a node of the other tree is gone to; up to the second, a run of segments of a node
changes; in others, all of them."""

LITTLE = 0.05, 0.5
"""How much of the way from a node to what was drawn is gone when all segments change."""

BENT = 2.0 * np.pi
"""Largest bend that is drawn, rad, where a segment has no limit."""

MOST_NODES = 4096
"""Of a tree; then both are planted anew: the time that such trees take has a heavy tail."""


class Reached(NamedTuple):
    """The last node on the way to a configuration, and whether that is the configuration."""

    node: int
    there: bool


class Yielding:
    """Two trees, of the start and of the goals, that grow towards each other.

    Parameters
    ----------
    means : Means
    seed : int
    """

    def __init__(self, means: Means, seed: int) -> None:
        self._means, self._rng = means, np.random.default_rng(seed)
        robot = means.robot
        self._limits = np.array([(*segment.length, min(segment.max_bend, BENT)) for segment in robot.segments]).T
        self._chains: tuple[list[Chain], list[Chain]] = ([], [])
        self._trees = (Nodes(robot), Nodes(robot))
        self._turns = 0

    def plant(self, side: int, chains: list[Chain]) -> None:
        """Plant those chains of all that are known on one side that are not in its tree yet."""
        for chain in chains[len(self._chains[side]) :]:
            self._chains[side].append(chain)
            self._trees[side].plant(chain)

    def grow(self, draws: int) -> Chain | None:
        """Grow by so many draws; return configurations (n, 3) from the start to a goal where the trees meet."""
        for _ in range(draws):
            if self._means.watch.seconds_left() <= 0.0:
                break
            self._turns += 1
            if max(map(len, self._trees)) > MOST_NODES:
                self._plant_anew()
            met = self._grow_once(self._turns % 2, self._room())
            if met is not None:
                return met
        return None

    def _plant_anew(self) -> None:
        chains, robot = self._chains, self._means.robot
        self._chains, self._trees = ([], []), (Nodes(robot), Nodes(robot))
        for side in (0, 1):
            self.plant(side, chains[side])

    def _room(self) -> float:
        """The room of the next steps, in radii: little mostly, none or more of it now and then."""
        return (ROOMS[1], ROOMS[1], ROOMS[0], 0.0)[self._turns // 2 % 4]

    def _grow_once(self, side: int, room: float) -> Chain | None:
        own, other = self._trees[side], self._trees[1 - side]
        kind = self._rng.random()
        if kind < ACROSS:
            goal = other[int(self._rng.integers(len(other)))].copy()
            reached = self._towards(own, own.nearest(goal), goal, np.inf, room)
        else:
            at = int(self._rng.integers(len(own)))
            goal = self._run_of(own[at]) if kind < RUN else self._mixed(own[at])
            reached = self._towards(own, at, goal, FAR, room)
        end = own[reached.node].copy()
        met = self._towards(other, other.nearest(end), end, np.inf, room)
        if not met.there:
            return None
        ways = own.way(reached.node), other.way(met.node)
        return [*ways[side], *ways[1 - side][-2::-1]]

    def _towards(self, tree: Nodes, at: int, goal: Floats, far: float, room: float) -> Reached:
        """Grow from a node towards a configuration (n, 3), no farther than `far` (robot lengths), giving way."""
        unit = self._means.robot.mean_length
        left = all_the_way = tree.apart(tree[at], goal)
        step = FIRST * unit
        while left > 0.0 and all_the_way - left < far * unit and step >= SHORTEST * unit:
            part = min(1.0, step / left)
            new = self._step(tree[at], goal, part, room)
            nearer = np.inf if new is None else tree.apart(new, goal)
            if new is None or nearer > (1.0 - NEARER * part) * left or not self._means.is_clear(tree[at], new):
                step *= 0.5
                continue
            at, left = tree.add(new, at), nearer
            step = min(2.0 * step, LONGEST * unit)
        return Reached(at, left == 0.0)

    def _step(self, q: Floats, goal: Floats, part: float, room: float) -> Floats | None:
        """Go a part of the way from `q` to `goal` (n, 3), and give way to what is there."""
        if part == 1.0 and self._means.is_clear(q, goal):
            return goal
        return self._means.give_way(q + part * (goal - q), room)

    def _drawn(self) -> Floats:
        """A random configuration (n, 3) within the limits of segments."""
        low, high, most = self._limits
        angle, bend = 2.0 * np.pi * self._rng.random(len(low)), most * np.sqrt(self._rng.random(len(low)))
        drawn = [bend * np.cos(angle), bend * np.sin(angle), self._rng.uniform(low, high)]
        result: Floats = within_limits(self._means.robot, np.stack(drawn, axis=-1)[None])[0]
        return result

    def _run_of(self, q: Floats) -> Floats:
        """The configuration (n, 3), but for a random run of segments."""
        first, last = np.sort(self._rng.integers(0, len(q), 2))
        result, drawn = q.copy(), self._drawn()
        result[first : last + 1] = drawn[first : last + 1]
        return result

    def _mixed(self, q: Floats) -> Floats:
        """A configuration some way from one (n, 3) to a random one."""
        return q + self._rng.uniform(*LITTLE) * (self._drawn() - q)
