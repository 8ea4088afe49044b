"""Time scalings of a path: the fastest way to pass it under rates and accelerations.

A phase is a duration, the place s where it begins on its piece, the speed of s there, and its even acceleration. A path
with corners is passed from rest to rest between them. A blended path is passed without stops, by reachability analysis
(TOPP-RA, Pham & Pham 2018, as the package toppra has it): on a piece q'' by s is constant, so within an interval of
even acceleration of s all accelerations are linear in s. Limits that hold at both its ends hold in between, and none is
exceeded anywhere.
"""

from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.rates import Spread
from sinuous.model.robot import Robot
from sinuous.motion.blending import BlendedPath

FACETS = 16
"""Sides of the polygon within the circle that limits the acceleration of a bend: 2 % less than the circle at worst."""

STRAIGHT_GRID, CURVED_GRID = 16, 8
"""Intervals on a straight and on a curved piece."""

ROUNDING = 1e-9
"""By how much of itself a limit of acceleration may be exceeded."""

STEEP = 1e6
"""Where nothing limits an acceleration, full speed is reached within one part in so many of a piece."""


class Scaling(NamedTuple):
    """Phases on a path: the number of the piece (M,), and durations, places, speeds and accelerations (M, 4)."""

    piece: np.ndarray
    phases: Floats


def largest(robot: Robot, spread: Spread, slopes: Floats, motors: Floats | None = None) -> Floats:
    """Return the largest multiple of each slope (m, n, 3) that rates allow (m,); infinite where nothing limits it.

    `motors` (m, a): how fast motors run, see `motor_speeds`; by default that is the same everywhere.
    """
    speeds = np.abs(robot.drive.speeds(slopes) if motors is None else motors)
    sizes = np.concatenate(
        [
            np.hypot(slopes[..., 0], slopes[..., 1]) / spread.bend,
            np.abs(slopes[..., 2]) / spread.length,
            speeds / spread.actuator,
        ],
        axis=-1,
    ).max(axis=-1)
    return np.divide(1.0, sizes, out=np.full(len(sizes), np.inf), where=sizes > 0.0)


def motor_speeds(robot: Robot, spread: Spread, q: Floats, moves: Floats, later: Floats | None = None) -> Floats | None:
    """Return how fast motors run at most (m, a) on ways from `q`, by `moves` (m, n, 3), in a unit of time.

    See `Actuation.greatest_speeds`. `None` where no elastic one is limited: then `largest` knows them.

    Raises
    ------
    InputError
        When nothing bounds how fast one runs.
    """
    if not spread.limits_elastic(robot):
        return None
    most = robot.drive.greatest_speeds(q, moves, later)
    if not np.isfinite(most[..., np.isfinite(spread.actuator)]).all():
        problem = "motors of elastic actuators run at any speed where a segment that they bend vanishes"
        raise InputError("rates.actuator", problem, spread.actuator, "segments that keep some length")
    return most


def scale_with_stops(robot: Robot, path: BlendedPath, rates: Spread, accelerations: Spread | None) -> Scaling:
    """Scale a path of straight pieces: from rest to rest on each, or at an even speed where nothing accelerates."""
    slopes, lengths = path.pieces[:, 1], path.lengths[:, None]

    def allowed(spread: Spread) -> Floats:
        motors = motor_speeds(robot, spread, path.pieces[:, 0], slopes * lengths[:, None])
        return largest(robot, spread, slopes, None if motors is None else motors / lengths)

    speed, gain = allowed(rates), np.full(len(slopes), np.inf)
    if accelerations is not None:
        gain = allowed(accelerations)
    refuse_unlimited(np.minimum(speed, gain))
    piece, phases = [], []
    for i, (length, fastest, most) in enumerate(zip(path.lengths, speed, gain, strict=True)):
        own = _phases(float(length), float(fastest), float(most))
        piece.extend([i] * len(own))
        phases.extend(own)
    return Scaling(np.array(piece, np.intp), np.array(phases))


