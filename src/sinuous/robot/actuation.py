"""The linear map from configurations to the values of all actuators, and the rows of their limits; plain NumPy.

A tendon that ends at segment k sees the sum of the coordinates of segments 1 to k, a chamber those of its segment, and
each of `Actuators` all of them. Arrays are (..., n, 3) for configurations and (..., m) for values.

A row of the table of actuator limits weighs the coordinates of one segment, or the sums over all segments from the
first to one. What cannot move adds a constant, whatever its weight.
"""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, MAX_LENGTH, MIN_LENGTH
from sinuous.packing import actuator_row
from sinuous.robot.actuators import Actuators, Lines
from sinuous.robot.names import line_names, refuse_repeated
from sinuous.robot.segment import Segment, segment_names

Kind = Literal["tendon", "chamber", "linear"]

TOGETHER = 256
"""Vectors that are multiplied at once. NumPy hands more of them to several threads, which wait for each other longer
than such small matrices take."""


class Actuator(NamedTuple):
    """One actuator of a robot.

    Attributes
    ----------
    name : str
        Of its own, or by default `s1.t1`, `s1.c1`, `a1`.
    kind : str
        `tendon`: its value is the displacement, positive when pulled. `chamber`: its value is the length. `linear`: one
        of `Actuators`.
    segment : int
        Segment where it ends, 1 = first: the last one whose coordinates it sees.
    limits : (float, float)
        Least and largest value; infinite where there is no limit.
    """

    name: str
    kind: Kind
    segment: int
    limits: tuple[float, float]


class Line(NamedTuple):
    """A tendon or a chamber: its key in the robot, who it is, and its weights of bend_x, bend_y, length."""

    key: str
    actuator: Actuator
    weights: tuple[float, float, float]


class Actuation(Frozen):
    """All actuators of a robot, and what their values are.

    Parameters
    ----------
    segments : sequence of Segment
    linear : Actuators or None

    Attributes
    ----------
    actuators : tuple of Actuator
        Segment by segment, tendons before chambers, then `linear`.
    limits : ndarray (m, 2)
    gains : ndarray (m,)
        What values are divided by to count in the length unit: 1 but for `linear`. There it is the largest weight,
        those of bends divided by the mean length of the robot.

    Raises
    ------
    InputError
        When a name stands twice, or the matrix of `linear` is for another number of segments.
    """

    actuators: tuple[Actuator, ...]
    limits: Floats
    gains: Floats
    _weights: Floats
    _sums: NDArray[np.intp]
    _matrix: Floats

    def __init__(self, segments: Sequence[Segment], linear: Actuators | None) -> None:
        count = len(segments)
        names = segment_names(segments)
        refuse_repeated((f"segments[{k}].name", name) for k, name in enumerate(names))
        lines = [line for k, segment in enumerate(segments) for line in _lines(k, names[k], segment)]
        coupled = [] if linear is None else _coupled(linear, count)
        named = [(line.key, line.actuator.name) for line in lines]
        refuse_repeated([*named, *((f"actuators.names[{i}]", each.name) for i, each in enumerate(coupled))])
        listed = (*(line.actuator for line in lines), *coupled)
        # Segments and sums stand side by side: a chamber looks at a segment, a tendon at a sum.
        sums = [each.segment - 1 + (count if each.kind == "tendon" else 0) for each in listed[: len(lines)]]
        matrix = np.zeros((0, 3 * count)) if linear is None else linear.matrix
        arrays = {
            "limits": np.array([each.limits for each in listed], np.float64).reshape(-1, 2),
            "gains": np.concatenate([np.ones(len(lines)), _gains(matrix, segments)]),
            "_weights": np.array([line.weights for line in lines], np.float64).reshape(-1, 3),
            "_sums": np.array(sums, np.intp),
            "_matrix": matrix,
        }
        for array in arrays.values():
            array.flags.writeable = False
        self._set(actuators=listed, **arrays)

    def __len__(self) -> int:
        return len(self.actuators)

    @property
    def linear_gains(self) -> Floats:
        """Gains of `Actuators` alone."""
        return self.gains[len(self._weights) :]

    def values(self, q: Floats) -> Floats:
        """Values (..., m) of all actuators in configurations (..., n, 3)."""
        return self._sums_of(q) if q.ndim == 2 else product(flat(q), self.jacobian)

    def _sums_of(self, q: Floats) -> Floats:
        """Compute the same from sums over the segments, without a matrix whose size is that of the robot squared."""
        both = np.concatenate([q, np.cumsum(q, axis=-2)], axis=-2)
        lines = np.einsum("...lc,lc->...l", both[..., self._sums, :], self._weights)
        return np.concatenate([lines, flat(q) @ self._matrix.T], axis=-1)

    @cached_property
    def jacobian(self) -> Floats:
        """Derivative (m, 3 n) of the values by the coordinates, read-only: the same everywhere."""
        columns = self._matrix.shape[1]
        result: Floats = np.ascontiguousarray(self._sums_of(np.eye(columns).reshape(columns, -1, 3)).T)
        result.flags.writeable = False
        return result

    def limit_rows(self) -> Iterator[list[float]]:
        """Yield the rows of the table of limits for tendons and chambers; those of `Actuators` see `coupled_rows`."""
        for each, weights in zip(self.actuators, self._weights.tolist(), strict=False):
            if math.isfinite(each.limits[0]) or math.isfinite(each.limits[1]):
                last = each.segment - 1
                yield actuator_row(0 if each.kind == "tendon" else last, last, weights, each.limits)

    def excess(self, q: Floats) -> Floats:
        """By how much values (..., m) are below or above their limits, in the length unit; negative within them."""
        values = self.values(q)
        result: Floats = np.maximum(self.limits[:, 0] - values, values - self.limits[:, 1]) / self.gains
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
    """Yield the tendons, then the chambers of segment `k`, 0 = first."""
    if segment.tendons is not None:
        for key, each, (x, y) in _named(k, name, "tendon", segment.tendons, segment.tendons.displacement):
            yield Line(key, each, (x, y, 0.0))
    if segment.chambers is not None:
        for key, each, (x, y) in _named(k, name, "chamber", segment.chambers, segment.chambers.length):
            yield Line(key, each, (-x, -y, 1.0))


