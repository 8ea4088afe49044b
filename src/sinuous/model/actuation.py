"""From configurations to the values of all actuators, and the rows of their limits; plain NumPy.

A tendon that ends at segment k sees the sum of the coordinates of segments 1 to k, a chamber or a stage those of its
segment, and each of `Actuators` all of them: their displacements are linear in the configuration. What motors make of
displacements is in `motors`; kernels know displacements only. Arrays are (..., n, 3) for configurations and (..., m)
for displacements and values.

A row of the table of actuator limits weighs the coordinates of one segment, or the sums over all segments from the
first to one. What cannot move adds a constant, whatever its weight.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats, line_names, refuse_repeated
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.kernels.packing import actuator_row
from sinuous.model.actuators import UNLIMITED, Actuators, Lines, Motors, Stage
from sinuous.model.coordinates import Coordinates
from sinuous.model.elastic import Elastic
from sinuous.model.segment import Segment, segment_names

Kind = Literal["tendon", "chamber", "stage", "linear"]

STRETCH_STEP = 1e-6
"""Step of the difference that stands for the derivative of the stretch of elastic actuators: rad, or length unit."""

TOGETHER = 256
"""Vectors that are multiplied at once. NumPy hands more of them to several threads, which wait for each other longer
than such small matrices take."""


class Actuator(NamedTuple):
    """One actuator of a robot.

    Attributes
    ----------
    name : str
        Of its own, or by default `s1.t1`, `s1.c1`, `s1`, `a1`.
    kind : str
        `tendon`: its displacement is positive when it is pulled. `chamber`, `stage`: the displacement is the length.
        `linear`: one of `Actuators`.
    segment : int
        Segment where it ends, 1 = first: the last one whose coordinates it sees; below 1 where these are joints.
    limits : (float, float)
        Least and largest value, in the unit of the motor; infinite where there is no limit.
    gain, offset : float
        Its value is gain x displacement + offset.
    unit : str or None
        What the value counts; nothing was said with `None`.
    """

    name: str
    kind: Kind
    segment: int
    limits: tuple[float, float]
    gain: float = 1.0
    offset: float = 0.0
    unit: str | None = None


class Line(NamedTuple):
    """A tendon, a chamber or a stage.

    Its key in the robot, who it is, its weights of bend_x, bend_y, length, and limits of its displacement beside those
    of the segment.
    """

    key: str
    actuator: Actuator
    weights: tuple[float, float, float]
    limits: tuple[float, float]


class Actuation(Frozen):
    """All actuators of a robot: what their displacements are, and the values of their motors.

    Parameters
    ----------
    segments : sequence of Segment
    linear : Actuators or None
    curvatures : sequence of float (n,)
        The largest ones of segments.

    Attributes
    ----------
    coordinates : Coordinates
        What of a configuration can move.
    actuators : tuple of Actuator
        Segment by segment, tendons before chambers before the stage, then `linear`.
    before : int
        Rows of joints and links before the segments.
    elastic : Elastic or None
        What knows those that stretch.
    limits : ndarray (m, 2)
        Of the displacements, of elastic ones without their stretch; infinite for stages, which the limits of their
        segments hold.
    scales : ndarray (m,)
        What displacements are divided by to count in the length unit: 1 but for `linear`. There it is the largest
        weight, those of bends divided by the mean length of the robot.

    Raises
    ------
    InputError
        When a name stands twice, or the matrix of `linear` is for another number of segments.
    """

    actuators: tuple[Actuator, ...]
    coordinates: Coordinates
    elastic: Elastic | None
    limits: Floats
    scales: Floats
    _weights: Floats
    _sums: NDArray[np.intp]
    _matrix: Floats
    before: int

    def __init__(self, segments: Sequence[Segment], linear: Actuators | None, curvatures: Sequence[float]) -> None:
        count = len(segments)
        names = segment_names(segments)
        refuse_repeated((f"segments[{k}].name", name) for k, name in enumerate(names))
        before = sum(segment.rigid for segment in segments)
        lines = [line for k, segment in enumerate(segments) for line in _lines(k - before, names[k], segment)]
        coupled = [] if linear is None else _coupled(linear, count, before)
        named = [(line.key, line.actuator.name) for line in lines]
        refuse_repeated([*named, *((f"actuators.names[{i}]", each.name) for i, each in enumerate(coupled))])
        listed = (*(line.actuator for line in lines), *coupled)
        # Segments and sums stand side by side: a chamber looks at a segment, a tendon at a sum.
        sums = [before + each.segment - 1 + (count if each.kind == "tendon" else 0) for each in listed[: len(lines)]]
        matrix = np.zeros((0, 3 * count)) if linear is None else linear.matrix
        own = np.array([line.limits for line in lines], np.float64).reshape(-1, 2)
        arrays = {
            "limits": own if linear is None else np.concatenate([own, linear.displacements]),
            "scales": np.concatenate([np.ones(len(lines)), _scales(matrix, segments)]),
            "_weights": np.array([line.weights for line in lines], np.float64).reshape(-1, 3),
            "_sums": np.array(sums, np.intp),
            "_matrix": matrix,
        }
        for array in arrays.values():
            array.flags.writeable = False
        self._set(actuators=listed, before=before, **arrays)
        stretching = list(_elastic(segments))
        rigid = np.array(self.limits)
        rigid[[place for place, _, _ in stretching]] = UNLIMITED
        coordinates = Coordinates(segments, curvatures, self.jacobian, rigid)
        elastic = Elastic(segments, coordinates, self.jacobian, stretching) if stretching else None
        self._set(coordinates=coordinates, elastic=elastic)

    def __len__(self) -> int:
        return len(self.actuators)

    @cached_property
    def motors(self) -> Motors:
        """How displacements become values."""
        listed = self.actuators
        gain, offset = (np.array([getattr(each, key) for each in listed], np.float64) for key in ("gain", "offset"))
        return Motors(gain, offset, tuple(each.unit for each in listed))

    @property
    def linear_scales(self) -> Floats:
        """Scales of `Actuators` alone."""
        return self.scales[len(self._weights) :]

    def values(self, q: Floats) -> Floats:
        """Values (..., m) of the motors in configurations (..., n, 3): of elastic ones with the least tensions."""
        return self.motors.values(self.displacements(q) + self.stretch(q))

    def stretch(self, q: Floats) -> Floats:
        """By how much actuators (..., m) are displaced beyond what configurations (..., n, 3) ask of rigid ones."""
        result = np.zeros((*q.shape[:-2], len(self)))
        if self.elastic is not None:
            result[..., self.elastic.places] = self.elastic.stretch(q)
        return result

    def tensions(self, q: Floats, displacements: Floats) -> Floats:
        """Tensions (..., m) at these displacements (..., m) in configurations (..., n, 3); NaN of rigid actuators."""
        result = np.full((*q.shape[:-2], len(self)), math.nan)
        if self.elastic is not None:
            result[..., self.elastic.places] = self.elastic.tensions(displacements, q)
        return result

    def speeds(self, dq: Floats, q: Floats | None = None) -> Floats:
        """How fast the values of the motors change (..., m) when configurations do so (..., n, 3).

        The stretch of elastic actuators counts where their configurations `q` (..., n, 3) are given.
        """
        result = self.motors.speeds(self.displacements(dq))
        if self.elastic is None or q is None:
            return result
        step = STRETCH_STEP / np.maximum(np.abs(dq).max(axis=(-2, -1), keepdims=True), STRETCH_STEP)
        change = self.stretch(q + step * dq) - self.stretch(q - step * dq)
        return result + self.motors.speeds(change / (2.0 * step[..., 0]))

    def greatest_speeds(self, q: Floats, moves: Floats, later: Floats | None = None) -> Floats:
        """How fast the values of the motors change at most (..., m) on straight ways from `q`, by `moves` (..., n, 3).

        In a unit of time; the stretch of elastic actuators counts, also where tendons go slack on the way. On parabolas
        the slope grows from `moves` to `later`, which elastic ones know where their speeds are `linear`.
        """
        result = np.abs(self.speeds(moves))
        if later is not None:
            result = np.maximum(result, np.abs(self.speeds(later)))
        if self.elastic is not None:
            own = self.elastic.speeds
            most = own.most(q, moves) if later is None else own.most_curved(q, moves, later)
            result[..., self.elastic.places] = np.abs(self.motors.gain[self.elastic.places]) * most
        return result

    def slopes_at(self, q: Floats) -> Floats:
        """Derivative (m, 3 n) of displacements by the shape at `q` (n, 3), with the stretch of elastic actuators."""
        if self.elastic is None:
            return self.jacobian
        result, speeds = np.array(self.jacobian), self.elastic.speeds
        rows = np.flatnonzero(speeds.on_top(q))
        result[self.elastic.places] = speeds.slopes_at(q)[rows[np.unique(speeds.row_lines[rows], return_index=True)[1]]]
        return result

    def in_words(self, values: Mapping[str, float]) -> str:
        """Values of the motors by name, with their units, on one line; two spaces between them."""
        units = {each.name: each.unit for each in self.actuators}
        said = ((name, value, units[name]) for name, value in values.items())
        return "  ".join(f"{name}={value:.4g}" + (f" {unit}" if unit else "") for name, value, unit in said)

    def displacements(self, q: Floats) -> Floats:
        """Displacements (..., m) of all actuators in configurations (..., n, 3)."""
        return self._sums_of(q) if q.ndim == 2 else product(flat(q), self.jacobian)

    def _sums_of(self, q: Floats) -> Floats:
        """Compute the same from sums over the segments, without a matrix whose size is that of the robot squared."""
        summed = np.cumsum(q[..., self.before :, :], axis=-2)
        both = np.concatenate([q, q[..., : self.before, :], summed], axis=-2)
        lines = np.einsum("...lc,lc->...l", both[..., self._sums, :], self._weights)
        return np.concatenate([lines, flat(q) @ self._matrix.T], axis=-1)

    @cached_property
    def jacobian(self) -> Floats:
        """Derivative (m, 3 n) of the displacements by the coordinates, read-only: the same everywhere."""
        columns = self._matrix.shape[1]
        return checks.closed(np.ascontiguousarray(self._sums_of(np.eye(columns).reshape(columns, -1, 3)).T))

    @cached_property
    def value_jacobian(self) -> Floats:
        """Derivative (m, 3 n) of the values by the coordinates, read-only."""
        return checks.closed(self.motors.gain[:, None] * self.jacobian)

    def limit_rows(self) -> Iterator[list[float]]:
        """Yield the rows of the table of limits for tendons and chambers; those of `Actuators` see `coupled_rows`."""
        lines = zip(self.actuators, self._weights.tolist(), self.limits.tolist(), strict=False)
        for i, (each, weights, (low, high)) in enumerate(lines):
            last = self.before + each.segment - 1
            if (math.isfinite(low) or math.isfinite(high)) and self.coordinates.sees(self.jacobian[i]):
                yield actuator_row(self.before if each.kind == "tendon" else last, last, weights, (low, high))

    def excess(self, q: Floats) -> Floats:
        """By how much actuators (..., m) are below or above their limits, in the length unit; negative within them."""
        there = self.displacements(q)
        result: Floats = np.maximum(self.limits[:, 0] - there, there - self.limits[:, 1]) / self.scales
        if self.elastic is not None:
            result[..., self.elastic.places] = self.elastic.balance(q).short
        return result


def flat(q: Floats) -> Floats:
    """Configurations (..., n, 3) as vectors (..., 3 n)."""
    return q.reshape(*q.shape[:-2], q.shape[-2] * 3)


def product(vectors: Floats, matrix: Floats) -> Floats:
    """Multiply vectors (..., c) by a matrix (r, c), to (..., r)."""
    lead = vectors.shape[:-1]
    rows = vectors.reshape(math.prod(lead), matrix.shape[1])
    out = np.empty((len(rows), len(matrix)))
    for first in range(0, len(rows), TOGETHER):
        np.matmul(rows[first : first + TOGETHER], matrix.T, out=out[first : first + TOGETHER])
    return out.reshape(*lead, len(matrix))


def _lines(k: int, name: str, segment: Segment) -> Iterator[Line]:
    """Yield the tendons, then the chambers, then the stage of segment `k`, 0 = first."""
    if segment.tendons is not None:
        for key, each, (x, y), own in _named(k, name, "tendon", segment.tendons):
            yield Line(key, each, (x, y, 0.0), own)
    if segment.chambers is not None:
        for key, each, (x, y), own in _named(k, name, "chamber", segment.chambers):
            yield Line(key, each, (-x, -y, 1.0), own)
    if segment.stage is not None:
        yield _stage(k, segment.stage.name or name, segment.length, segment.stage)


def _named(
    k: int, segment: str, kind: Kind, lines: Lines
) -> Iterator[tuple[str, Actuator, tuple[float, float], tuple[float, float]]]:
    names = line_names(segment, kind[0], lines.names, len(lines.angles))
    limits = lines.displacements
    each = _actuators(names, kind, [k + 1] * len(names), lines.motors, limits)
    rows = zip(each, lines.arms.tolist(), lines.unstretched.tolist(), strict=True)
    for j, (actuator, (x, y), (low, high)) in enumerate(rows):
        yield f"segments[{k}].{kind}s.names[{j}]", actuator, (x, y), (low, high)


def _elastic(segments: Sequence[Segment]) -> Iterator[tuple[int, Lines, int]]:
    """Yield which actuators are elastic: their places, what they belong to, and which of its lines they are."""
    at = 0
    for segment in segments:
        for lines in (segment.tendons, segment.chambers):
            if lines is not None:
                if lines.stiffness is not None:
                    yield from ((at + j, lines, j) for j in range(len(lines.angles)))
                at += len(lines.angles)
        at += segment.stage is not None


def _stage(k: int, name: str, length: tuple[float, float], stage: Stage) -> Line:
    (actuator,) = _actuators([name], "stage", [k + 1], stage.motors, np.array([length]))
    return Line(f"segments[{k}].stage.name", actuator, (0.0, 0.0, 1.0), UNLIMITED)


def _actuators(
    names: Sequence[str], kind: Kind, segments: Sequence[int], motors: Motors, limits: Floats
) -> list[Actuator]:
    """Make actuators with these limits (m, 2) of their displacements."""
    of_motors = motors.limits_of_values(limits).tolist(), motors.gain.tolist(), motors.offset.tolist(), motors.unit
    return [
        Actuator(name, kind, segment, (low, high), gain, offset, unit)
        for name, segment, (low, high), gain, offset, unit in zip(names, segments, *of_motors, strict=True)
    ]


def _coupled(linear: Actuators, segments: int, before: int) -> list[Actuator]:
    rows, columns = linear.matrix.shape
    if columns != 3 * segments:
        raise InputError(
            "actuators.matrix", "", linear.matrix.shape, f"shape ({rows}, {3 * segments}), for {segments} segments"
        )
    last = [int(np.flatnonzero(row)[-1]) // 3 + 1 - before for row in linear.matrix]
    made = _actuators(linear.names, "linear", last, linear.motors, linear.displacements)
    return [each._replace(limits=limits) for each, limits in zip(made, linear.limits, strict=True)]


def _scales(matrix: Floats, segments: Sequence[Segment]) -> Floats:
    """Largest weight of each row; see `Actuation`."""
    unit = 0.5 * sum(sum(segment.length) for segment in segments)
    sizes = np.abs(matrix.reshape(len(matrix), len(segments), 3)) / (unit, unit, 1.0)
    return sizes.max(axis=(1, 2), initial=0.0)


ROUNDING = 1e-13
"""Relative to its values: how near to a limit the straight robot counts as on it, and what the limit is eased by."""


def coupled_rows(linear: Actuators, scales: Floats, coordinates: Coordinates) -> Iterator[list[float]]:
    """Yield the rows of the table for those whose limits can be violated at all.

    Parameters
    ----------
    linear : Actuators
    scales : ndarray (m,)
        What their displacements are divided by, so that they count in the length unit.
    coordinates : Coordinates

    Raises
    ------
    InputError
        When a row has limits and is of another form, or when a straight robot would violate them.
    """
    rows = zip(linear.matrix, linear.displacements.tolist(), scales, strict=True)
    for i, (row, (least, most), scale) in enumerate(rows):
        weights = row.reshape(-1, 3)
        if not math.isfinite(least) and not math.isfinite(most):
            continue
        with checks.inside(f"actuators.limits[{i}]"):
            straight = _straight(weights, coordinates.lengths)
            if coordinates.may_be_straight and not _contains((least, most), straight):
                low, high = linear.motors.limits_of_values(np.tile(straight, (len(scales), 1)))[i]
                wanted = f"limits that contain [{low:g}, {high:g}]"
                raise InputError("", "excludes straight robots", linear.limits[i], wanted)
            slack = _slack(straight)
            eased = min(least, straight[0] - slack), max(most, straight[1] + slack)
            pair = eased if coordinates.may_be_straight else (least, most)
            seen = coordinates.moving(weights)
            if seen[:, :2].any() or (seen.any() and not coordinates.free):  # else straight robots have all its values
                first, last, *numbers = _row(weights, pair, linear.limits[i], seen, coordinates)
                yield [first, last, *(number / scale for number in numbers)]


def _straight(weights: Floats, lengths: Floats) -> tuple[float, float]:
    """Least and largest displacement of straight robots.

    Solvers count on it that no straight robot violates limits: they go back towards it where actuators hold them.
    """
    ends = weights[:, 2:] * lengths
    return float(ends.min(axis=1).sum()), float(ends.max(axis=1).sum())


def _slack(straight: tuple[float, float]) -> float:
    return ROUNDING * max(map(abs, straight))


def _contains(pair: tuple[float, float], straight: tuple[float, float]) -> bool:
    return pair[0] <= straight[0] + _slack(straight) and straight[1] - _slack(straight) <= pair[1]


def _row(
    weights: Floats, pair: tuple[float, float], given: tuple[float, float], seen: Floats, coordinates: Coordinates
) -> list[float]:
    """Row of a limit whose weights (n, 3) are `seen` of what can move: on one segment, or alike up to one."""
    last = int(np.flatnonzero(seen.any(axis=1))[-1])
    constant = float((weights * coordinates.origin).sum())
    if not seen[:last].any():
        own = seen[last]
        shift = float(own @ coordinates.origin[last]) - constant
        return actuator_row(last, last, own.tolist(), (pair[0] + shift, pair[1] + shift))
    shared = coordinates.common(seen[: last + 1])
    if shared is None:
        raise InputError("", "", given, "none: its weights are not on one segment, nor equal from the first up to one")
    shift = float((coordinates.origin[: last + 1] @ shared).sum()) - constant
    return actuator_row(0, last, shared.tolist(), (pair[0] + shift, pair[1] + shift))
