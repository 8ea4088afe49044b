"""Motions at an even rate: what is proved of the ways that other programs take from row to row of a file."""

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.kernels.certificate.query import CLEARANCES, UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH
from sinuous.model.robot import Robot
from sinuous.motion.blending import levers_of, reach_of, steps_margins
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Steps, prove_steps

BULGE = 4.0 / 27.0
"""How far a cubic spline is from its chord at most, for what its slope at one end differs from that, in durations."""

STEEPEST = 3.0
"""Slope at its ends, in slopes of its chord, up to which a cubic spline goes forward alone (Fritsch & Carlson 1980)."""

LIMIT_SLACK = 1e-9
"""What rounding may add to a limit: rad and mean lengths of the robot, whichever is less in its unit."""

STRETCHED = 3.0
"""How much a gap of the body shrinks at most where all of its places move, in lengths of that, see `steps_margins`."""


def lines_between(robot: Robot, scene: Snapshot, knot_times: Floats, steps: Steps, times: Floats, q: Floats) -> Steps:
    """Prove the straight lines between samples (T, n, 3), at `times` (T,), of a motion with these knots and steps.

    A line within one step of the motion is a part of that. One that cuts corners is proved anew.
    """
    first = np.clip(np.searchsorted(knot_times, times[:-1], side="right") - 1, 0, len(knot_times) - 2)
    last = np.clip(np.searchsorted(knot_times, times[1:], side="left") - 1, 0, len(knot_times) - 2)
    answers = steps.answers[first].copy()
    cutting = first != last
    begins = np.flatnonzero(np.diff(cutting.astype(np.int8), prepend=0) == 1)
    ends = np.flatnonzero(np.diff(cutting.astype(np.int8), append=0) == -1) + 1
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        run = slice(begin, end + 1)
        answers[begin:end] = prove_steps(robot, scene, q[run], times=times[run]).answers
    answers[:, UNTIL] = np.where(answers[:, VERDICT] == CLEAR, 1.0, 0.0)
    return Steps(answers, robot._least_clearances)


def splines_between(robot: Robot, times: Floats, q: Floats, velocities: Floats, lines: Steps) -> Steps:
    """Return what of straight lines is proved of cubic splines, too, through samples with velocities, both (T, n, 3).

    A spline goes forward along its chord, and aside of it by no more than is free. Its control points are within all
    limits, which are convex, and so is all of it.
    """
    dt = np.diff(times)[:, None, None]
    slopes = np.diff(q, axis=0) / dt
    control = np.stack([q[:-1] + dt / 3.0 * velocities[:-1], q[1:] - dt / 3.0 * velocities[1:]], axis=1)
    levers = levers_of(robot, np.concatenate([q, *control]))
    aside, forward = np.zeros(len(slopes)), np.ones(len(slopes), bool)
    square = np.maximum((slopes**2).sum(axis=(1, 2)), np.finfo(float).tiny)
    for ends in (velocities[:-1], velocities[1:]):
        share = (ends * slopes).sum(axis=(1, 2)) / square
        forward &= (share >= -LIMIT_SLACK) & (share <= STEEPEST)
        aside += reach_of(BULGE * dt * (ends - share[:, None, None] * slopes), levers)
    # Under load a body leaves the way by more than its drive does.
    kept = (
        forward
        & (not robot.has_external_load)
        & (aside <= steps_margins(robot, q, lines))
        & _within_limits(robot, control)
    )
    answers = lines.answers.copy()
    answers[:, CLEARANCES] -= aside
    answers[:, CLEARANCES + CLEARANCES_WIDTH] -= STRETCHED * aside
    answers[~kept, VERDICT], answers[~kept, UNTIL] = UNDECIDED, 0.0
    return Steps(answers, robot._least_clearances)


def _within_limits(robot: Robot, control: Floats) -> NDArray[np.bool_]:
    """Say which of the control points (m, 2, n, 3) of splines are within all limits, both of them (m,)."""
    slack = LIMIT_SLACK * min(1.0, robot.mean_length)
    if robot.excess(control) <= slack:
        return np.ones(len(control), bool)
    return np.array([robot.excess(pair) <= slack for pair in control], bool)
