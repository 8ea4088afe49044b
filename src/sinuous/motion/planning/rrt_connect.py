"""RRT-Connect (Kuffner & LaValle 2000): two trees of straight edges, from the start and from the goals.

The trees grow in a kernel, see `kernels.planning.trees`. This module holds their memory.
"""

from functools import cached_property

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import ANSWER_WIDTH, VERDICT
from sinuous.kernels.certificate.sweep import sweep_size
from sinuous.kernels.planning.query import nodes_of, plan, plan_size
from sinuous.model.robot import Robot, robot_group
from sinuous.motion.configurations import lever_metric
from sinuous.motion.planning.query import Deadline, ProvedPath
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LOOSE_SECONDS, Prover, unproved

MOST_NODES = 20_000
"""Nodes of one tree."""

MOST_NUMBERS = 8_000_000
"""Numbers (float64) of all nodes: robots of many segments have fewer nodes."""

MOST_KNOTS = 4_000
"""Knots of a path."""


class RRTConnect:
    """The memory of both trees, for one plan after the other of a robot in a scene.

    `prover`: of the same robot and scene, where there is one.
    """

    def __init__(self, robot: Robot, scene: Snapshot, prover: Prover | None = None) -> None:
        n = len(robot)
        nodes = min(MOST_NODES, MOST_NUMBERS // (6 * n + 2))
        self._scene, self._robot, self._given_prover = scene, robot, prover
        self._scratch, self._workspace = np.empty(sweep_size(n, len(scene))), np.empty(plan_size(n, nodes))
        self._workspace[:n] = lever_metric(robot)[:, 0] ** 2
        self._q, self._answers = np.empty((MOST_KNOTS, n, 3)), np.empty((MOST_KNOTS, ANSWER_WIDTH))

    def grow(
        self, roots: Floats, seed: int, draws: tuple[int, int], deadline: Deadline, shortcuts: int = 0
    ) -> ProvedPath | None:
        """Grow both trees by the draws from the first to before the last of `draws`.

        Parameters
        ----------
        roots : ndarray (1 + g, n, 3)
            The start and goals. When the first draw is 0, both trees are planted anew; otherwise the goals are more
            roots of the second tree.
        shortcuts : int
            How many random shortcuts are tried on the path.

        Returns
        -------
        ProvedPath or None
            `None` where the trees did not meet, or an edge between them could not be proved in time.
        """
        asked = self._asked(seed, draws, deadline, shortcuts)
        count = plan(*self._groups, roots, 0, asked, *self._work)
        path = self._proved(self._q[:count].copy(), self._answers[: count - 1].copy(), deadline) if count else None
        return path if path is not None and (path.answers[:, VERDICT] == CLEAR).all() else None

    def shorten(self, q: Floats, seed: int, deadline: Deadline, shortcuts: int = 0) -> ProvedPath:
        """Leave out knots (T, n, 3) where the motion past them is clear; what lies between neighbours is clear."""
        if len(q) > MOST_KNOTS:
            return self._proved(q, unproved(len(q) - 1), deadline)
        self._q[: len(q)] = q
        asked = self._asked(seed, (0, 0), deadline, shortcuts)
        count = plan(*self._groups, q[:1].copy(), len(q), asked, *self._work)
        return self._proved(self._q[:count].copy(), self._answers[: count - 1].copy(), deadline)

    def load(self) -> None:
        """Compile the kernels, or load them."""
        self.grow(np.zeros((1, len(self._robot), 3)), 0, (0, 0), Deadline(0.0))

    @property
    def reached(self) -> Floats:
        """The nodes of the start's tree (m, n, 3)."""
        return nodes_of(self._workspace, len(self._robot))

    @property
    def _groups(self) -> tuple[Floats, Floats]:
        return robot_group(self._robot), self._scene._kernel_group

    @property
    def _work(self) -> tuple[Floats, Floats, Floats, Floats]:
        return self._scratch, self._workspace, self._q, self._answers

    def _asked(
        self, seed: int, draws: tuple[int, int], deadline: Deadline, shortcuts: int
    ) -> tuple[float, float, float, int, int, int, int]:
        """Return the numbers that the kernels take; see `kernels.planning.query.PlanRequest`."""
        return float(self._robot.mount), self._robot.mean_length, deadline.left(), seed, *draws, shortcuts

    @cached_property
    def _prover(self) -> Prover:
        return self._given_prover or Prover(self._robot, self._scene)

    def _proved(self, q: Floats, answers: Floats, deadline: Deadline) -> ProvedPath:
        """Prove edges again that took too long to prove with a tight bound: that they are clear, without a bound.

        Among clouds and meshes a tight bound takes long. The first edge that is not proved is the last that is tried.
        """
        for i in np.flatnonzero(answers[:, VERDICT] != CLEAR).tolist():
            seconds = min(LOOSE_SECONDS, deadline.left())
            if seconds <= 0.0:
                break
            answers[i] = self._prover.prove(q[i : i + 2], slack=1.0, seconds=seconds)[0]
            if answers[i, VERDICT] != CLEAR:
                break
        self._prover.keep_tensions(q, answers)
        return ProvedPath(q, answers)


def load_trees(robot: Robot, scene: Snapshot) -> None:
    """Compile what grows trees, or load it."""
    if not robot.has_external_load:
        RRTConnect(robot, scene).load()
