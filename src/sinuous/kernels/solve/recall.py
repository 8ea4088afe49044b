"""Which of many known shapes nearly meet targets, and how far configurations are apart.

`pose` (n, 12) are frames of ends of segments; `found` (count,) int64 and `misses` (count,) the nearest shapes so far.
"""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.step.targets import end_segment

ANGLE_WEIGHT = 0.5
"""Share of the robot's mean length that counts as far as 1 rad."""


def _misses(pose: Array, targets: Array, length: float) -> float:
    """Square of how far the ends (n, 12) of the segments of a shape are from all targets (t, 15), in mean lengths."""
    total = 0.0
    for i in range(targets.shape[0]):
        k = end_segment(targets, i, pose.shape[0])
        if targets[i, t.HAS_POSITION] > 0.0:
            for j in range(3):
                off = (pose[k, t.POSE_POSITION + j] - targets[i, t.TARGET_POSITION + j]) / length
                total += off * off
        turned = 0.0
        if targets[i, t.ORIENTATION] == t.DIRECTION:
            for j in range(3):
                off = pose[k, t.POSE_ROTATION + 3 * j + 2] - targets[i, t.GOAL + j]
                turned += off * off
        elif targets[i, t.ORIENTATION] == t.ROTATION:
            for j in range(9):
                off = pose[k, t.POSE_ROTATION + j] - targets[i, t.GOAL + j]
                turned += 0.5 * off * off
        total += ANGLE_WEIGHT * ANGLE_WEIGHT * turned
    return total


def _keep_nearest(found: Array, misses: Array, size: int, number: int, miss: float) -> int:
    """Keep a number among the nearest so far (count,), in their order; returns how many there are."""
    count = found.shape[0]
    if size == count and not miss < misses[count - 1]:
        return size
    at = min(size, count - 1)
    while at > 0 and miss < misses[at - 1]:
        misses[at], found[at] = misses[at - 1], found[at - 1]
        at -= 1
    misses[at], found[at] = miss, number
    return min(size + 1, count)


@entry
def recall(poses: Array, targets: Array, length: float, likely: Array, first: int, found: Array, misses: Array) -> None:
    """Fill `found` (m, count) with the numbers of the shapes that are nearest to target sets (m, t, 15), in order.

    For each set the candidates are those of `likely` (m, c), and all shapes from number `first` on; there are at least
    `count`. `poses` (s, n, 12) are those of the ends of their segments, `length` is the mean length of the robot;
    `misses` (count,) is scratch.
    """
    for i in range(targets.shape[0]):
        size = 0
        for j in range(likely.shape[1] + poses.shape[0] - first):
            number = likely[i, j] if j < likely.shape[1] else first + j - likely.shape[1]
            size = _keep_nearest(found[i], misses, size, number, _misses(poses[number], targets[i], length))


@entry
def compare(one: Array, others: Array, scales: Array, apart: Array) -> None:
    """Fill `apart` (m, k) with how far configurations `one` (m, n, 3) are from `others` (m, k, n, 3).

    It is the largest difference of all numbers, in units of `scales` (3,).
    """
    for i in range(others.shape[0]):
        for j in range(others.shape[1]):
            most = 0.0
            for k in range(one.shape[1]):
                for axis in range(3):
                    most = max(most, math.fabs(one[i, k, axis] - others[i, j, k, axis]) / scales[axis])
            apart[i, j] = most
