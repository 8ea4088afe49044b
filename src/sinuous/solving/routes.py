"""Starts for narrow places: ways through free space from the base to the target, and the chain laid into them."""

import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.fitting.routes import PROVED_CLOSED, find
from sinuous.kernels.freespace.grid_astar import HALF_DIAGONAL, lattice_size
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solving.sources import Batch, Question

COARSE, FINE = 64, 1000
"""Cubes in the length of the longest robot: most of them at first, and most at all."""

ALTERNATIVES = 4
"""Ways to one target that differ."""

SLOTS = (1 << 13, 1 << 15, 1 << 18, 1 << 20)
"""Sizes of the table of cubes."""

POINTS, CROSSED = 256, 8192
"""Most points of a way, and most cubes that it leads through."""


class Plan(NamedTuple):
    """One search.

    Attributes
    ----------
    cell : float
        Edge of the cubes.
    least : float
        Distance to the obstacles with which a cube can be passed.
    slots : int
        Size of the table of cubes; half of it is the most that are looked at.
    ways : int
        Most ways to find.
    then : int
        Starts at random that come before the next search.
    exact : bool
        Whether to ask for exact distances, not for samples.
    prove : bool
        Whether to prove that there is none, where none is found.
    """

    cell: float
    least: float
    slots: int
    ways: int
    then: int
    exact: bool
    prove: bool


class Router:
    """The start source of routes, for one robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    """

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance) -> None:
        self._robot = robot
        self._group, self._settings = packing.robot_group(robot), packing.settings_group(robot, tolerance)
        self._plans = _plans(min(robot.radii), sum(segment.length[1] for segment in robot.segments))
        self._local = threading.local()
        announce(find)
        nowhere = Problem.prepared(robot, (Target((0.0, 0.0, 0.0)),), scene.snapshot(), tolerance)
        self._find(nowhere, 0, self._plans[0]._replace(slots=256), 0.0)  # compiles, or loads from the cache

    name = SOURCES[ROUTE]

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield routes to the target of a problem, from coarse to fine, while time is left."""
        problem = question.problem
        which = _goal(problem)
        told: dict[tuple[float, bool], int] = {}
        for plan in self._plans if which >= 0 else ():
            if question.seconds_left() <= 0.0:
                return
            batch = self._find(problem, which, plan, question.seconds_left())
            known = told.get((plan.cell, plan.exact), 0)
            told[plan.cell, plan.exact] = max(known, batch.size)
            yield replace(batch, initial=batch.initial[known:])
            if batch.closed is not None:
                return

    def _find(self, problem: Problem, which: int, plan: Plan, seconds: float) -> Batch:
        workspace = np.empty(
            workspace_size(len(self._robot), len(self._robot.actuation), len(problem.scene), len(problem.targets))
        )
        raw, lattice = self._scratch(plan.slots)
        starts = np.empty((plan.ways, len(self._robot), 3))
        ways, counts = np.empty((plan.ways, POINTS, 3)), np.zeros(plan.ways, np.int64)
        room = max(min(self._robot.radii), 0.5 * plan.cell)
        found, ended, _, spent = find(
            self._group,
            problem.scene.group,
            self._settings,
            problem.rows,
            which,
            plan.cell,
            plan.least,
            room,
            plan.exact,
            plan.prove,
            seconds,
            workspace,
            plan.slots,
            lattice,
            raw,
            ways,
            counts,
            starts,
        )
        closed = plan.cell if ended == PROVED_CLOSED else None
        return Batch(self.name, starts[:found].copy(), seconds=spent, then=plan.then, closed=closed)

    def _scratch(self, slots: int) -> tuple[Floats, Floats]:
        """Points of a way, and the largest lattice that this thread has needed."""
        if getattr(self._local, "slots", 0) < slots:
            self._local.slots = slots
            self._local.lattice = np.empty(lattice_size(slots))
            self._local.raw = np.empty((CROSSED, 3))
        return self._local.raw, self._local.lattice


def _plans(radius: float, length: float) -> list[Plan]:
    """Searches for a body of this radius and a robot of this length, from the quickest to the most thorough.

    Cubes of half the radius and less cannot leak through a wall, however thin it is, and prove that a room is closed.
    Coarser ones pass by what is narrow.
    """
    fine = max(0.5 * radius, length / FINE)
    coarse = max(fine, length / COARSE)
    through = radius - HALF_DIAGONAL * fine
    wide = max(radius - 0.5 * coarse, 0.25 * radius)
    proves = fine <= 0.5 * radius
    least, few, many, most = SLOTS
    first = [Plan(coarse, wide, least, 1, 0, False, False)] if coarse > fine else []
    second = [Plan(coarse, wide, few, ALTERNATIVES, 40, False, False)] if coarse > fine else []
    return [
        *first,
        Plan(fine, through, few, 1, 20, False, False),
        *second,
        Plan(fine, through, few, 1, 40, True, proves),
        Plan(fine, through, many, ALTERNATIVES, 160, False, False),
        Plan(fine, through, most, ALTERNATIVES, 0, True, proves),
    ]


def _goal(problem: Problem) -> int:
    """Number of the most distal target that has a position; -1: none has."""
    placed = [i for i, target in enumerate(problem.targets) if target.position is not None]
    ends = len(problem.robot)
    return max(placed, key=lambda i: problem.targets[i].segment or ends, default=-1)
