"""Configurations on the way: how far they are apart, and whether a robot can be there."""

from functools import lru_cache

import numpy as np

from sinuous.answer.worst import Worst, find_overlap
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels import tables
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.kernels.packing import BendLine
from sinuous.model.robot import Robot
from sinuous.problem.problem import ask_body
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Prover
from sinuous.statics.rest import pulls_at

KEPT = 64
"""Robots whose levers are kept in memory."""

BENT = 2.0 * np.pi
"""Largest bend that is drawn at random, rad, where a segment has no limit."""

SLACK = 1e-9
"""By how much a configuration may exceed limits, in mean lengths of the robot or rad: rounding."""


NEAR = 1e-3
"""By how much a start or a knot may exceed limits, in mean lengths of the robot or rad, and be brought within them."""


def distances(robot: Robot, q: Floats) -> Floats:
    """Return how far neighbouring configurations (T, n, 3) are apart (T - 1,), in the length unit.

    A change of a bend counts by the length of what it moves, from the middle of its segment to the tip, at mean
    lengths, and from joint to joint; a change of a length by itself.
    """
    steps = (q[1:] - q[:-1]) * lever_metric(robot)
    return np.sqrt(np.einsum("tnk,tnk->t", steps, steps))


@lru_cache(maxsize=KEPT)
def lever_metric(robot: Robot) -> Floats:
    """Return by how much changes of bends and lengths (n, 3) count in a distance; see `distances`."""
    levers, beyond = np.zeros(len(robot)), 0.0
    for k in reversed(range(len(robot))):
        onward, (low, high) = float(robot.limits[k, tables.ONWARD]), robot.rows[k].length
        if robot.limits[k, tables.RIGID] == tables.LINK:
            beyond = max(beyond, onward)
            continue
        length = 0.5 * (low + high)
        levers[k] = beyond + length - 0.5 * length
        beyond += length + onward
    return checks.closed(np.stack([levers, levers, np.ones(len(levers))], axis=-1))


def within_limits(robot: Robot, q: Floats) -> Floats:
    """Configurations brought within the limits of segments."""
    return robot.drive.coordinates.project(q)


def random_configuration(robot: Robot, rng: np.random.Generator) -> Floats:
    """Draw a configuration (n, 3) within the limits of segments, evenly over the disc of bends and over lengths.

    In a plane bends are drawn evenly between their limits.
    """
    low, high, most = np.array([(*segment.length, min(segment.max_bend, BENT)) for segment in robot.rows]).T
    angle, bend = 2.0 * np.pi * rng.random(len(low)), most * np.sqrt(rng.random(len(low)))
    drawn = [bend * np.cos(angle), bend * np.sin(angle), rng.uniform(low, high)]
    for k, line in enumerate(robot.drive.coordinates.bends):
        if isinstance(line, BendLine):
            share = (bend[k] / most[k]) ** 2 if most[k] > 0.0 else 0.0
            drawn[0][k], drawn[1][k] = line.at(line.low + share * (line.high - line.low))
    return within_limits(robot, np.stack(drawn, axis=-1)[None])[0]


def violated_by(robot: Robot, q: Floats) -> Worst | None:
    """Return the limit that a configuration (n, 3) violates most; `None` when it is within all of them."""
    limits, violations = robot.limit_set, robot.limit_set.violations(q)
    if not violations and (pulls := pulls_at(robot, q)) is not None:
        violations = limits.tension_violations(pulls)
    found = [(amount / limits.unit_of(limit), limit, segment, amount) for limit, segment, amount in violations]
    if not found:
        return None
    relative, limit, segment, amount = max(found, key=lambda each: each[0])
    return None if relative <= SLACK else Worst(limit, robot.labels[segment - 1], None, amount)


def settle(robot: Robot, key: str, q: Floats) -> tuple[Floats, tuple[str, ...]]:
    """Bring a configuration (n, 3) within limits that it violates by no more than `NEAR`, and say so.

    One that is farther beyond them stays as it is; then a note says how to bring it there.
    """
    violated = violated_by(robot, q)
    if violated is None:
        return q, ()
    if violated.amount <= NEAR * robot.limit_set.unit_of(violated.constraint):
        nearest = robot.clamp(q)
        if violated_by(robot, nearest) is None:
            return nearest, (f"{key}: {violated}; the nearest configuration within all limits stands for it",)
    return q, (f"{key}: {violated}; robot.clamp({key}) is within all limits of shapes",)


def check_limits(robot: Robot, key: str, q: Floats) -> tuple[Floats, tuple[str, ...]]:
    """The same, of a configuration that is refused where it is farther beyond.

    Raises
    ------
    InputError
    """
    settled, notes = settle(robot, key, q)
    if notes and settled is q:
        violated = str(violated_by(robot, q))
        raise InputError(key, violated, q.tolist(), "a configuration within all limits, as robot.clamp finds them")
    return settled, notes


def blocked_by(robot: Robot, q: Floats, prover: Prover, when: float = 0.0, within: bool = False) -> Worst | None:
    """Return the limit that a start (n, 3) violates, or else where it overlaps an obstacle or itself at a time.

    `None` when it is within all limits, as may be known (`within`), and no overlap is seen. What is too near to contact
    to be proved clear is no claim that it is clear: the first step is not proved then.
    """
    return (None if within else violated_by(robot, q)) or overlap_at(robot, q, prover, when)


def overlap_at(robot: Robot, q: Floats, prover: Prover, when: float = 0.0) -> Worst | None:
    """Return where a configuration (n, 3) overlaps an obstacle or itself at a time; `None` when no overlap is seen."""
    if prover.prove(np.stack([q, q]), slack=1.0, times=np.array([when, when]))[0, VERDICT] == CLEAR:
        return None
    return overlap_of(robot, q, prover.scene.at(when))


def overlap_of(robot: Robot, q: Floats, scene: Snapshot) -> Worst | None:
    """Return where a configuration (n, 3) overlaps an obstacle or itself the deepest; `None` where none is seen."""
    asked = ask_body(robot, q, ())
    worst = find_overlap(asked.body, scene, asked.arcs).on_robot(asked)
    # So near to contact that a proof fails: no overlap is seen.
    return worst if worst.amount > SLACK * robot.mean_length else None
