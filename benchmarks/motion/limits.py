"""Limits of tension: control steps and motions of elastic arms, with and without load, judged by least energies.

The judge minimises the potential energy of bends, lines and weights by SciPy, where the motors are; it shares no code
with the package. A claim is false where a line is pulled by more than its limit: of steps at the end, of motions that
are solved also at places between their knots.
"""

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import minimize

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan
from benchmarks.judges.kinematics import arc_ends, arc_poses
from sinuous.base.checks import Floats

SEGMENTS, LENGTH, ARM, ARCS = 2, 0.1, 0.004, 3
STIFFNESS, LINE, MASS, GRAVITY = 0.02, 4000.0, 0.3, np.array([-9.81, 0.0, 0.0])
"""Bending stiffness of segments, stiffness of lines, mass a length, and acceleration: N, m, kg."""

STEPS, LOOP, MOTIONS = 3400, 8, 700
"""Control steps and motions of each kind of arm, and steps of a loop."""

BETWEEN = (0.25, 0.5, 0.75)
"""Shares of a step of a motion at which it is judged."""

EXACT = 1e-3
"""By how much, of the limit, the judge may be off."""

KINDS = ("elastic", "elastic, lengths vary", "loaded")
NUDGE = 1e-6
"""By how much bends are changed for slopes of the energy, rad."""

NODES, SHARES = np.polynomial.legendre.leggauss(4)


def arm(kind: str, rng: np.random.Generator) -> sn.Robot:
    """Return an arm of a kind with a random limit of tension, and with three or four tendons a segment."""
    lines = sn.Tendons(int(rng.integers(3, 5)), ARM, stiffness=LINE, tension=(0.0, float(rng.uniform(20.0, 80.0))))
    length = (0.7 * LENGTH, 1.3 * LENGTH) if "vary" in kind else LENGTH
    load: dict[str, Any] = {"gravity": GRAVITY, "mass": MASS, "arcs": ARCS} if kind == "loaded" else {}
    segment = sn.Segment(length, max_bend=2.0, radius=ARM, tendons=lines)
    return sn.Robot([segment] * SEGMENTS, stiffness=sn.Stiffness(STIFFNESS), **load)


