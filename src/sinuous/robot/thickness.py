"""How tightly segments may bend when the body must not run through itself: no more tightly than it is thick."""

import math
from collections.abc import Sequence
from itertools import groupby

from sinuous.robot.segment import Segment

ROUND = 1e-9
"""By how much the largest curvature is less than 1 / radius, relative to it: there, half a circle touches itself."""


def curvature_limits(segments: Sequence[Segment], radii: Sequence[float], avoids_itself: bool) -> tuple[float, ...]:
    """Largest curvature of every segment: its own limit and, where it must not run through itself, 1 / radius."""
    return tuple(
        min(segment.max_curvature, (1.0 - ROUND) / radius) if avoids_itself and radius > 0.0 else segment.max_curvature
        for segment, radius in zip(segments, radii, strict=True)
    )


def held_back(segments: Sequence[Segment], radii: Sequence[float], curvatures: Sequence[float]) -> list[str]:
    """Say which segments may bend less than their own limits allow, because they are too thick; one line a kind."""
    listed = list(zip(segments, radii, curvatures, strict=True))
    notes, first = [], 1
    for (segment, radius, curvature), group in groupby(listed):
        last = first + len(list(group)) - 1
        own = min(segment.max_bend, segment.max_curvature * segment.length[1])
        if curvature * segment.length[1] < own * (1.0 - 1e-9):
            which = f"segment {first}" if first == last else f"segments {first} to {last}"
            tightest = segment.length[1] / own if math.isfinite(own) else 0.0
            notes.append(
                f"{which}: radius {radius:g} is above the smallest radius of curvature, {tightest:.4g}; while "
                f"self_collision is avoided, a bend is at most {curvature * segment.length[1]:.4g} at length "
                f"{segment.length[1]:g}"
            )
        first = last + 1
    return notes
