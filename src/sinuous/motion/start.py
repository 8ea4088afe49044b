"""Whether a robot can begin to move where it is."""

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.robot.limits import unit_of
from sinuous.robot.robot import Robot
from sinuous.solution.worst import Worst, find_overlap
from sinuous.solving.between.steps import Prover

SLACK = 1e-9
"""By how much a configuration may exceed limits, in mean lengths of the robot or rad: rounding."""


def violated_by(robot: Robot, q: Floats) -> Worst | None:
    """Return the limit that a configuration (n, 3) violates most; `None` when it is within all of them."""
    unit = robot.mean_length
    found = [(amount / unit_of(limit, unit), limit, segment, amount) for limit, segment, amount in robot.violations(q)]
    relative, limit, segment, amount = max(found, default=(0.0, "length", 0, 0.0), key=lambda each: each[0])
    if relative <= SLACK:
        return None
    return Worst(limit, segment, None, amount)


def check_limits(robot: Robot, key: str, q: Floats) -> None:
    """Refuse a configuration (n, 3) that violates a limit.

    Raises
    ------
    InputError
    """
    violated = violated_by(robot, q)
    if violated is not None:
        raise InputError(key, str(violated), q.tolist(), "a configuration within all limits")


def blocked_by(robot: Robot, q: Floats, prover: Prover, when: float = 0.0) -> Worst | None:
    """Return the limit that a start (n, 3) violates, or else where it overlaps an obstacle or itself at a time.

    `None` when it is within all limits and no overlap is seen. What is too near to contact to be proved clear is no
    claim that it is clear: the first step is not proved then.
    """
    return violated_by(robot, q) or overlap_at(robot, q, prover, when)


def overlap_at(robot: Robot, q: Floats, prover: Prover, when: float = 0.0) -> Worst | None:
    """Return where a configuration (n, 3) overlaps an obstacle or itself at a time; `None` when no overlap is seen."""
    if prover.prove(np.stack([q, q]), slack=1.0, times=np.array([when, when]))[0, VERDICT] == CLEAR:
        return None
    worst = find_overlap(robot, prover.scene.at(when), q)
    # So near to contact that a proof fails: no overlap is seen.
    return worst if worst.amount > SLACK * robot.mean_length else None
