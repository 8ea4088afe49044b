"""Voxels about a robot, and directions of the tangent on a sphere."""

import math
from itertools import product
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.robot.robot import Robot

ACROSS = 35
"""Voxels from the base to the farthest place, where no spacing is given."""

MOST_VOXELS, MOST_DIRECTIONS = 20_000_000, 1000

NEIGHBOURS = 26
"""Directions to the neighbours of a cube: faces, edges, corners."""


class Voxels(Frozen):
    """A grid of cubes, one of them about the base.

    Attributes
    ----------
    first : ndarray (3,)
        Middle of the voxel `[0, 0, 0]`.
    spacing : float
        Edge of a voxel.
    shape : (int, int, int)
    """

    first: Floats
    spacing: float
    shape: tuple[int, int, int]

    def __init__(self, first: Any, spacing: float, shape: tuple[int, int, int]) -> None:
        self._set(first=checks.vector("first", first), spacing=spacing, shape=shape)

    @classmethod
    def about(cls, robot: Robot, spacing: Any, low: Any, high: Any) -> "Voxels":
        """Make those that hold whatever a robot may reach, or what of it is between two corners.

        Raises
        ------
        InputError
            When there would be none, or too many.
        """
        base, reach = robot.base[:3, 3], reach_of(robot)
        step = reach / ACROSS if spacing is None else checks.number("spacing", spacing, above=0.0)
        corners = base - reach if low is None else checks.vector("low", low)
        others = base + reach if high is None else checks.vector("high", high)
        if (others < corners).any():
            raise InputError("high", "is below low", others.tolist(), f"at least {corners.tolist()} in every entry")
        slack = 1e-9
        begin, end = np.ceil((corners - base) / step - slack), np.floor((others - base) / step + slack)
        counts = np.maximum(0.0, end - begin + 1.0)
        if not 0.0 < float(np.prod(counts)) <= MOST_VOXELS:
            wanted = f"one that makes 1 to {MOST_VOXELS:,} voxels"
            raise InputError("spacing", f"makes {float(np.prod(counts)):.3g}", step, wanted)
        x, y, z = counts.astype(int).tolist()
        return cls(base + step * begin, step, (x, y, z))

    @property
    def middles(self) -> Floats:
        """Middles (x, y, z, 3) of all voxels."""
        return self.first + self.spacing * np.moveaxis(np.indices(self.shape), 0, -1)

    @property
    def volume(self) -> float:
        """Volume of one voxel."""
        return self.spacing**3


def reach_of(robot: Robot) -> float:
    """Largest distance of the tip, with the tool, from the base."""
    length = sum(float(segment.length[1]) for segment in robot.segments)
    return length + float(np.linalg.norm(robot.tool[:3, 3]))


def directions_of(value: Any) -> Floats:
    """Directions (k, 3) on a sphere: those to the neighbours of a cube for 26, so many along a spiral, or those given.

    The spiral has points of equal area (Fibonacci lattice: Swinbank & Purser 2006).
    """
    if not isinstance(value, int | np.integer):
        given = checks.directions("directions", value)
        if not 0 < len(given) <= MOST_DIRECTIONS:
            raise InputError("directions", "", len(given), f"1 to {MOST_DIRECTIONS} directions")
        return given
    count = checks.integer("directions", value, 1, MOST_DIRECTIONS)
    if count == NEIGHBOURS:
        steps = np.array([step for step in product((-1.0, 0.0, 1.0), repeat=3) if any(step)])
        return np.asarray(steps / np.linalg.norm(steps, axis=1, keepdims=True))
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, k * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=-1)
