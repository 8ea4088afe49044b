"""The compiled tick of a robot: its groups, a workspace for each thread, and its answers."""

import threading
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.velocity import asked as a
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.working import most_bounds, most_rows, tick_size
from sinuous.problem.problem import settings_group
from sinuous.problem.target import Tolerance
from sinuous.robot.rates import Changes, Rates
from sinuous.robot.robot import Robot, robot_group
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.velocity.boxes import Boxes


class Ask(NamedTuple):
    """What a tick is asked for.

    Attributes
    ----------
    kind : int
        See `sinuous.kernels.velocity.asked`.
    motion : sequence of float
        Of the tip (6), rad and length unit.
    targets : ndarray (t, 15)
    rounds : int
    wish : float
        Clearance that is wished for.
    seconds : float
    """

    kind: int
    motion: tuple[float, ...]
    targets: Floats
    rounds: int
    wish: float
    seconds: float


Scratch = tuple[Floats, Floats, tuple[int, int], int]
"""The group of what is asked, the workspace, room for bounds and rows, and how many numbers an answer has."""


class Stepper:
    """What makes the steps of a robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    tolerance : Tolerance
        With numbers for all that is not said.
    """

    def __init__(self, robot: Robot, tolerance: Tolerance) -> None:
        self._robot = robot
        self._group = robot_group(robot)
        self._settings = settings_group(robot, tolerance)
        self._boxes = Boxes(robot, Changes())
        self._free = self._boxes
        self._local = threading.local()

    def boxes(self, most: Rates | Changes | None) -> Boxes:
        """Limits and rates as the kernel reads them; those of the last call are kept."""
        if most is None:
            return self._free
        kept = self._boxes
        if kept.most is not most:
            kept = self._boxes = Boxes(self._robot, most)
        return kept

    def run(self, scene: Snapshot, ask: Ask, initial: Floats, asked: tuple[Boxes, float, Floats | None]) -> Floats:
        """Make a tick from `initial` (n, 3) and return the answer, see `kernels.velocity.query`.

        `asked`: how far everything may move a second; how many seconds; and the velocity before, or `None`.
        """
        boxes, dt, velocity = asked
        table = scene._kernel_group
        sizes = len(self._robot), int(table[0]), len(ask.targets), len(boxes.lines)
        group, workspace, room, size = self._scratch(sizes, boxes, dt)
        group[: a.HEADER] = (ask.kind, *ask.motion, ask.rounds, ask.wish, ask.seconds, sizes[3], *room)
        if velocity is not None:
            boxes.write_before(group[a.HEADER :], dt, velocity)
        answer = np.empty(size)
        t.tick(self._group, table, self._settings, ask.targets, group, initial, workspace, answer)
        return answer

    def _scratch(self, sizes: tuple[int, int, int, int], boxes: Boxes, dt: float) -> Scratch:
        """Scratch of this thread, with the boxes of such a tick in it; that of the last call is kept."""
        kept: Scratch | None = getattr(self._local, "scratch", None)
        if kept is None or self._local.sizes != sizes:
            n, m, _, p = self._local.sizes = sizes
            rows = most_rows(n)
            group = np.empty(a.HEADER + boxes.boxes.size + boxes.lines.size)
            size = t.SHAPE + 3 * n + t.PUSHING_WIDTH * rows
            kept = self._local.scratch = group, np.empty(tick_size(*sizes)), (most_bounds(n, m, p), rows), size
            self._local.boxes = None
        if self._local.boxes is not boxes or self._local.dt != dt:
            boxes.write(kept[0][a.HEADER :], dt)
            self._local.boxes, self._local.dt = boxes, dt
        return kept
