"""Robots for intricate places: every twenty seeds in a row have all kinds, from 3 segments to 20."""

import math

import numpy as np
from numpy.random import Generator

import sinuous as sn
from sinuous.base.checks import Floats

BENDS = {3: 2.4, 5: 2.4, 8: 2.0, 12: 1.6, 20: 1.2}
"""Number of bending segments, and the largest bend of each, rad."""

UNITS = (1.0, 60.0, 0.05)
"""Lengths of a segment: no result may hang on the unit of length."""

STRETCH = 0.2
SLENDERNESS = 0.1
"""Radius of the body, of a segment's length."""

STROKE, HOLDER = 1.5, 0.25
"""Longest insertion, and how far the holder of an insertion stage encloses the body, in lengths of a segment."""


def robot_of(seed: int, rng: Generator) -> sn.Robot:
    """Return the robot of a seed: number of segments in turn, half extensible, half with an insertion stage.

    The stage is one more segment before the others, straight, with a length from 0 to `STROKE`; half of the stages
    have a holder that obstacles do not concern (`mount`). The base is anywhere.
    """
    kinds = tuple(BENDS.items())
    count, max_bend = kinds[seed % 5]
    unit = UNITS[seed // 20 % 3]
    radius = SLENDERNESS * unit
    length = (1.0 - STRETCH) * unit, (1.0 + STRETCH) * unit
    segments = [sn.Segment(length if seed // 5 % 2 else unit, max_bend, radius=radius)] * count
    mount = 0.0
    if seed // 10 % 2:
        segments = [sn.Segment((0.0, STROKE * unit), 0.0, radius=radius), *segments]
        mount = float(rng.choice([0.0, HOLDER])) * unit
    return sn.Robot(segments, mount=mount, base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)))


def longest(seed: int, rng: Generator) -> sn.Robot:
    """Return the robot of 20 segments of a seed."""
    return robot_of(5 * seed + 4, rng)


SLENDER, STOUT = (0.05, 0.12), (0.15, 0.22)
"""Of the body of various robots: range of its radius at the base, of a segment's length."""

THIN = 0.018
"""Radius of thin robots, of a segment's length."""

TAPER = 0.7
"""Radius at the tip of those that taper, of that at the base."""

TOOL, SLANT = (0.05, 0.4), 0.5
"""Range of the length of a tool, in lengths of a segment; its largest angle with the tangent, rad."""


def various_robot(seed: int, rng: Generator, stout: bool = False) -> sn.Robot:
    """Return the robot of a seed with another body; a third of them have a tool.

    Half of the slender ones taper. Stout ones are for scans, which around others would have hundreds of thousands of
    points.
    """
    plain = robot_of(seed, rng)
    unit = UNITS[seed // 20 % 3]
    thickness, taper = (STOUT, 1.0) if stout else (SLENDER, rng.choice([1.0, TAPER]))
    radii = unit * rng.uniform(*thickness) * np.linspace(1.0, taper, len(plain))
    segments = [
        sn.Segment(one.length, one.max_bend, radius=radius) for one, radius in zip(plain.segments, radii, strict=True)
    ]
    return sn.Robot(
        segments, mount=plain.mount, base=plain.base, tool=_tool(unit, rng) if rng.random() < 1 / 3 else None
    )


def stout_robot(seed: int, rng: Generator) -> sn.Robot:
    """Return a stout robot of 3, 5 or 8 segments."""
    return various_robot(seed - seed % 5 + (0, 1, 2, 0, 1)[seed % 5], rng, stout=True)


def long_robot(seed: int, rng: Generator, stout: bool = False) -> sn.Robot:
    """Return a robot of 20 segments."""
    return various_robot(5 * seed + 4, rng, stout)


def thin_robot(seed: int, rng: Generator) -> sn.Robot:
    """Return a robot of 20 segments that is a thousand radii long."""
    plain = long_robot(seed, rng)
    return sn.Robot(plain.segments, radius=THIN * max(s.length[1] for s in plain.segments), base=plain.base)


def _tool(unit: float, rng: Generator) -> Floats:
    """A point ahead of the tip, to which the tool leads straight."""
    direction = np.array([0.0, 0.0, 1.0]) + np.append(rng.uniform(-1.0, 1.0, 2) * SLANT / math.sqrt(2.0), 0.0)
    return sn.pose(unit * rng.uniform(*TOOL) * direction / np.linalg.norm(direction), direction=direction)