def _phases(length: float, fastest: float, most: float) -> list[tuple[float, float, float, float]]:
    """Phases of one straight piece: speeding up, an even speed, and slowing down."""
    if np.isinf(most):
        return [(length / fastest, 0.0, fastest, 0.0)]
    top = min(fastest, float(np.sqrt(length * most)))
    ramp = 0.5 * top * top / most
    up = (top / most, 0.0, 0.0, most)
    down = (top / most, length - ramp, top, -most)
    if 2.0 * ramp >= length * (1.0 - 1e-12):
        return [up, down]
    return [up, ((length - 2.0 * ramp) / top, ramp, top, 0.0), down]


def refuse_unlimited(speeds: Floats) -> None:
    """Refuse rates that let a piece pass in no time."""
    if np.isinf(speeds).any():
        number = int(np.argmax(np.isinf(speeds))) + 1
        raise InputError("rates", f"nothing limits step {number} of the motion", None, "rates of all that moves")


def scale_blended(robot: Robot, path: BlendedPath, rates: Spread, accelerations: Spread) -> Scaling:
    """Scale a path so that it is passed as fast as can be; it begins, ends and goes through its stops at rest."""
    grid = _Grid(path)
    ends = np.stack([path.at(grid.piece, s, 1) for s in (grid.s, grid.s + grid.steps)])
    steps = grid.steps[:, None, None]
    motors = motor_speeds(robot, rates, path.at(grid.piece, grid.s), steps * ends[0], steps * ends[1])
    both = None if motors is None else np.tile(motors / grid.steps[:, None], (2, 1))
    speeds = largest(robot, rates, ends.reshape(-1, *ends.shape[2:]), both).reshape(2, -1)
    fastest = speeds.min(axis=0)
    gains = largest(robot, accelerations, ends[0])
    refuse_unlimited(np.minimum(fastest, gains))
    unit = float(np.median(np.where(np.isinf(fastest), np.sqrt(gains * path.lengths[grid.piece]), fastest)))
    steep = STEEP * unit**2 / path.lengths[grid.piece]
    curved = path.pieces[grid.piece, 2].any(axis=(1, 2))
    # toppra has tolerances that are absolute: it sees a path of length 1 and a median speed of 1.
    faster = unit**2 / grid.points[-1]
    own = np.where(curved, steep, np.minimum(gains, steep)) / faster
    rows = _rows(robot, path, grid, accelerations, curved) * [faster, unit**2]
    limits = _Limits(grid, np.minimum(fastest / unit, STEEP), own, rows)
    acceleration, speed = _solved(grid.points / grid.points[-1], limits)
    duration = 2.0 * grid.steps / (unit * (speed[1:] + speed[:-1]))
    phases = np.stack([duration, grid.s, unit * speed[:-1], faster * acceleration], axis=1)
    return Scaling(grid.piece, phases)


class _Grid:
    """Intervals (M,) on the pieces of a path: piece, s where they begin, their lengths; and where the robot stops."""

    def __init__(self, path: BlendedPath) -> None:
        curved = path.pieces[:, 2].any(axis=(1, 2))
        counts = np.where(curved, CURVED_GRID, STRAIGHT_GRID)
        self.piece = np.repeat(np.arange(len(counts)), counts)
        number = np.arange(len(self.piece)) - np.repeat(np.cumsum(counts) - counts, counts)
        self.steps = (path.lengths / counts)[self.piece]
        self.s = number * self.steps
        self.at_rest = np.zeros(len(self.piece) + 1, bool)
        self.at_rest[np.append(np.cumsum(counts) - counts, len(self.piece))] = path.stops
        self.points = np.concatenate([[0.0], np.cumsum(self.steps)])


def _rows(robot: Robot, path: BlendedPath, grid: _Grid, spread: Spread, curved: np.ndarray) -> Floats:
    """Limits of acceleration (M, r, 2) at both ends of curved intervals: a row times (u, x) is at most 1.

    u is the acceleration of s and x its speed squared.
    """
    turn = path.at(grid.piece, grid.s, 2)
    begin, end = (path.at(grid.piece, s, 1) for s in (grid.s, grid.s + grid.steps))
    later = end + 2.0 * grid.steps[:, None, None] * turn  # x at the end is x + 2 steps u
    both = [np.stack([of_u, turn], axis=-1) for of_u in (begin, later)]
    rows = np.concatenate([_facets(robot, spread, each) for each in both], axis=1)
    rows[~curved] = 0.0
    return rows


