"""How tightly segments may bend when the body must not run through itself: no more tightly than it is thick."""

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
    """Say which segments may bend less than their own limits allow, because they are too thick; one line a kind.

    It is said for their least length, for one that may vanish for its largest: near 0, curvature always limits a bend.
    """
    notes, first = [], 1
    for (segment, radius, curvature), group in groupby(zip(segments, radii, curvatures, strict=True)):
        last = first + len(list(group)) - 1
        length = segment.length[0] or segment.length[1]
        own, allowed = min(segment.max_bend, segment.max_curvature * length), curvature * length
        if allowed < own * (1.0 - 2.0 * ROUND):
            which = f"segment {first}" if first == last else f"segments {first} to {last}"
            notes.append(
                f"{which}: a radius of {radius:g} is above the smallest radius of curvature, {length / own:.4g}; "
                f"while self_collision is avoided, the bend at length {length:g} is at most {allowed:.4g}"
            )
        first = last + 1
    return notes
