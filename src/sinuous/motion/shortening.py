"""The whole path at once: what its targets leave open is used to make the motion shorter.

Each round is a Newton step for all knots together: the least sum of squared lengths of the steps, each by its duration,
within the null space of each knot's targets. That is the least speed on average, and with speed goes the length of the
motion. The matrix is block tridiagonal, so the work is linear in the number of knots. Then each knot is solved for its
targets again, and every step is proved again. Knots beside a step that is not are held where they are from then on.
"""

from collections.abc import Callable, Sequence

import numpy as np

from sinuous.base.arguments import Shortest
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric
from sinuous.motion.knots import Knot
from sinuous.problem.target import Target

ROUNDS, ENOUGH = 20, 1e-3
"""Most rounds; and the share of its effort by which a motion must get easier for another one."""

FARTHEST = 1.0
"""Most that a round changes a bend, rad, or a length, in mean lengths of a segment."""

SMALLEST = 0.1
"""Share of a round's change below which no smaller one is tried."""

SINGULAR = 1e-6
"""Singular values of a knot's targets below this, relative to the largest, count as 0."""


Solve = Callable[[Knot, Floats], Knot | None]
"""Takes a knot and a configuration; returns the knot near there that meets the same targets, or `None`."""

Prove = Callable[[Knot, Knot], Floats | None]
"""Takes two knots; returns what is proved of the step from one to the other (1, 14), or `None`."""


def shorten(
    robot: Robot, knots: Sequence[Knot], metric: Floats, durations: Floats, solve: Solve, prove: Prove
) -> list[Knot]:
    """Return the same path, shorter where that is possible.

    Parameters
    ----------
    robot : Robot
    knots : sequence of Knot
        Those without targets stay where they are.
    metric : ndarray (3 n, 3 n)
        What the square of a step's length is.
    durations : ndarray (T - 1,)
        Of the steps.
    solve : callable
        See `Solve`.
    prove : callable
        See `Prove`.
    """
    path, size = list(knots), 1.0
    held = {i for i, knot in enumerate(path) if knot.fixed or not knot.targets}
    for _ in range(ROUNDS):
        if len(held) == len(path):
            break
        change = size * _limited(robot, _direction(robot, path, held, metric, durations))
        tried, wrong = _tried(path, change, solve, prove)
        before, after = (_effort(each, metric, durations) for each in (path, tried))
        if not wrong and after < before:
            path, size = tried, min(1.0, 2.0 * size)
            if after > (1.0 - ENOUGH) * before:
                break
        elif wrong and not wrong <= held:
            held |= wrong  # the others go on around them
        elif size <= SMALLEST:
            break
        else:
            size *= 0.5
    return path


def metric_of(robot: Robot, shortest: Shortest) -> Floats:
    """Return what the square of a step's length is (3 n, 3 n): in configurations, or displacements of actuators."""
    own = np.diag(lever_metric(robot).ravel() ** 2)
    if shortest == "configuration":
        return own
    jacobian = robot.drive.jacobian
    weight = np.trace(jacobian.T @ jacobian) / np.trace(own)
    return jacobian.T @ jacobian + 1e-6 * weight * own  # what no actuator determines stays where it is


def _effort(path: Sequence[Knot], metric: Floats, durations: Floats) -> float:
    """Sum of the squares of the lengths of all steps, each by its duration."""
    steps = np.diff(_flat(path), axis=0)
    return float((np.einsum("ti,ij,tj->t", steps, metric, steps) / durations).sum())


def _flat(path: Sequence[Knot]) -> Floats:
    q: Floats = np.stack([knot.q for knot in path])
    return q.reshape(len(q), -1)


