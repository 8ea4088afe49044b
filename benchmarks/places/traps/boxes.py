"""Walls of boxes."""

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.obstacles import Box


def box_between(frame: Floats, low: Floats, high: Floats, name: str) -> Box:
    """Return the box from corner `low` (3,) to corner `high` (3,) of a frame (4, 4)."""
    middle = frame[:3, 3] + frame[:3, :3] @ (0.5 * (low + high))
    return Box(middle, high - low, frame[:3, :3], name=name)


def channel(frame: Floats, half: float, length: float, wall: float) -> list[Box]:
    """Return four walls around the z axis of a frame (4, 4), `2 * half` apart, from its origin on."""
    outer = half + wall
    walls = list[Box]()
    for axis in (0, 1):
        for side in (-1.0, 1.0):
            low, high = np.array([-outer, -outer, 0.0]), np.array([outer, outer, length])
            low[axis], high[axis] = sorted((side * half, side * outer))
            walls.append(box_between(frame, low, high, f"wall {len(walls) + 1}"))
    return walls
