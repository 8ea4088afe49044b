"""A tree of configurations that is extended from Python (LaValle 2006, section 5.5).

Two planners share it, each with an extension of its own: straight edges in time (`timed_tree`), and edges that are
retracted from contact (`contact_retraction`). Straight edges among obstacles that stand still need many more nodes:
these trees grow in a kernel (`rrt_connect`).
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric

Chain = list[Floats]
"""Configurations (n, 3); the motion from each to the next is proved clear, and so is the one back."""

FIRST_NODES = 64
"""Nodes that there is room for at first; the room doubles whenever it is used up."""


class Tree:
    """Configurations that roots reach, each by an edge from its parent that is proved clear.

    Parameters
    ----------
    robot : Robot

    Attributes
    ----------
    parents : list of int
        The node from which each node was reached; -1: it is a root.
    proofs : list of (ndarray (14,) or None)
        What is proved of the edge to each node, where that is kept; see `kernels.certificate.query`.
    """

    def __init__(self, robot: Robot) -> None:
        self._metric = lever_metric(robot)
        self._q, self._times = np.empty((FIRST_NODES, len(robot), 3)), np.empty(FIRST_NODES)
        self.parents, self.proofs = list[int](), list[Floats | None]()

    def __len__(self) -> int:
        return len(self.parents)

    @property
    def q(self) -> Floats:
        """Configurations (m, n, 3) of all nodes."""
        return self._q[: len(self)]

    @property
    def times(self) -> Floats:
        """Times (m,) of all nodes; 0 where nobody said it."""
        return self._times[: len(self)]

    def add(self, q: Floats, parent: int = -1, time: float = 0.0, proof: Floats | None = None) -> int:
        """Add a configuration (n, 3) that is reached from a node, and return its node."""
        node = len(self)
        if node == len(self._q):
            self._q = np.concatenate([self._q, np.empty_like(self._q)])
            self._times = np.concatenate([self._times, np.empty_like(self._times)])
        self._q[node], self._times[node] = q, time
        self.parents.append(parent)
        self.proofs.append(proof)
        return node

    def plant(self, chain: Chain) -> None:
        """Add a chain whose first configuration is a root."""
        parent = -1
        for q in chain:
            parent = self.add(q, parent)

    def apart(self, p: Floats, q: Floats) -> float:
        """Distance of two configurations (n, 3), in the length unit; see `configurations.distances`."""
        return float(np.linalg.norm((p - q) * self._metric))

    def distances(self, q: Floats) -> Floats:
        """Distances (m,) of all nodes from a configuration (n, 3), in the length unit."""
        moves = (self.q - q) * self._metric
        return np.sqrt(np.einsum("mnk,mnk->m", moves, moves))

    def nearest(self, q: Floats) -> int:
        """Return the node that is nearest to a configuration (n, 3)."""
        return int(self.distances(q).argmin())

    def branch(self, node: int) -> list[int]:
        """Return the nodes from a root to this one."""
        found = []
        while node >= 0:
            found.append(node)
            node = self.parents[node]
        return found[::-1]

    def chain(self, node: int) -> Chain:
        """Return the configurations from a root to a node."""
        return list(self.q[self.branch(node)])
