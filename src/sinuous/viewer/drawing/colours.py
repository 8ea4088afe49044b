"""Colours of a page: two tones of a segment, and a scale for clearance and bending."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from sinuous.checks import Floats
from sinuous.pictures.style import ARMS, UNSOLVED
from sinuous.robot.robot import Robot

Rgb = tuple[int, int, int]

Colouring = Literal["segment", "clearance", "bending"]
"""What the colour of the body says."""

SCALE = ("#00204d", "#31446b", "#666970", "#958f78", "#cbba69", "#ffea46")
"""From little to much: cividis (Nunez et al. 2018), which the colour-blind read as all others do."""

CLOSE = "#d55e00"
"""Of what touches an obstacle."""


def rgb(colour: str) -> Rgb:
    """Numbers of `#rrggbb`."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def scaled(share: float) -> Rgb:
    """Colour of a value, 0 (little) to 1 (much)."""
    stops = np.array([rgb(colour) for colour in SCALE], np.float64)
    places = np.linspace(0.0, 1.0, len(stops))
    red, green, blue = (round(float(np.interp(share, places, stops[:, i]))) for i in range(3))
    return red, green, blue


def tones(count: int, solved: bool = True, number: int = 0) -> list[Rgb]:
    """Two tones in turn for so many segments; `number`: of which robot on the page."""
    pair = ARMS[number % len(ARMS)] if solved else UNSOLVED
    return [rgb(pair[k % 2]) for k in range(count)]


def by_bending(robot: Robot, q: Floats) -> list[Rgb]:
    """Colours of the segments: how much of its largest bend each one has."""
    bends = np.hypot(q[:, 0], q[:, 1])
    most = np.array([_most(segment.max_bend, k, robot) for k, segment in enumerate(robot.segments)])
    return [scaled(float(share)) for share in np.minimum(1.0, bends / np.maximum(most, 1e-300))]


def _most(max_bend: float, k: int, robot: Robot) -> float:
    return min(max_bend, robot.curvatures[k] * robot.segments[k].length[1])


def by_clearance(clearances: Sequence[float], far: float) -> list[Rgb]:
    """Colours of places with these clearances; `far` and beyond is the end of the scale."""
    return [rgb(CLOSE) if value <= 0.0 else scaled(min(1.0, value / far)) for value in clearances]
