"""Every inequality of a robot, in one place: what verbs ask, and nothing else knows a limit.

Lengths, bends, curvature, actuators and tensions are limits of shapes, convex but for tensions where lengths change.
Changes that are allowed in one time are limits, too, where a configuration has used them up. The thickness of the body
is a limit of curvature where it must not run through itself. Plain NumPy: no table of the kernels is read.

A new limit is a word of `LimitKind`, an entry of `_amounts` (by how much shapes are outside) and of `sides` (what is
left, and which motion it forbids), and a unit in `unit_of`. What it is made of comes from the robot with `LimitSet`.
Where the straight robot can violate it, `homes` has to know it.

The shape nearest to another one within linear bounds is found by least distance programming (Lawson & Hanson 1974).
"""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import LimitKind, RateKind
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.packing import BendLine
from sinuous.model.actuation import Actuation, Actuator
from sinuous.model.joints import RigidRow
from sinuous.model.segment import Segment
from sinuous.model.tension_rows import TensionRows

APART = 1e-9
"""What is left of the dual problem, whose right side has length 1, below which the bounds contradict each other."""


def least_distance(root: Floats, free: Floats, weights: Floats, low: Floats) -> tuple[Floats, Floats] | None:
    """Return the y (n,) nearest to `free` (n,) with `weights y >= low`, and multipliers (m,); `None`: there is none.

    Distances are those of the metric `root root'`, `root` (n, n) lower triangular, or (0, 0) for the identity; weights
    (m, n), low (m,).
    """
    sizes = np.maximum(np.linalg.norm(weights, axis=1), 1e-300)
    rows = weights / sizes[:, None]
    lack = low / sizes - rows @ free
    if (lack <= 0.0).all():
        return free, np.zeros(len(low))
    unit = float(np.abs(lack).max())
    system = np.concatenate([np.linalg.solve(root, rows.T) if len(root) else rows.T, lack[None] / unit])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    multipliers = nonnegative_least_squares(system, wanted)
    rest = system @ multipliers - wanted
    if np.linalg.norm(rest) < APART or rest[-1] >= 0.0:
        return None
    step: Floats = -unit * rest[:-1] / rest[-1]
    return free + (np.linalg.solve(root.T, step) if len(root) else step), multipliers


def nonnegative_least_squares(system: Floats, wanted: Floats) -> Floats:
    """Return x (k,) >= 0 with the least `|system x - wanted|`, for `system` (m, k) and `wanted` (m,)."""
    from scipy.optimize import lsq_linear, nnls  # noqa: PLC0415

    try:
        result: Floats = nnls(system, wanted)[0]
    except RuntimeError:
        # Columns that are equal but for rounding can let the active set go round in circles; this one cannot.
        result = lsq_linear(system, wanted, bounds=(0.0, np.inf)).x
    return result


OF_ONE_SEGMENT: frozenset[str] = frozenset({"length", "bend", "curvature"})
"""Kinds of limits that each segment keeps by itself; all others couple segments."""

LIMIT_ROUNDING = 1e-11
"""By how much rounding may exceed a limit: rad, or mean lengths of the robot."""

USED_UP = 3e-3
"""Share of a change that may be left when it counts as used up: a solve stays within it by about a thousandth."""

MOST_CUTS = 100
"""Most times that a configuration is brought within limits that it violates, linear there; a few are usual."""

HOME_ROUNDING = 1e-12
"""By how much, relative to their weights, straight robots may be outside limits of actuators."""

CUT_INSET = 0.1
"""How far within a limit it is brought, as a share of what rounding may exceed it by."""

Violation = tuple[LimitKind, Any, float]
"""A limit (`length`, `bend`, `curvature`, `actuator`), its segment (1 = first), and by how much it is violated.

Instead of a segment the name of a joint. A `LimitSet` has the number of the row, 1 = first.
"""


