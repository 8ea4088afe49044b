"""Shapes scattered over all that a robot can do, by number: the same numbers are the same shapes."""

import math

import numpy as np

from sinuous.kernels.maths.vectors import Array, put_vec
from sinuous.kernels.step.limits import bends_in_plane, plane_bend, project_segment
from sinuous.kernels.tables import HIGH_BEND, LOW_BEND, MAX_BEND, MAX_LENGTH, MIN_LENGTH


def uniform(key: np.uint64) -> float:
    """A number in [0, 1) for every key (Steele et al. 2014, splitmix64)."""
    z = key * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return float((z ^ (z >> np.uint64(31))) >> np.uint64(11)) * 2.0**-53


def scattered(limits: Array, index: int, seed: int, most: float, q: Array) -> None:
    """Shape number `index` of the sequence `seed`: bends up to `most` even over their discs, lengths over their ranges.

    Hashed, not low-discrepancy: in the 3 n dimensions of a robot an additive recurrence puts long runs of shapes into
    the same few directions, and hard poses waited for their turn.
    """
    key = np.uint64(seed) * np.uint64(0x100000000) + np.uint64(index) * np.uint64(3 * q.shape[0])
    for k in range(q.shape[0]):
        length = limits[k, MIN_LENGTH] + uniform(key) * (limits[k, MAX_LENGTH] - limits[k, MIN_LENGTH])
        if bends_in_plane(limits, k):
            low = max(limits[k, LOW_BEND], -most)
            z = low + uniform(key + np.uint64(1)) * max(0.0, min(limits[k, HIGH_BEND], most) - low)
            ux, uy = plane_bend(limits, k, z)
            put_vec(q, k, 0, project_segment(limits, k, ux, uy, length))
            key += np.uint64(3)
            continue
        bend = math.sqrt(uniform(key + np.uint64(1))) * min(limits[k, MAX_BEND], most)
        angle = 2.0 * math.pi * uniform(key + np.uint64(2))
        key += np.uint64(3)
        put_vec(q, k, 0, project_segment(limits, k, bend * math.cos(angle), bend * math.sin(angle), length))