def drawn(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """Draw a shape within limits of tension, as far as these are known without a load."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    bends, lengths = rng.normal(0.0, 0.5, (SEGMENTS, 2)), rng.uniform(low, high)
    return robot.clamp(np.column_stack([bends, lengths]))


def most_pulled(robot: sn.Robot, displacements: Floats, lengths: Floats, near: Floats) -> float:
    """Return the greatest tension where energy is least, of motors at these displacements, from bends near there."""
    count = ARCS if robot.has_external_load else 1
    arms = np.concatenate([each.tendons.arms for each in robot.segments if each.tendons is not None])
    each = len(arms) // SEGMENTS
    through = np.repeat(np.tril(np.ones((SEGMENTS, SEGMENTS))), each, axis=0)

    def stretches(bends: Floats) -> Floats:
        return np.asarray(displacements - np.einsum("lk,...kac,lc->...l", through, bends, arms))

    def energy(x: Floats) -> Floats:
        bends = x.reshape(-1, SEGMENTS, count, 2)
        rods = 0.5 * STIFFNESS * ((bends**2).sum(axis=3) * (count / lengths)[:, None]).sum(axis=(1, 2))
        pulled = 0.5 * LINE * (np.maximum(0.0, stretches(bends)) ** 2).sum(axis=1)
        weight = _height(robot, bends, lengths / count) if robot.has_external_load else 0.0
        return np.asarray(rods + pulled + weight)

    def slope(x: Floats) -> Floats:
        nudges = NUDGE * np.concatenate([np.eye(x.size), -np.eye(x.size)])
        ahead, behind = energy(x + nudges).reshape(2, -1)
        return np.asarray((ahead - behind) / (2.0 * NUDGE))

    begin = np.repeat(near[:, None, :2] / count, count, axis=1).ravel()
    least: Any = minimize  # its stubs know no function that returns the slope of an array of one axis
    found = least(lambda x: float(energy(x)[0]), begin, jac=slope, method="BFGS", options={"gtol": 1e-8})
    return float(LINE * stretches(found.x.reshape(SEGMENTS, count, 2)).max(initial=0.0))


def _height(robot: sn.Robot, bends: Floats, lengths: Floats) -> Floats:
    """Potential energy (r,) of the weight of arcs (r, n, a, 2) of these lengths (n,)."""
    count, total = len(bends), np.zeros(len(bends))
    rotation, place = np.tile(robot.base[:3, :3], (count, 1, 1)), np.tile(robot.base[:3, 3], (count, 1))
    nodes, shares = 0.5 * (1.0 + NODES), 0.5 * SHARES
    for k, length in enumerate(lengths.tolist()):
        for bend in bends[:, k].swapaxes(0, 1):
            parts = nodes * bend[..., None]
            within = arc_ends(parts[:, 0], parts[:, 1], nodes * length)
            places = place[:, None] + within @ rotation.swapaxes(1, 2)
            total -= MASS * length * (places @ GRAVITY @ shares)
            ends = arc_poses(bend[:, 0], bend[:, 1], np.full(count, length))
            place = place + np.einsum("rij,rj->ri", rotation, ends[:, :3, 3])
            rotation = rotation @ ends[:, :3, :3]
    return total


def is_false(robot: sn.Robot, q: Floats, displacements: Floats | None = None) -> bool:
    """Whether a line is pulled by more than its limit at shapes (k, n, 3) of the drive, or with other motors."""
    limit = robot.segments[0].tendons.tensions[1]  # type: ignore[union-attr]
    there = robot.to_actuators(q) if displacements is None else displacements
    pulled = max(most_pulled(robot, own, one[:, 2], one) for own, one in zip(there, q, strict=True))
    return pulled > limit * (1.0 + EXACT)


def is_false_between(robot: sn.Robot, one: Floats, other: Floats) -> bool:
    """The same on the way between two knots, while the motors run evenly under load, or the shape changes evenly."""
    shares = np.array(BETWEEN)[:, None]
    begin, end = robot.to_actuators(np.stack([one, other]))
    q = (1.0 - shares[..., None]) * one + shares[..., None] * other
    return is_false(robot, q, (1.0 - shares) * begin + shares * end if robot.has_external_load else None)


def begun(robot: sn.Robot, rng: np.random.Generator) -> Floats | None:
    """Draw where a loop or a motion begins; `None` where nothing within limits was drawn."""
    q = drawn(robot, rng)
    return None if is_false(robot, q[None]) else q


def steps(kind: str, count: int, rng: np.random.Generator) -> tuple[int, int, int]:
    """Make loops of control steps; returns how many steps there are, were held back, and are false."""
    made = held = false = 0
    while made < count:
        robot = arm(kind, rng)
        q = begun(robot, rng)
        if q is None:
            continue
        solver, velocity = sn.Solver(robot), rng.normal(0.0, 0.15, 3)
        for _ in range(LOOP):
            step = solver.step(q, velocity, 0.1)
            q = step.q
            made, held, false = made + 1, held + (step.status != "reached"), false + is_false(robot, q[None])
    return made, held, false


def motions(kind: str, count: int, rng: np.random.Generator) -> tuple[int, int, int]:
    """Plan and follow; returns how many motions there are, how many are solved, and how many of these are false."""
    made = solved = false = 0
    while made < count:
        robot = arm(kind, rng)
        q, goal = begun(robot, rng), drawn(robot, rng)
        if q is None:
            continue
        try:
            motion = _motion(made % 3, robot, q, goal)
        except sn.InputError:
            continue
        made, solved = made + 1, solved + motion.solved
        if motion.solved:
            ends = is_false(robot, motion.q)
            false += ends or any(is_false_between(robot, *pair) for pair in pairwise(motion.q))
    return made, solved, false


def _motion(which: int, robot: sn.Robot, q: Floats, goal: Floats) -> sn.Motion:
    if which == 0:
        return sn.plan(robot, q, goal, time=1.0)
    if which == 1:
        return sn.Motion(robot, [q, goal])
    tip = robot.shape(goal).tip if robot.has_external_load else robot.tip(goal)
    return sn.track(robot, [sn.Target(tip[:3, 3])], start=q, time=1.0)


def measure(plan: Plan, number: int) -> Iterator[Line]:
    """Measure one kind of arm."""
    kind, counts = KINDS[number], (plan.count(STEPS, 100), plan.count(MOTIONS, 20))
    for i, (what, make, word) in enumerate((("control steps", steps, "held back"), ("motions", motions, "solved"))):
        made, some, false = make(kind, counts[i], plan.rng(91, number, i))
        note = f"of {made}, {some} {word}; judged by least energies"
        goal = Goal(0, correctness=True)
        yield Line("limits of tension", f"{kind}: {what} in which a line is pulled by more", false, "", goal, note=note)


PARTS: dict[str, Part] = {f"limits: {kind}": partial(measure, number=number) for number, kind in enumerate(KINDS)}
"""What is measured, in order."""