class Limit(NamedTuple):
    """One side of one limit.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature` or `actuator`; or `length_rate`, `bend_rate`, `actuator_rate`.
    segment : int
        1 = first.
    actuator : str or None
        Name of the actuator.
    key : str
        What the problem file calls it; `length[0]` is the lower end of `length`, and `radius` a curvature that the
        thickness of the body limits, `self_clearance` one that this and the clearance limit that is demanded.
    value, limit : float
        What the configuration has, and what it may have: lengths, rad for `bend`, 1 / length for `curvature`; for an
        actuator in its own unit.
    slack : float
        What is left until the limit stops a motion; length, rad for `bend` and `curvature`. Displacements of
        `Actuators` are divided by their scale, see `Actuation.scales`.
    gradient : ndarray (n, 3)
        By how much the slack shrinks with `bend_x`, `bend_y`, `length` of each segment.
    fixed : bool
        Whether the limit leaves no choice: a length that cannot change, a segment that cannot bend.
    motor : Actuator or None
        The actuator, where value and limit are those of its motor and not displacements.
    """

    constraint: LimitKind | RateKind
    segment: int
    actuator: str | None
    key: str
    value: float
    limit: float
    slack: float
    gradient: Floats
    fixed: bool = False
    motor: Actuator | None = None


