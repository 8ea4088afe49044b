"""Walls of boxes that touch each other and nowhere overlap."""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Box


def box_between(frame: Floats, low: Floats, high: Floats, name: str) -> Box:
    """Return the box from corner `low` (3,) to corner `high` (3,) of a frame (4, 4)."""
    middle = frame[:3, 3] + frame[:3, :3] @ (0.5 * (low + high))
    return Box(middle, high - low, frame[:3, :3], name=name)


def walls_around(frame: Floats, low: Floats, high: Floats, wall: float, name: str) -> list[Box]:
    """Return four walls along the z axis of a frame, outside of the box from `low` (3,) to `high` (3,)."""
    a, b = low - np.array([wall, wall, 0.0]), high + np.array([wall, wall, 0.0])
    sides = (
        ([a[0], a[1], low[2]], [low[0], b[1], high[2]]),
        ([high[0], a[1], low[2]], [b[0], b[1], high[2]]),
        ([low[0], a[1], low[2]], [high[0], low[1], high[2]]),
        ([low[0], high[1], low[2]], [high[0], b[1], high[2]]),
    )
    return [box_between(frame, np.array(c), np.array(d), f"{name} {i + 1}") for i, (c, d) in enumerate(sides)]


def channel(frame: Floats, half: float, length: float, wall: float, name: str = "wall") -> list[Box]:
    """Return four walls around the z axis of a frame (4, 4), `2 * half` apart, from its origin on."""
    low, high = np.array([-half, -half, 0.0]), np.array([half, half, length])
    return walls_around(frame, low, high, wall, name)


def wall_with_door(frame: Floats, low: Floats, high: Floats, door: Floats, name: str) -> list[Box]:
    """Return the box from `low` (3,) to `high` (3,) but for a door right through it along z.

    `door` (2, 2) are the corners of the door in x and y.
    """
    (x, y), (u, v) = door
    pieces = (
        ([low[0], low[1]], [x, high[1]]),
        ([u, low[1]], [high[0], high[1]]),
        ([x, low[1]], [u, y]),
        ([x, v], [u, high[1]]),
    )
    return [
        box_between(frame, np.append(a, low[2]), np.append(b, high[2]), f"{name} {i + 1}")
        for i, (a, b) in enumerate(pieces)
    ]
