"""Two trees of configurations, from a start and from goals, and the way where they meet: see `kernels.planning`."""

from functools import cached_property
from time import monotonic
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import ANSWER_WIDTH, VERDICT
from sinuous.kernels.between.sweep import sweep_size
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.planning.query import nodes_of, plan, plan_size, tighten
from sinuous.robot.robot import Robot, robot_group
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.between.steps import LOOSE_SECONDS, Prover, unproved

MOST_NODES, MOST_NUMBERS = 20_000, 8_000_000
"""Nodes of a tree, and numbers of all nodes."""

MOST_KNOTS = 4_000


class Way(NamedTuple):
    """Knots (T, n, 3) from a start to a goal, and what is proved of the steps between them (T - 1, 14)."""

    q: Floats
    answers: Floats


class Trees:
    """Both trees of one plan, in memory that is used again."""

    def __init__(self, robot: Robot, scene: Snapshot) -> None:
        n = len(robot)
        nodes = min(MOST_NODES, MOST_NUMBERS // (6 * n + 2))
        self._scene = scene
        self._robot, self._groups = robot, (robot_group(robot), scene._kernel_group)
        self._scratch, self._workspace = np.empty(sweep_size(n, len(scene))), np.empty(plan_size(n, nodes))
        self._q, self._answers = np.empty((MOST_KNOTS, n, 3)), np.empty((MOST_KNOTS, ANSWER_WIDTH))

    def grow(self, ends: Floats, seed: int, draws: tuple[int, int], seconds: float, shortcuts: int = 0) -> Way | None:
        """Grow by draws from the first to before the last of `draws`; when the first is 0, both trees are planted anew.

        `ends` (1 + g, n, 3): the start and goals, or more goals.
        """
        end = monotonic() + seconds
        asked = float(self._robot.mount), self._robot.mean_length, seconds, seed, *draws, shortcuts
        work = self._scratch, self._workspace, self._q, self._answers
        count, _, _ = plan(*self._groups, ends, asked, *work)
        way = self._proved(self._q[:count].copy(), self._answers[: count - 1].copy(), end) if count else None
        return way if way is not None and (way.answers[:, VERDICT] == CLEAR).all() else None

    def tighten(self, q: Floats, seed: int, seconds: float, shortcuts: int = 0) -> Way:
        """Leave out what can be left out of knots (T, n, 3); what lies between neighbours is clear."""
        end = monotonic() + seconds
        if len(q) > MOST_KNOTS:
            return self._proved(q, unproved(len(q) - 1), end)
        self._q[: len(q)] = q
        asked = float(self._robot.mount), self._robot.mean_length, seconds, seed, 0, 0, shortcuts
        work = self._scratch, self._workspace, self._q, self._answers
        count = tighten(*self._groups, len(q), asked, *work)
        return self._proved(self._q[:count].copy(), self._answers[: count - 1].copy(), end)

    def load(self) -> None:
        """Compile what grows trees, or load it."""
        still = np.zeros((1, len(self._robot), 3))
        self.grow(still, 0, (0, 0), 0.0)
        self.tighten(still, 0, 0.0)

    @cached_property
    def _prover(self) -> Prover:
        return Prover(self._robot, self._scene)

    def _proved(self, q: Floats, answers: Floats, end: float) -> Way:
        """Prove again, less exactly, what took too long to prove with a tight bound: among clouds and meshes.

        That ends at a time, and with the first step of which it is in vain.
        """
        for i in np.flatnonzero(answers[:, VERDICT] != CLEAR).tolist():
            seconds = min(LOOSE_SECONDS, end - monotonic())
            if seconds <= 0.0:
                break
            answers[i] = self._prover.prove(q[i : i + 2], slack=1.0, seconds=seconds)[0]
            if answers[i, VERDICT] != CLEAR:
                break
        return Way(q, answers)

    @property
    def reached(self) -> Floats:
        """The nodes of the start's tree (m, n, 3)."""
        return nodes_of(self._workspace, len(self._robot))

    @property
    def sizes(self) -> tuple[int, int]:
        """How many nodes the tree of the start has, and that of the goals."""
        first, second = (len(nodes_of(self._workspace, len(self._robot), side)) for side in (0, 1))
        return first, second


def load_trees(robot: Robot, scene: Snapshot) -> None:
    """Compile what grows trees, or load it."""
    Trees(robot, scene).load()
