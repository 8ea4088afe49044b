"""Targets that are near each other: sorted along a Z-order curve (Morton 1966), and solved in two halves."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.problem.target import Goals

Whole = NDArray[np.int64]

BITS = 6
"""Of each coordinate: a Z-order curve over up to nine of them in one whole number."""

RUN = 8
"""Targets in a row of which the first is solved by itself, and the others from its solution."""


def halves(goals: Goals) -> tuple[Whole, Whole, Whole]:
    """Divide targets into those that are solved first and those that begin from one of these.

    Returns
    -------
    early, late : ndarray of int
        Numbers of targets; together all of them.
    near : ndarray of int
        For each of `late`, the place in `early` of the one that it begins from.
    """
    order = np.argsort(_codes(_features(goals)), kind="stable")
    places = np.arange(len(order))
    first = places % RUN == 0
    return order[first], order[~first], places[~first] // RUN


def _features(goals: Goals) -> Floats:
    """What makes targets near each other (m, k): place, and columns of the rotation."""
    parts = [
        None if goals.positions is None else goals.positions,
        goals.directions,
        None if goals.rotations is None else goals.rotations[:, :, ::2].reshape(len(goals), -1),
    ]
    return np.concatenate([part for part in parts if part is not None], axis=1)


def _codes(features: Floats) -> NDArray[np.uint64]:
    """Numbers (m,) along the curve: the bits of all coordinates in turn."""
    low, extent = features.min(axis=0), np.ptp(features, axis=0)
    cells = ((features - low) / np.where(extent > 0.0, extent, 1.0) * (2**BITS - 1)).astype(np.uint64)
    count = cells.shape[1]
    codes = np.zeros(len(cells), np.uint64)
    for bit in range(BITS):
        for k in range(count):
            codes |= ((cells[:, k] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(bit * count + k)
    return codes