class LimitSet:
    """All limits of one robot.

    Parameters
    ----------
    segments : sequence of Segment
        Joints and links among them, see `Robot.rows`.
    radii, curvatures : sequence of float (n,)
        Radii of the body with half of its clearance from itself; and the largest curvatures.
    drive : Actuation
    mean_length : float
        Of the robot.
    """

    def __init__(
        self,
        segments: Sequence[Segment],
        radii: Sequence[float],
        curvatures: Sequence[float],
        drive: Actuation,
        mean_length: float,
    ) -> None:
        self._segments, self._radii, self._curvatures, self._drive = segments, radii, curvatures, drive
        self.mean_length = mean_length
        self._numbers = np.arange(1, len(segments) + 1)
        self._bends = drive.coordinates.bends
        self._low, self._high = drive.coordinates.lengths.T
        self._discs = np.array([math.inf if isinstance(each, BendLine) else each for each in self._bends])
        self._planar = [(k, each) for k, each in enumerate(self._bends) if isinstance(each, BendLine)]
        columns = self._low, self._high, self._discs, np.array(curvatures)
        self._rows = np.stack(columns, axis=-1).tolist()
        self._curved = np.flatnonzero(np.isfinite(curvatures))
        self._largest = np.array(curvatures)[self._curved]

    @cached_property
    def kinds(self) -> set[LimitKind]:
        """Kinds of limits that the robot has."""
        shape = np.pad(self._low[:, None], ((0, 0), (2, 0)))
        return {kind for kind, _, amounts in self._amounts(shape) if np.isfinite(amounts).any()}

    @cached_property
    def tension_rows(self) -> TensionRows | None:
        """What limits of tension ask of shapes without load; `None` where tensions within them hold any shape."""
        elastic = self._drive.elastic
        return elastic.rows if elastic is not None and elastic.bounded else None

    @cached_property
    def tensions(self) -> Floats:
        """Least and greatest tensions of all actuators (m, 2), infinite where there is no limit."""
        result = np.tile([-np.inf, np.inf], (len(self._drive), 1))
        if self._drive.elastic is not None:
            result[self._drive.elastic.places] = self._drive.elastic.limits
        return result

    def unit_of(self, limit: str) -> float:
        """Return the unit of rounding of a limit: 1 rad for angles, the mean length of the robot for lengths.

        A tolerance is a multiple of it. So a tolerance means the same in every unit of length.
        """
        return {"bend": 1.0, "curvature": 1.0, "length": self.mean_length, "actuator": self.mean_length}[limit]

    def excess(self, q: Floats) -> float:
        """By how much configurations (..., n, 3) are outside the limits, at worst; 0 within all of them."""
        return max(float(np.max(amounts, initial=0.0)) for _, _, amounts in self._amounts(q))

    def violations(self, q: Floats, slack: float = LIMIT_ROUNDING) -> list[Violation]:
        """List what a configuration (n, 3) violates by more than a `slack`, segment by segment, actuators last."""
        if self.kinds <= OF_ONE_SEGMENT and self._keeps_segments(q):  # most are, and that is soon seen
            return []
        found: list[Violation] = []
        for name, numbers, amounts in self._amounts(q):
            beyond = np.flatnonzero(amounts > slack * self.unit_of(name))
            found += [(name, int(numbers[i]), float(amounts[i])) for i in beyond]
        return sorted(found, key=lambda each: (each[0] not in OF_ONE_SEGMENT, each[1]))

    def tension_violations(self, tensions: Floats) -> list[Violation]:
        """List the limits that tensions (m,) of all actuators violate, each by a stretch; NaN is no tension."""
        elastic = self._drive.elastic
        if elastic is None:
            return []
        own = tensions[elastic.places]
        beyond = elastic.beyond(np.where(np.isnan(own), 0.0, own))
        found = np.flatnonzero(~np.isnan(own) & (beyond > LIMIT_ROUNDING * self.mean_length))
        return [("actuator", self._row(self._drive.actuators[elastic.places[i]]), float(beyond[i])) for i in found]

    def keep(self, q: Floats, tensions: Floats | None = None) -> bool:
        """Whether a configuration (n, 3) is within all limits, and tensions (m,) are that a load needs there."""
        return not self.violations(q) and (tensions is None or not self.tension_violations(tensions))

    def held(self, q: Floats) -> NDArray[np.bool_]:
        """Whether tensions within their limits hold configurations (..., n, 3) without a load."""
        elastic = self._drive.elastic
        if elastic is None or not elastic.bounded:
            return np.ones(q.shape[:-2], np.bool_)
        return elastic.balance(q).short.max(axis=-1) <= LIMIT_ROUNDING * self.mean_length

    def clamp(self, q: Floats) -> Floats:
        """Return the configuration (n, 3) within all limits that is nearest to `q`; see `Robot.clamp`.

        Limits are linear or convex: those that a configuration violates are cut by their tangents, and the nearest one
        within all cuts takes its place, until none is violated (Kelley 1960).

        Raises
        ------
        InputError
            When none is found.
        """
        scale = np.tile([1.0, 1.0, self.mean_length / len(q)], len(q))
        weights, bounds, x, own = np.empty((0, q.size)), np.empty(0), q, self._drive.coordinates
        for _ in range(MOST_CUTS):
            if not self.violations(x):
                return x
            rows, most = zip(*self._cuts(x), strict=True)
            weights, bounds = np.concatenate([weights, rows]), np.append(bounds, most)
            found = least_distance(np.empty((0, 0)), q.ravel() / scale, -weights * scale, -bounds)
            if found is None:
                break
            x = (found[0] * scale).reshape(q.shape)
            x[~own.unlocked] = own.origin[~own.unlocked]  # exactly: what bends by rounding is no prismatic joint
        raise InputError("q", "no configuration within all limits was found near it", q.tolist(), "one nearer to them")

    def homes(self) -> list[tuple[float, float, float]]:
        """Where segments go when limits of actuators are to be kept: bends, and lengths or -1 where any length will do.

        Of a robot that bends in planes, has what is locked, or limits of actuators that are equal.

        Raises
        ------
        InputError
            When limits of actuators leave no shape of what is locked, or in one plane.
        """
        own, drive = self._drive.coordinates, self._drive
        bends = np.array([each.home if isinstance(each, BendLine) else (0.0, 0.0) for each in own.bends])
        shape = np.column_stack([bends, 0.5 * own.lengths.sum(axis=1)])
        middle, spread = drive.displacements(shape), 0.5 * np.abs(drive.jacobian[:, 2::3]) @ np.ptp(own.lengths, axis=1)
        room = np.minimum(middle - spread - drive.limits[:, 0], drive.limits[:, 1] - middle - spread)
        if (room >= -HOME_ROUNDING * np.abs(drive.jacobian).sum(axis=1)).all():
            return [(x, y, -1.0) for x, y in bends.tolist()]
        try:
            return [(x, y, length) for x, y, length in self.clamp(shape).tolist()]
        except InputError:
            problem = "no shape is within their limits and what is locked or in one plane"
            raise InputError("actuators", problem, None, "wider limits") from None

    def _cuts(self, q: Floats) -> Iterator[tuple[Floats, float]]:
        """Yield a row (3 n,) for every limit that a configuration violates, and what its sum must be at most."""
        slack = CUT_INSET * LIMIT_ROUNDING * min(1.0, self.mean_length)
        for limit in self.sides(q):
            if limit.slack < slack:
                outward = limit.gradient.ravel()
                yield outward, float(outward @ q.ravel()) + limit.slack - (0.0 if limit.fixed else slack)
        rows = self.tension_rows
        if rows is not None:
            values, slopes = rows.values(q), rows.slopes(q)
            for i in np.flatnonzero(rows.excess(q) > -slack):
                least, most = rows.bounds[i]
                inset = min(slack, 0.5 * (most - least))
                for sign, end in ((1.0, most - inset), (-1.0, -least - inset)):
                    if np.isfinite(end) and sign * values[i] > end - slack:
                        yield sign * slopes[i], float(sign * slopes[i] @ q.ravel() + end - sign * values[i])

    def _keeps_segments(self, q: Floats) -> bool:
        """Whether a configuration (n, 3) is within limits `OF_ONE_SEGMENT`, and exactly in the planes of some."""
        for k, line in self._planar:
            x, y = q[k, 0] - line.rest[0], q[k, 1] - line.rest[1]
            z = x * line.plane[0] + y * line.plane[1]
            if not (line.low <= z <= line.high and x == z * line.plane[0] and y == z * line.plane[1]):
                return False
        for (x, y, length), (low, high, most, curvature) in zip(q.tolist(), self._rows, strict=True):
            bend = math.hypot(x, y)
            if not (low <= length <= high and bend <= most) or bend > curvature * length:  # NaN: no limit
                return False
        return True

    def _amounts(self, q: Floats) -> Iterator[tuple[LimitKind, NDArray[Any], Floats]]:
        """Yield kinds of limits, the segments (k,) that have one, and by how much each is exceeded (..., k)."""
        bends, lengths = np.hypot(q[..., 0], q[..., 1]), q[..., 2]
        yield "length", self._numbers, np.maximum(self._low - lengths, lengths - self._high)
        beyond = bends - self._discs
        for k, line in self._planar:
            beyond[..., k] = line.distance(q[..., k, :2])
        yield "bend", self._numbers, beyond
        if len(self._curved) > 0:
            allowed = self._largest * np.maximum(lengths[..., self._curved], 0.0)
            yield "curvature", self._numbers[self._curved], bends[..., self._curved] - allowed
        if len(self._drive) > 0:
            ends = np.array([self._row(each) for each in self._drive.actuators], np.intp)
            yield "actuator", ends, self._drive.excess(q)

    def sides(self, q: Floats) -> Iterator[Limit]:
        """Yield all limits of shapes at the configuration `q` (n, 3), segment by segment, actuators last.

        Those of tensions, which the shape alone does not show, are `tension_rows`.
        """
        count = len(q)
        parts = zip(self._segments, self._curvatures, self._radii, q.tolist(), strict=True)
        for number, (segment, tightest, radius, (ux, uy, length)) in enumerate(parts, 1):
            for i, sign in enumerate((-1.0, 1.0)):
                slack = sign * (segment.length[i] - length)
                shift, key = (segment.low, "limits") if isinstance(segment, RigidRow) else (0.0, "length")
                end = number, None, f"{key}[{i}]", length + shift, segment.length[i] + shift
                fixed = segment.length[0] == segment.length[1]
                yield Limit("length", *end, slack, gradient_at(count, number, (0.0, 0.0, sign)), fixed)
            line = self._bends[number - 1]
            if isinstance(line, BendLine):
                yield from self._in_plane(number, line, q[number - 1])
                continue
            bend = math.hypot(ux, uy)
            most = segment.max_bend if segment.length[1] > 0.0 else 0.0
            outward = [(ux / bend, uy / bend)] if bend > 0.0 else [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
            for x, y in outward:
                end = number, None, "max_bend", bend, most
                yield Limit("bend", *end, most - bend, gradient_at(count, number, (x, y, 0.0)), most == 0.0)
                if math.isfinite(tightest):
                    curvature = bend / length if length > 0.0 else 0.0
                    thick = "radius" if radius == segment.radius else "self_clearance"
                    key = "max_curvature" if tightest == segment.max_curvature else thick
                    own, slack = (number, None, key, curvature, tightest), tightest * length - bend
                    yield Limit("curvature", *own, slack, gradient_at(count, number, (x, y, -tightest)))
        yield from self._of_actuators(q)

    def _in_plane(self, number: int, line: BendLine, own: Floats) -> Iterator[Limit]:
        """Yield the limits of a bend in one plane, of segment `number`; none of them gives across it."""
        count, (px, py), tightest = len(self._segments), line.plane, self._curvatures[number - 1]
        z, locked = float(own[:2] @ np.array(line.plane)), line.low == line.high
        key = "locked" if locked else "plane"
        there, off = np.array(line.at(line.low if locked else z)), np.array((-py, px))
        across = own[:2] @ off, np.array(line.at(0.0)) @ off  # anywhere on the line: exact at its beginning
        value, limit = across if not locked else (math.hypot(*own[:2]), math.hypot(*there))
        for x, y in ((-py, px), (py, -px), *(((px, py), (-px, -py)) if locked else ())):
            slack, gradient = float((there - own[:2]) @ (x, y)), gradient_at(count, number, (x, y, 0.0))
            yield Limit("bend", number, None, key, float(value), float(limit), slack, gradient, True)
        own_key = "limits" if self._segments[number - 1].rigid else "max_bend"
        pair = isinstance(self._segments[number - 1].own_max_bend, tuple)
        for i, (side, cap) in enumerate(() if locked else ((-1.0, line.low), (1.0, line.high))):
            end = number, None, f"{own_key}[{i}]" if pair else own_key, z, cap
            along = side * px, side * py
            yield Limit("bend", *end, side * (cap - z), gradient_at(count, number, (*along, 0.0)))
            if math.isfinite(tightest):
                curved, aside = tightest * float(own[2]), math.hypot(*line.rest)
                most = math.sqrt(max(0.0, curved**2 - aside**2))
                growth = tightest * curved / most if most > 0.0 else tightest
                bent = math.hypot(z, aside) / float(own[2]) if own[2] > 0.0 else 0.0
                held = number, None, "max_curvature", bent, tightest
                yield Limit("curvature", *held, most - side * z, gradient_at(count, number, (*along, -growth)))

    def _of_actuators(self, q: Floats) -> Iterator[Limit]:
        drive = self._drive
        there = zip(drive.displacements(q).tolist(), drive.values(q).tolist(), strict=True)
        rows = zip(drive.actuators, there, drive.limits.tolist(), drive.scales.tolist(), drive.jacobian, strict=True)
        for actuator, (displacement, value), own, scale, row in rows:
            key = self._key(actuator)
            order = (0, 1) if actuator.gain > 0.0 else (1, 0)
            for i, sign in enumerate((-1.0, 1.0)):
                if math.isfinite(own[i]):
                    limit = actuator.limits[order[i]]
                    end = i if key.endswith(".displacement") or key.endswith(".length") else order[i]
                    slack, gradient = sign * (own[i] - displacement) / scale, (sign / scale) * row.reshape(-1, 3)
                    name = self._row(actuator), actuator.name, f"{key}[{end}]"
                    yield Limit("actuator", *name, value, limit, slack, gradient, motor=_motor(actuator))

    def _row(self, actuator: Actuator) -> int:
        """Number of the row, 1 = first, that an actuator ends at."""
        return self._drive.before + actuator.segment

    def _key(self, actuator: Actuator) -> str:
        """What the problem file calls the limits of an actuator."""
        segment = self._segments[self._row(actuator) - 1]
        if actuator.kind == "tendon" and segment.tendons is not None:
            return f"tendons.{segment.tendons.limited_by}"
        if actuator.kind == "chamber" and segment.chambers is not None:
            return f"chambers.{segment.chambers.limited_by}"
        return "actuators.limits"

    def used_up(self, q: Floats, initial: Floats, bends: Floats, lengths: Floats, values: Floats) -> Iterator[Limit]:
        """Yield the changes from `initial` (n, 3) to `q` (n, 3) that are used up, segment by segment, actuators last.

        Those allowed are `bends` and `lengths` (n,), and those of `values` (m,) of actuators.
        """
        count = len(q)
        for number, (ux, uy, length) in enumerate((q - initial).tolist(), 1):
            bend, rigid = math.hypot(ux, uy), self._segments[number - 1].rigid
            most = float(bends[number - 1])
            if _used_up(bend, most):
                outward = gradient_at(count, number, (ux / bend, uy / bend, 0.0))
                yield Limit(
                    "bend_rate", number, None, "rates.joint" if rigid else "rates.bend", bend, most, 0.0, outward
                )
            most = float(lengths[number - 1])
            if _used_up(abs(length), most):
                outward = gradient_at(count, number, (0.0, 0.0, math.copysign(1.0, length)))
                key = "rates.joint" if rigid else "rates.length"
                yield Limit("length_rate", number, None, key, abs(length), most, 0.0, outward)
        drive = self._drive
        moved = drive.values(q) - drive.values(initial)
        changes, slopes = np.abs(moved), drive.jacobian
        if drive.elastic is not None and np.isfinite(values[drive.elastic.places]).any():
            changes, slopes = drive.greatest_speeds(initial, q - initial), drive.slopes_at(q)
        rows = zip(drive.actuators, changes.tolist(), moved, values.tolist(), drive.scales, slopes, strict=True)
        for actuator, change, way, most, scale, row in rows:
            if _used_up(change, most):
                outward = (np.sign(way * actuator.gain) / scale) * row.reshape(-1, 3)
                name = self._row(actuator), actuator.name, "rates.actuator"
                yield Limit("actuator_rate", *name, change, most, 0.0, outward, motor=_motor(actuator))


def _motor(actuator: Actuator) -> Actuator | None:
    plain = actuator.unit is None and (actuator.gain, actuator.offset) == (1.0, 0.0)
    return None if plain else actuator


def gradient_at(segments: int, number: int, weights: tuple[float, float, float]) -> Floats:
    """A gradient (n, 3) that has these weights at one segment, 1 = first, and zeros elsewhere."""
    gradient = np.zeros((segments, 3))
    gradient[number - 1] = weights
    return gradient


def normal(limit: Limit, unit: float) -> Floats:
    """Gradient (3 n,) of what a limit bounds, in coordinates where a length counts in `unit` and a bend in rad."""
    return (limit.gradient * [1.0, 1.0, unit]).ravel()


def _used_up(change: float, most: float) -> bool:
    return change > 0.0 and change >= (1.0 - USED_UP) * most