def _named(
    k: int, segment: str, kind: Kind, lines: Lines, limits: tuple[float, float]
) -> Iterator[tuple[str, Actuator, tuple[float, float]]]:
    names = line_names(segment, kind[0], lines.names, len(lines.angles))
    for j, (name, (x, y)) in enumerate(zip(names, lines.arms.tolist(), strict=True)):
        yield f"segments[{k}].{kind}s.names[{j}]", Actuator(name, kind, k + 1, limits), (x, y)


def _coupled(linear: Actuators, segments: int) -> list[Actuator]:
    rows, columns = linear.matrix.shape
    if columns != 3 * segments:
        raise InputError(
            "actuators.matrix", "", linear.matrix.shape, f"shape ({rows}, {3 * segments}), for {segments} segments"
        )
    last = [int(np.flatnonzero(row)[-1]) // 3 + 1 for row in linear.matrix]
    return [
        Actuator(name, "linear", segment, limits)
        for name, segment, limits in zip(linear.names, last, linear.limits, strict=True)
    ]


def _gains(matrix: Floats, segments: Sequence[Segment]) -> Floats:
    """Largest weight of each row; see `Actuation`."""
    unit = 0.5 * sum(sum(segment.length) for segment in segments)
    sizes = np.abs(matrix.reshape(len(matrix), len(segments), 3)) / (unit, unit, 1.0)
    result: Floats = sizes.max(axis=(1, 2), initial=0.0)
    return result


ROUNDING = 1e-13
"""Relative to its values: how near to a limit the straight robot counts as on it, and what the limit is eased by."""


def coupled_rows(linear: Actuators, gains: Floats, limits: Floats) -> Iterator[list[float]]:
    """Yield the rows of the table for those whose limits can be violated at all.

    Parameters
    ----------
    linear : Actuators
    gains : ndarray (m,)
        What their values are divided by, so that they count in the length unit.
    limits : ndarray (n, 8)
        Rows of the segments, laid out as `sinuous.kernels.tables` says.

    Raises
    ------
    InputError
        When a row has limits and is of another form, or when a straight robot would violate them.
    """
    moves = limits[:, [BEND_SCALE, BEND_SCALE, LENGTH_SCALE]] > 0.0
    lengths = limits[:, [MIN_LENGTH, MAX_LENGTH]]
    for i, (row, pair, gain) in enumerate(zip(linear.matrix, linear.limits, gains, strict=True)):
        weights = row.reshape(-1, 3)
        if math.isfinite(pair[0]) or math.isfinite(pair[1]):
            with checks.inside(f"actuators.limits[{i}]"):
                eased = _eased(weights, pair, lengths)
                if (weights[:, :2] * moves[:, :2]).any():  # otherwise straight robots have all its values
                    first, last, *numbers = _row(weights, eased, moves, lengths)
                    yield [first, last, *(number / gain for number in numbers)]


def _eased(weights: Floats, pair: tuple[float, float], lengths: Floats) -> tuple[float, float]:
    """Limits that no straight robot violates by rounding; refused where one violates them by more.

    Solvers count on that: they go back towards the straight robot where actuators hold them.
    """
    ends = weights[:, 2:] * lengths
    low, high = float(ends.min(axis=1).sum()), float(ends.max(axis=1).sum())
    slack = ROUNDING * max(abs(low), abs(high))
    if pair[0] > low + slack or high - slack > pair[1]:
        raise InputError("", "excludes straight robots", pair, f"limits that contain [{low:g}, {high:g}]")
    return min(pair[0], low - slack), max(pair[1], high + slack)


def _row(weights: Floats, pair: tuple[float, float], moves: NDArray[np.bool_], lengths: Floats) -> list[float]:
    seen = np.where(moves, weights, 0.0)
    last = int(np.flatnonzero(seen.any(axis=1))[-1])
    fixed = np.where(moves[:, 2], 0.0, lengths[:, 0])
    constant = float(weights[:, 2] @ fixed)
    if not seen[:last].any():
        return actuator_row(last, last, seen[last].tolist(), (pair[0] - constant, pair[1] - constant))
    common = [seen[: last + 1, c][moves[: last + 1, c]] for c in range(3)]
    if any((column != column[0]).any() for column in common if len(column)):
        raise InputError("", "", pair, "none: its weights are not on one segment, nor equal from the first up to one")
    shared = [float(column[0]) if len(column) else 0.0 for column in common]
    shift = shared[2] * float(fixed[: last + 1].sum()) - constant
    return actuator_row(0, last, shared, (pair[0] + shift, pair[1] + shift))
