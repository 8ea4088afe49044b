"""Colours and sizes of everything that is drawn; the colour-blind can tell the colours apart (Okabe & Ito 2008)."""

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from sinuous.base.arguments import Number
from sinuous.base.checks import Floats
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.target import Target

INK, PALE, LINE, GRID = "#2f343a", "#6b7178", "#b4bac1", "#e7eaed"
OBSTACLE, DOTS, METAL = "#b9c1cb", "#98a1ac", "#4a5058"
LINK = "#8a93a0"
TARGET, PATH, ROUTE, TIP_PATH = "#d55e00", "#f0b48c", "#009e73", "#d55e00"
FORCE = INK
X, Y, Z = "#d55e00", "#009e73", "#0072b2"

UNSOLVED = ("#e69f00", "#f3cf80")
"""Two tones of a robot that did not get where it should."""

ARMS = (
    ("#0072b2", "#56b4e9"),
    ("#b0568c", "#dca6c6"),
    ("#00805d", "#67c7a8"),
    ("#5c5c5c", "#a6a6a6"),
    ("#a08600", "#e3d045"),
)
"""Two tones of each robot, for its segments in turn; the first is the only one of most pictures."""

CURVES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#7a7a7a", "#b3a300")
"""Colours of curves, in turn."""

COLOUR_SCALE = ("#00204d", "#31446b", "#666970", "#958f78", "#cbba69", "#ffea46")
"""Colours of a value from little to much: cividis (Nunez et al. 2018), which the colour-blind read as all others do."""

MOST_IN_LEGEND = 12
"""Curves that a legend has a name for."""

AXIS_NUMBERS = 4
"""Numbers along the longest axis in space, about."""

CONTACT = "#d55e00"
"""Colour of a place of the body that touches an obstacle."""

SMALL_PT, TEXT_PT, TITLE_PT = 8.0, 9.5, 11.0
"""Sizes of letters, in points."""

THINNEST_SHARE = 0.006
"""Least radius with which a body is drawn, as a share of what is shown."""

ARROW_SHARE = 0.13
"""Length of the arrows of targets, as a share of what is shown."""

Rgb = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""

Colouring = Literal["segment", "clearance", "bending"]
"""What the colour of a body on a page says."""


class Viewpoint(NamedTuple):
    """Where a picture is looked at from, in degrees.

    Attributes
    ----------
    elevation : float
        Above the xy plane.
    azimuth : float
        About z, from x.
    """

    elevation: Number = 30.0
    azimuth: Number = -60.0


def rgb(colour: str) -> Rgb:
    """Numbers of `#rrggbb`."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def arm_tones(solved: bool = True, number: int = 0) -> tuple[str, str]:
    """Two tones for the segments of a robot in turn; `number` counts the robots of a picture."""
    return ARMS[number % len(ARMS)] if solved else UNSOLVED


def rigid_tone(row: Segment) -> str:
    """Colour of a joint, or of a capsule of a link."""
    return LINK if isinstance(row, RigidRow) and row.has_body else METAL


def map_colour(share: float) -> Rgb:
    """Colour of a value, 0 (little) to 1 (much)."""
    stops = np.array([rgb(colour) for colour in COLOUR_SCALE], np.float64)
    places = np.linspace(0.0, 1.0, len(stops))
    red, green, blue = (round(float(np.interp(share, places, stops[:, i]))) for i in range(3))
    return red, green, blue


def colour_by_bending(robot: Robot, q: Floats) -> list[Rgb]:
    """Colours of the segments in a configuration (n, 3): how much of its largest bend each one has."""
    bends = np.hypot(q[:, 0], q[:, 1])
    return [map_colour(float(share)) for share in np.minimum(1.0, bends / np.maximum(largest_bends(robot), 1e-300))]


def largest_bends(robot: Robot) -> Floats:
    """The largest bend (n,) of each segment, rad, at its greatest length."""
    return np.array(
        [min(b, c * s.length[1]) for s, c, b in zip(robot.rows, robot.curvatures, robot.largest_bends, strict=True)]
    )


def colour_by_clearance(clearances: Sequence[float], far: float) -> list[Rgb]:
    """Colours of places with these clearances; `far` and beyond is the end of the scale."""
    return [rgb(CONTACT) if value <= 0.0 else map_colour(min(1.0, value / far)) for value in clearances]


def arrows_of(target: Target) -> Iterator[tuple[Floats, str]]:
    """Yield unit vectors (3,) with their colours: one where a direction is asked, three where a whole rotation is."""
    if target.direction is not None:
        yield target.direction, TARGET
    if target.rotation is not None:
        yield from zip(target.rotation.T, (X, Y, Z), strict=True)
