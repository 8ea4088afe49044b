"""What is asked of the workspace of a robot: where, how finely, and in which directions."""

import math
from itertools import product
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Rows, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen

MOST_DIRECTIONS = 1000

CUBE_DIRECTIONS = 26
"""Directions to the neighbours of a cube: faces, edges, corners."""


class Workspace(Frozen):
    """What a map of a workspace asks; see `reach`.

    Parameters
    ----------
    spacing : float, optional
        Edge of a voxel; by default a 35th of the robot's reach.
    directions : int or array_like (3,) or (d, 3)
        Of the tangent at the tip. 0: none, positions alone; 26: those to the neighbours of a cube; another number:
        along a spiral on a sphere; or these.
    within : float, optional
        How far the tangent may be off each direction, rad, at most pi; by default the angle of the tolerance.
    low, high : array_like (3,), optional
        Corners of what is looked at; by default all that the robot may reach. Equal entries make a slice.

    Attributes
    ----------
    axes : ndarray (d, 3)
        The directions.
    """

    spacing: float | None
    directions: int | Floats
    within: float | None
    low: Floats | None
    high: Floats | None
    axes: Floats

    def __init__(
        self,
        spacing: Number | None = None,
        directions: Whole | Vector | Rows = 0,
        within: Number | None = None,
        low: Vector | None = None,
        high: Vector | None = None,
    ) -> None:
        axes = directions_of(directions)
        if within is not None:
            if not len(axes):
                raise InputError("within", "no direction is asked for", within, "directions, too")
            if checks.number("within", within, above=0.0) > math.pi:
                raise InputError("within", "", within, "an angle up to pi, rad (20 degrees are 0.349)")
        self._set(
            spacing=None if spacing is None else checks.number("spacing", spacing, above=0.0),
            directions=int(directions) if isinstance(directions, int | np.integer) else axes,
            within=None if within is None else float(within),
            low=None if low is None else checks.vector("low", low),
            high=None if high is None else checks.vector("high", high),
            axes=axes,
        )

    @property
    def sampled(self) -> bool:
        """Whether its directions stand for all that there are."""
        return isinstance(self.directions, int) and self.directions > 1


def directions_of(value: Whole | Vector | Rows) -> Floats:
    """Directions (d, 3) on a sphere: those to the neighbours of a cube for 26, so many along a spiral, or those given.

    The spiral has points of equal area (Fibonacci lattice: Swinbank & Purser 2006).
    """
    if not isinstance(value, int | np.integer):
        listed: Any = value
        given = checks.directions("directions", [listed] if np.ndim(listed) == 1 else listed)
        if not 0 < len(given) <= MOST_DIRECTIONS:
            raise InputError("directions", "", len(given), f"1 to {MOST_DIRECTIONS} directions")
        return given
    count = checks.integer("directions", value, 0, MOST_DIRECTIONS)
    if count == CUBE_DIRECTIONS:
        steps = np.array([step for step in product((-1.0, 0.0, 1.0), repeat=3) if any(step)])
        return checks.closed(steps / np.linalg.norm(steps, axis=1, keepdims=True))
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / max(1, count), k * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return checks.closed(np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=-1))
