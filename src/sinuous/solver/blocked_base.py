"""What can be proved of the base before anything is tried."""

import math
from collections.abc import Sequence
from itertools import pairwise

from sinuous.kernels.tables import ROUNDOFF
from sinuous.model.robot import Robot
from sinuous.scene.snapshot import Snapshot

ROUNDING = 1e-9
"""Overlap that a proof needs beyond the bound, in mean lengths of the robot."""

Ramp = tuple[float, float, float]
"""How the angle of the tangent may grow: the arc length where it begins, rad per length unit, and the largest, rad."""


def base_blocked(robot: Robot, scene: Snapshot) -> bool:
    """Prove that the body is too near to an obstacle where it leaves its mount, whatever the configuration.

    Where the whole robot may be shorter than its mount, nothing is proved. The backbone at arc length `mount` is
    within `bound_sway` of the straight line.
    """
    if len(scene) == 0:
        return False
    reached, radius = 0.0, robot.needed_radii[0]
    ramps: list[Ramp] = []
    if robot.mount > 0.0:
        of_each = robot.segments, robot.needed_radii, robot.curvatures, robot.largest_bends
        for segment, own, curvature, bend in zip(*of_each, strict=True):
            # Lengths vary: this may be the segment that leaves the mount, and so may any before it.
            radius = min(radius, own)
            low, high = segment.length
            tightest = min(curvature, bend / low if low > 0.0 else math.inf)
            ramps.append((reached, tightest, min(bend, curvature * high, math.pi)))
            reached += low
            if reached > robot.mount:
                break
        else:
            return False
    leaves = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    rounding = ROUNDING * robot.mean_length + float(scene.table[:, ROUNDOFF].max())
    return bool(scene.at_most(leaves) + bound_sway(robot.mount, ramps) < radius - rounding)


def bound_sway(mount: float, ramps: Sequence[Ramp]) -> float:
    """Bound how far the backbone at arc length `mount` can be from where it would be without any bend.

    A tangent that has turned by the angle a differs from the straight one by at most 2 sin(a / 2). The bound is the
    integral of that up to `mount`, where every segment begins as early, and bends as tightly, as its limits allow.
    """
    ramps = [ramp for ramp in ramps if ramp[1] > 0.0 and ramp[2] > 0.0]
    ends = {begin + most / rate for begin, rate, most in ramps} | {begin for begin, _, _ in ramps}
    places = [0.0, *sorted(place for place in ends if 0.0 < place < mount), mount]
    total = 0.0
    for before, after in pairwise(places):
        middle = 0.5 * (before + after)
        rate = sum(rate for begin, rate, most in ramps if begin <= middle <= begin + most / rate)
        angle = sum(
            most if begin + most / rate <= before else rate * (before - begin)
            for begin, rate, most in ramps
            if begin <= before
        )
        total += _chord_area(angle, rate, after - before)
    return total


def _chord_area(angle: float, rate: float, length: float) -> float:
    """Integral of 2 sin(min(a, pi) / 2) over `length`, for an angle a that begins at `angle` and grows by `rate`."""
    rising = length if rate == 0.0 else min(length, max(0.0, math.pi - angle) / rate)
    begin, end = 0.5 * min(angle, math.pi), 0.5 * min(angle + rate * rising, math.pi)
    # 2 sin of the mean, times sin(x) / x of half the difference: exact, also where the angle hardly grows
    half = 0.5 * (end - begin)
    mean = 2.0 * math.sin(0.5 * (begin + end)) * (math.sin(half) / half if half > 0.0 else 1.0)
    return mean * rising + 2.0 * (length - rising)