def _direction(robot: Robot, path: Sequence[Knot], held: set[int], metric: Floats, durations: Floats) -> Floats:
    """Return the change (T, n, 3) of all knots, but those that are held, that a Newton step makes.

    It is computed with lengths in mean lengths of a segment, so that it is the same in every length unit.
    """
    units = _units(robot)
    q, metric = _flat(path) / units, metric * np.outer(units, units)
    size = q.shape[1]
    weights = 1.0 / durations
    free = np.stack([np.zeros((size, size)) if i in held else _null_space(robot, knot) for i, knot in enumerate(path)])
    around = np.concatenate([[0.0], weights]) + np.concatenate([weights, [0.0]])
    diagonal = free @ (around[:, None, None] * metric) @ free
    scale = np.trace(diagonal, axis1=1, axis2=2).max()
    diagonal += scale * (np.eye(size) - free) + 1e-9 * scale * np.eye(size)
    beside = -weights[:, None, None] * (free[:-1] @ metric @ free[1:])
    pull = (weights[:, None] * np.diff(q, axis=0)) @ metric
    force = np.zeros_like(q)
    force[:-1] += pull
    force[1:] -= pull
    force = np.einsum("tij,tj->ti", free, force)
    change: Floats = np.einsum("tij,tj->ti", free, _solved(diagonal, beside, force)) * units
    return change.reshape(-1, len(robot), 3)


def _units(robot: Robot) -> Floats:
    """Return what each coordinate (3 n,) is counted in: 1 rad, or the mean length of a segment."""
    return np.tile([1.0, 1.0, robot.mean_length / len(robot)], len(robot))


def _solved(diagonal: Floats, beside: Floats, right: Floats) -> Floats:
    """Solve for x (T, m): symmetric positive definite, of blocks (T, m, m) and those beside them (T - 1, m, m).

    It goes block after block, because LAPACK's solver for bands spreads such small ones over threads: where others
    use the cores, that takes hundreds of times as long.
    """
    pivot, wanted = diagonal[0], right[0]
    found, above = np.empty_like(right), np.empty_like(beside)
    for t, block in enumerate(beside):
        part = np.linalg.solve(pivot, np.column_stack([block, wanted]))
        above[t], found[t] = part[:, :-1], part[:, -1]
        pivot, wanted = diagonal[t + 1] - block.T @ above[t], right[t + 1] - block.T @ found[t]
    found[-1] = np.linalg.solve(pivot, wanted)
    for t in range(len(beside) - 1, -1, -1):
        found[t] -= above[t] @ found[t + 1]
    return found


def _null_space(robot: Robot, knot: Knot) -> Floats:
    """Return the projection (3 n, 3 n) on what the targets of a knot leave open, in the units of `_units`."""
    rigid = [3 * k + 2 for k, segment in enumerate(robot.rows) if segment.length[0] == segment.length[1]]
    rows = [np.eye(3 * len(robot))[rigid], *(_rows(robot, target, knot.q) for target in knot.targets)]
    values, vectors = np.linalg.svd(np.concatenate(rows), full_matrices=False)[1:]
    kept = vectors[values > SINGULAR * values[0]]
    return np.eye(3 * len(robot)) - kept.T @ kept


def _rows(robot: Robot, target: Target, q: Floats) -> Floats:
    """Return the derivative (r, 3 n) of what one target asks, in the units of `_units`."""
    units = _units(robot)
    jacobian = robot._row_jacobian(q, robot.end_row(target.segment)) * units
    rows = [] if target.position is None else [jacobian[3:] / units[2]]
    if target.rotation is not None:
        rows.append(jacobian[:3])
    if target.direction is not None:
        across = np.linalg.svd(target.direction[None])[2][1:]
        rows.append(across @ jacobian[:3])
    return np.concatenate(rows)


def _limited(robot: Robot, change: Floats) -> Floats:
    """Make a change (T, n, 3) of all knots small enough for what it is based on."""
    units = _units(robot).reshape(-1, 3)
    return change * min(1.0, FARTHEST / max(float(np.abs(change / units).max(initial=0.0)), 1e-300))


def _tried(path: list[Knot], change: Floats, solve: Solve, prove: Prove) -> tuple[list[Knot], set[int]]:
    """Change all knots and meet their targets again; return also those that steps that are not proved lie between."""
    tried = [_moved(knot, move, solve) for knot, move in zip(path, change, strict=True)]
    wrong = {i for i, knot in enumerate(tried) if knot is None}
    knots = [knot or before for knot, before in zip(tried, path, strict=True)]
    for i in range(1, len(knots)):
        proof = prove(knots[i - 1], knots[i])
        if proof is None:
            wrong |= {i - 1, i}
        else:
            knots[i] = knots[i]._replace(proof=proof)
    return knots, wrong


def _moved(knot: Knot, move: Floats, solve: Solve) -> Knot | None:
    """Change a knot and meet its targets again; `None` where that fails."""
    if not move.any():
        return knot
    return solve(knot, knot.q + move)
