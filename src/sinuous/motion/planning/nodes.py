"""Nodes of a tree of configurations that grows one by one, from Python."""

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import lever_metric
from sinuous.motion.planning.ends import Chain
from sinuous.robot.robot import Robot

FIRST = 64
"""Nodes that there is room for at first; twice as many whenever it is used up."""


class Nodes:
    """Configurations that one end of a plan reaches, each by a proved motion from the one before it.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self._metric = lever_metric(robot)
        self._q, self._parents = np.empty((FIRST, len(robot), 3)), list[int]()

    def __len__(self) -> int:
        return len(self._parents)

    def __getitem__(self, node: int) -> Floats:
        q: Floats = self._q[node]
        return q

    def add(self, q: Floats, parent: int) -> int:
        """Add a configuration (n, 3) that is reached from a node (-1: from none), and return its node."""
        if len(self) == len(self._q):
            self._q = np.concatenate([self._q, np.empty_like(self._q)])
        self._q[len(self)] = q
        self._parents.append(parent)
        return len(self) - 1

    def plant(self, chain: Chain) -> None:
        """Add a chain, the first of which is an end of the plan."""
        parent = -1
        for q in chain:
            parent = self.add(q, parent)

    def apart(self, p: Floats, q: Floats) -> float:
        """Distance of two configurations (n, 3); see `times.distances`."""
        return float(np.linalg.norm((p - q) * self._metric))

    def nearest(self, q: Floats) -> int:
        """The node that is nearest to a configuration (n, 3)."""
        return int(np.square((self._q[: len(self)] - q) * self._metric).sum(axis=(1, 2)).argmin())

    def way(self, node: int) -> Chain:
        """The nodes from an end of the plan to this one."""
        found = []
        while node >= 0:
            found.append(self._q[node].copy())
            node = self._parents[node]
        return found[::-1]
