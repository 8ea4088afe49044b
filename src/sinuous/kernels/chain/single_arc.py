"""The one arc that begins along a tangent and ends at a point: its bend and its length.

The chord makes half the bend with the first tangent, and is `sin(half) / half` of the length.
"""

import math

STRAIGHT = 1e-9
"""Half a bend up to which chord and arc have the same length, in rad."""

MOST_HALF_BEND = math.pi - 1e-6
"""A point straight behind has no arc; what is nearly closed has one of this half bend, in rad."""


def arc_length(chord: float, half: float) -> float:
    """Length of the arc over a chord of this length, where `half` (rad) is half its bend."""
    return chord * half / math.sin(half) if half > STRAIGHT else chord


def arc_to(lateral: float, ahead: float) -> tuple[float, float]:
    """Half the bend (rad) and the length of the arc to a point so far aside of the first tangent, and ahead along it.

    `lateral` is not negative; both are in the length unit.
    """
    half = min(math.atan2(lateral, ahead), MOST_HALF_BEND)
    return half, arc_length(math.hypot(lateral, ahead), half)
