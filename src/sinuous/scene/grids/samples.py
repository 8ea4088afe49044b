"""Values on a regular grid of points, as they stand for a distance."""

import math
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Number, Truth
from sinuous.checks import Floats
from sinuous.errors import InputError

STEPS = tuple(step for step in product((-1, 0, 1), repeat=3) if step > (0, 0, 0))
"""From a point of a grid to half of its 26 neighbours; the other half is the same, backwards."""

SLACK = 1e-6
"""What rounding may add to a difference between neighbours, relative to their distance."""


SLAB = 2**15
"""Values that are looked at together, so that they stay in the processor's cache."""


def check_lipschitz(key: str, values: Floats, spacing: float, rounding: float) -> None:
    """Refuse values (nx, ny, nz) that differ by more than the distance of two neighbours: no distance does.

    Parameters
    ----------
    key : str
    values : ndarray (nx, ny, nz)
    spacing : float
        Between neighbours along an axis.
    rounding : float
        Relative precision in which the values were stored.

    Raises
    ------
    InputError
        That names the pair with the steepest rise, and how steep it is.
    """
    allowed = rounding * float(max(values.max(), -values.min()))
    worst, step, at = 0.0, STEPS[0], (0, 0, 0)
    planes = max(1, SLAB // values[0].size)
    for first in range(0, len(values), planes):
        slab = values[first : first + planes + 1]
        for candidate in STEPS:
            rise = _rise(slab, candidate)
            steepest = (float(rise.max(initial=0.0)) - allowed) / (spacing * float(np.linalg.norm(candidate)))
            if steepest > worst:
                i, j, k = (int(x) for x in np.unravel_index(rise.argmax(), rise.shape))
                worst, step, at = steepest, candidate, (first + i, j, k)
    if worst > 1.0 + SLACK:
        here = np.array(at) - np.minimum(step, 0)
        pair = [here.tolist(), (here + step).tolist()]
        problem = f"changes {worst:.4g} times as fast as a distance can, from {pair[0]} to {pair[1]}"
        got = [float(values[tuple(place)]) for place in pair]
        raise InputError(key, problem, got, "values that differ by at most the distance of their points")


def _rise(values: Floats, step: tuple[int, ...]) -> Floats:
    """Differences between all pairs of values that are one `step` apart, as an array of their first places."""
    first, second = (
        tuple(slice(max(0, -s), None if s <= 0 else -s) for s in shift) for shift in (step, tuple(-s for s in step))
    )
    result: Floats = values[second] - values[first]
    return np.abs(result, out=result)


def sample_points(origin: Floats, spacing: float, shape: tuple[int, ...], first: int, last: int) -> Floats:
    """Points (last - first, 3) of a grid of this shape, numbered in C order."""
    index: NDArray[np.int64] = np.stack(np.unravel_index(np.arange(first, last), shape), axis=-1)
    result: Floats = origin + spacing * index
    return result


def along_axes(origin: Floats, axes: Floats, offsets: Floats) -> Floats:
    """Points (m, 3) that are so far (m, 3) from an origin along axes, the columns of (3, 3)."""
    return origin + (offsets if np.array_equal(axes, np.eye(3)) else offsets @ axes.T)


def checked_exactness(exact: Truth | None, truncated: Number | None) -> dict[str, Any]:
    """Check what is said of values: whether they are distances, and the value at which they are cut off."""
    return {
        "exact": None if exact is None else checks.truth("exact", exact),
        "truncated": None if truncated is None else checks.number("truncated", truncated, above=0.0),
    }


def exact_below(exact: bool | None, truncated: float | None, unsaid: float) -> float:
    """Return the value from which on values are lower bounds of a distance alone; `unsaid` where nothing is said."""
    if exact is False:
        return 0.0
    if truncated is not None:
        return truncated
    return unsaid if exact is None else math.inf
