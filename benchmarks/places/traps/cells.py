"""Cells around a part of the hidden shape, each with a door where the shape goes through its wall."""

import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import curve_of
from benchmarks.places.traps.boxes import box_between, wall_with_door, walls_around
from sinuous.base.checks import Floats
from sinuous.model.poses import pose
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Box

WALL = (0.4, 1.2)
"""Thickness of walls."""

MARGIN = (1.3, 6.0)
"""Distance of the shape from the walls of its cell, each wall with its own."""

NARROW, WIDE = (1.25, 1.8), (1.25, 5.0)
"""Half of the narrower and of the wider side of a door. All three in radii of the body."""

TILT = 0.35
"""Largest angle between the shape and the normal of the wall that it goes through, rad."""

SAMPLES = 12
"""Of a segment, where it is looked at in which cell it lies."""


class Line(NamedTuple):
    """A hidden shape.

    Attributes
    ----------
    poses : ndarray (m, 4, 4)
        Frames along its backbone.
    end : ndarray (3,)
        The tool.
    radius : float
        Largest radius of the body.
    """

    poses: Floats
    end: Floats
    radius: float

    def before(self, k: int) -> Floats:
        """Points (m, 3) from the base to frame k."""
        return self.poses[: k + 1, :3, 3]

    def after(self, k: int) -> Floats:
        """Points (m, 3) from frame k to the tool."""
        return np.vstack([self.poses[k:, :3, 3], self.end])


class Cell(NamedTuple):
    """A room with one door.

    Attributes
    ----------
    frame : ndarray (4, 4)
        Its origin is in the middle of the door, on the outer face; its z axis leads out.
    low, high : ndarray (3,)
        Corners of the hollow in the frame; `high[2]` is the inner face of the wall with the door.
    half : ndarray (2,)
        Half of the sides of the door.
    wall : float
        Thickness.
    """

    frame: Floats
    low: Floats
    high: Floats
    half: Floats
    wall: float

    def boxes(self, name: str) -> list[Box]:
        """Return its walls."""
        return [*self.shell(name), *self.front(name)]

    def shell(self, name: str) -> list[Box]:
        """Return all walls but the one with the door."""
        floor = self.low - np.array([0.0, 0.0, self.wall]), np.append(self.high[:2], self.low[2])
        around = self.low - np.array([0.0, 0.0, self.wall]), self.high
        return [*walls_around(self.frame, *around, self.wall, name), box_between(self.frame, *floor, f"{name} back")]

    def front(self, name: str) -> list[Box]:
        """Return the wall with the door."""
        low, high = self.low - self.wall, self.high + self.wall
        low[2] = self.high[2]
        return wall_with_door(self.frame, low, high, np.array([-self.half, self.half]), f"{name} front")

    def keeps_out(self, points: Floats, by: float) -> bool:
        """Whether points (m, 3) are beyond the door, or outside of all walls."""
        local = in_frame(self.frame, points)
        low, high = self.low - self.wall - by, self.high + self.wall + by
        ahead = local[:, 2] >= -1e-9 * self.wall
        return bool((ahead | (local < low).any(axis=1) | (local[:, :2] > high[:2]).any(axis=1)).all())


def line_of(robot: Robot, q: Floats) -> Line:
    """Return the hidden shape as a line."""
    poses = curve_of(robot, q, SAMPLES).poses
    return Line(poses, (poses[-1] @ robot.tool)[:3, 3], max(robot.radii))


def in_frame(frame: Floats, points: Floats) -> Floats:
    """Return points (m, 3) of the world in a frame (4, 4)."""
    local: Floats = (points - frame[:3, 3]) @ frame[:3, :3]
    return local


def doorway(at: Floats, rng: Generator, inwards: bool = False) -> Floats:
    """Return the frame (4, 4) of a door that a shape goes through at the frame `at`; z leads out of the cell."""
    lean, roll = rng.uniform(0.0, TILT), rng.uniform(0.0, 2.0 * math.pi)
    normal = np.array([math.sin(lean) * math.cos(roll), math.sin(lean) * math.sin(roll), math.cos(lean)])
    turn = pose(direction=-normal if inwards else normal)
    spin = rng.uniform(0.0, 2.0 * math.pi)
    spun = np.eye(4)
    spun[:2, :2] = [[math.cos(spin), -math.sin(spin)], [math.sin(spin), math.cos(spin)]]
    frame: Floats = at @ turn @ spun
    return frame


def draw_half(radius: float, rng: Generator) -> Floats:
    """Draw half of the sides of a door; either may be the narrow one."""
    half = radius * np.array([rng.uniform(*NARROW), rng.uniform(*WIDE)])
    return half[::-1].copy() if rng.random() < 0.5 else half


def cell_around(points: Floats, frame: Floats, half: Floats, radius: float, rng: Generator) -> Cell | None:
    """Return the cell that points (m, 3) lie in, all of them behind the door; `None` where they do not."""
    local = in_frame(frame, points)
    wall = radius * rng.uniform(*WALL)
    if local[:, 2].max() > 1e-9 * radius:
        return None
    beside = half + 0.2 * radius
    low = local.min(axis=0) - radius * rng.uniform(*MARGIN, 3)
    high = local.max(axis=0) + radius * rng.uniform(*MARGIN, 3)
    low[:2], high[:2] = np.minimum(low[:2], -beside), np.maximum(high[:2], beside)
    high[2] = -wall
    low[2] = min(low[2], -2.0 * radius)
    return Cell(frame, low, high, half, wall)
