"""By how much configurations violate the limits of a robot; plain NumPy, no table of the kernels is read.

The thickness of the body is a limit of curvature where the body must not run through itself.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import LimitKind
from sinuous.base.checks import Floats
from sinuous.kernels.packing import BendLine
from sinuous.model.actuation import Actuation
from sinuous.model.segment import Segment

ROUND = 1e-9
"""By how much the largest curvature is less than 1 / radius, relative to it: there, half a circle touches itself."""


def curvature_limits(segments: Sequence[Segment], radii: Sequence[float], avoids_itself: bool) -> tuple[float, ...]:
    """Largest curvature of every segment: its own limit and, where it must not run through itself, 1 / radius."""
    return tuple(
        min(segment.max_curvature, (1.0 - ROUND) / radius) if avoids_itself and radius > 0.0 else segment.max_curvature
        for segment, radius in zip(segments, radii, strict=True)
    )


def held_back(segments: Sequence[Segment], radii: Sequence[float], curvatures: Sequence[float]) -> list[str]:
    """Say which segments may bend less than their own limits allow, because they are too thick; one line a kind.

    It is said for their least length, for one that may vanish for its largest: near 0, curvature always limits a bend.
    """
    notes, first = [], 1
    for (segment, radius, curvature), group in groupby(zip(segments, radii, curvatures, strict=True)):
        last = first + len(list(group)) - 1
        length = segment.length[0] or segment.length[1]
        own, allowed = min(segment.max_bend, segment.max_curvature * length), curvature * length
        if allowed < own * (1.0 - 2.0 * ROUND):
            half = "" if radius == segment.radius else ", with half of the demanded clearance from itself,"
            which = f"segment {first}" if first == last else f"segments {first} to {last}"
            notes.append(
                f"{which}: a radius of {radius:g}{half} is above the smallest radius of curvature, {length / own:.4g}; "
                f"while self_collision is avoided, the bend at length {length:g} is at most {allowed:.4g}"
            )
        first = last + 1
    return notes


Violation = tuple[LimitKind, int, float]
"""A limit (`length`, `bend`, `curvature`, `actuator`), its segment (1 = first), and by how much it is violated."""


def unit_of(limit: LimitKind, mean_length: float) -> float:
    """Return the unit of rounding of a limit: 1 rad for angles, the mean length of the robot for lengths.

    A tolerance is a multiple of it. So a tolerance means the same in every unit of length.
    """
    return 1.0 if limit in ("bend", "curvature") else mean_length


class ShapeLimits:
    """Limits of segments, with these largest curvatures (n,), and of actuators: by how much shapes violate them."""

    def __init__(self, segments: Sequence[Segment], curvatures: Sequence[float], actuation: Actuation) -> None:
        self._numbers = np.arange(1, len(segments) + 1)
        bends = actuation.coordinates.bends
        self._low, self._high = actuation.coordinates.lengths.T
        self._bends = np.array([math.inf if isinstance(each, BendLine) else each for each in bends])
        self._planar = [(k, each) for k, each in enumerate(bends) if isinstance(each, BendLine)]
        columns = self._low, self._high, self._bends, np.array(curvatures)
        self._rows = np.stack(columns, axis=-1).tolist()
        self._curved = np.flatnonzero(np.isfinite(curvatures))
        self._curvatures = np.array(curvatures)[self._curved]
        self._actuation = actuation

    def excess(self, q: Floats) -> float:
        """By how much configurations (..., n, 3) are outside the limits, at worst; 0 within all of them."""
        return max(float(np.max(amounts, initial=0.0)) for _, _, amounts in self._amounts(q))

    def violations(self, q: Floats, slack: float, mean_length: float) -> list[Violation]:
        """List what a configuration (n, 3) violates, segment by segment, actuators last.

        `slack` is allowed: as it is for angles, times the `mean_length` of the robot for lengths, see `unit_of`.
        """
        if self._keeps_segments(q) and not len(self._actuation):  # most are, and that is soon seen
            return []
        found = [
            (name, int(number), float(amount))
            for name, numbers, amounts in self._amounts(q)
            if amounts.size > 0 and amounts.max() > slack * unit_of(name, mean_length)
            for number, amount in zip(numbers, amounts, strict=True)
            if amount > slack * unit_of(name, mean_length)
        ]
        return sorted(found, key=lambda each: (each[0] == "actuator", each[1]))

    def _keeps_segments(self, q: Floats) -> bool:
        """Whether a configuration (n, 3) is well within the limits of all segments, none of which bends in a plane."""
        if self._planar:
            return False
        for (x, y, length), (low, high, most, curvature) in zip(q.tolist(), self._rows, strict=True):
            bend = math.hypot(x, y)
            if not (low <= length <= high and bend <= most and (bend == 0.0 or bend <= curvature * length)):
                return False
        return True

    def _amounts(self, q: Floats) -> Iterator[tuple[LimitKind, NDArray[Any], Floats]]:
        """Yield kinds of limits, the segments (k,) that have one, and by how much each is exceeded (..., k)."""
        bends, lengths = np.hypot(q[..., 0], q[..., 1]), q[..., 2]
        yield "length", self._numbers, np.maximum(self._low - lengths, lengths - self._high)
        beyond = bends - self._bends
        for k, line in self._planar:
            beyond[..., k] = line.distance(q[..., k, :2])
        yield "bend", self._numbers, beyond
        if len(self._curved) > 0:
            allowed = self._curvatures * np.maximum(lengths[..., self._curved], 0.0)
            yield "curvature", self._numbers[self._curved], bends[..., self._curved] - allowed
        if len(self._actuation) > 0:
            ends = np.array([each.segment for each in self._actuation.actuators], np.intp)
            yield "actuator", ends, self._actuation.excess(q)