def _facets(robot: Robot, spread: Spread, columns: Floats) -> Floats:
    """Rows (M, r, 2) of what multiplies u and x in `columns` (M, n, 3, 2), each over its limit."""
    angles = 2.0 * np.pi * np.arange(FACETS) / FACETS
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1) / np.cos(np.pi / FACETS)
    bends = np.einsum("fi,mkic->mkfc", normals, columns[:, :, :2]) / spread.bend[:, None, None]
    lengths = columns[:, :, 2] / spread.length[:, None]
    values = np.moveaxis(robot.drive.speeds(np.moveaxis(columns, -1, 1)), 1, -1) / spread.actuator[:, None]
    flat = bends.reshape(len(columns), -1, 2)
    return np.concatenate([flat, lengths, -lengths, values, -values], axis=1)


class _Limits:
    """The constraints of toppra, as numbers on the grid."""

    def __init__(self, grid: _Grid, fastest: Floats, gains: Floats, rows: Floats) -> None:
        rows = rows[:, np.abs(rows).max(axis=(0, 2), initial=0.0) > 0.0]
        last = np.zeros((1, *rows.shape[1:]))
        self.rows = np.concatenate([rows, last])
        slowest = np.minimum(np.append(fastest, np.inf), np.append(np.inf, fastest))
        self.x = np.stack([np.zeros(len(slowest)), np.where(grid.at_rest, 0.0, slowest**2)], axis=1)
        gains = np.append(gains, gains[-1])
        self.u = np.stack([-gains, gains], axis=1)


def _solved(points: Floats, limits: _Limits) -> tuple[Floats, Floats]:
    """Accelerations (M,) and speeds (M + 1,) of s on a grid of points (M + 1,); toppra says where one can brake."""
    checks.needed("toppra", "timing", "blend")
    from toppra import SimplePath  # noqa: PLC0415
    from toppra.algorithm import TOPPRA  # noqa: PLC0415
    from toppra.constraint import LinearConstraint  # noqa: PLC0415

    class Given(LinearConstraint):  # type: ignore[misc]
        """Numbers that are there already."""

        def compute_constraint_params(self, path: Any, gridpoints: Any) -> tuple[Any, ...]:
            count = limits.rows.shape[1]
            a, b = limits.rows[..., 0], limits.rows[..., 1]
            if count == 0:
                return None, None, None, None, None, limits.u, limits.x
            return a, b, np.zeros_like(a), np.eye(count), np.ones(count), limits.u, limits.x

    constraint = Given()
    constraint.identical = True
    line = SimplePath(points[[0, -1]], np.array([0.0, 1.0]))
    found = TOPPRA([constraint], line, gridpoints=points, solver_wrapper="seidel")
    reachable = np.asarray(found.compute_controllable_sets(0.0, 0.0), np.float64)
    if not np.isfinite(reachable).all():
        raise RuntimeError("toppra found no timing")
    return _fastest(points, limits, reachable[:, 1])


def _fastest(points: Floats, limits: _Limits, most: Floats) -> tuple[Floats, Floats]:
    """Accelerations and speeds of s: as fast as can be from rest, below squares of speeds (M + 1,) that can be braked.

    toppra has such a pass, too, but gives up where what it can brake from is rounded. Here limits may be exceeded by
    `ROUNDING`, and where they still contradict each other the speed stays one that can be braked from.
    """
    square, accelerations = np.zeros(len(points)), np.zeros(len(points) - 1)
    for i, step in enumerate(np.diff(points)):
        of_u, left = limits.rows[i, :, 0], 1.0 + ROUNDING - limits.rows[i, :, 1] * square[i]
        bound = np.divide(left, of_u, out=np.full(len(of_u), np.inf), where=of_u != 0.0)
        braked = (most[i + 1] - square[i]) / (2.0 * step)
        high = min(limits.u[i, 1], braked, *bound[of_u > 0.0])
        low = max(limits.u[i, 0], -square[i] / (2.0 * step), *bound[of_u < 0.0])
        accelerations[i] = high if high >= low else min(0.0, braked)
        square[i + 1] = max(0.0, square[i] + 2.0 * step * accelerations[i])
    return accelerations, np.sqrt(square)
