"""Robots for intricate places: every twenty seeds in a row have all kinds, from 3 segments to 20."""

from numpy.random import Generator

from sinuous.poses import pose
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment

BENDS = {3: 2.4, 5: 2.4, 8: 2.0, 12: 1.6, 20: 1.2}
"""Number of bending segments, and the largest bend of each, rad."""

UNITS = (1.0, 60.0, 0.05)
"""Lengths of a segment: no result may hang on the unit of length."""

STRETCH = 0.2
SLENDERNESS = 0.1
"""Radius of the body, of a segment's length."""

STROKE, HOLDER = 1.5, 0.25
"""Longest insertion, and how far the holder of an insertion stage encloses the body, in lengths of a segment."""


def robot_of(seed: int, rng: Generator) -> Robot:
    """Return the robot of a seed: number of segments in turn, half extensible, half with an insertion stage.

    The stage is one more segment before the others, straight, with a length from 0 to `STROKE`; half of the stages
    have a holder that obstacles do not concern (`mount`). The base is anywhere.
    """
    kinds = tuple(BENDS.items())
    count, max_bend = kinds[seed % 5]
    unit = UNITS[seed // 20 % 3]
    radius = SLENDERNESS * unit
    length = (1.0 - STRETCH) * unit, (1.0 + STRETCH) * unit
    segments = [Segment(length if seed // 5 % 2 else unit, max_bend, radius=radius)] * count
    mount = 0.0
    if seed // 10 % 2:
        segments = [Segment((0.0, STROKE * unit), 0.0, radius=radius), *segments]
        mount = float(rng.choice([0.0, HOLDER])) * unit
    return Robot(segments, mount=mount, base=pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)))
