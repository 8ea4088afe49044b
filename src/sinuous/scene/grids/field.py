"""Obstacles that a function describes."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Number, Truth, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.grids.samples import along_axes, check_lipschitz, checked_exactness, exact_below, sample_points
from sinuous.scene.obstacles import IDENTITY, Obstacle

MOST = 2**26
"""Samples of a field: half a gigabyte."""

CHUNK = 2**16


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Field(Obstacle):
    """Where a function is negative.

    The function is called when the field is made, for all points of a grid over a box; solving uses these samples,
    less what a distance can change between them. Out of the box the samples at its border answer: what they do not
    prove free is not free.

    Parameters
    ----------
    function : callable
        From points (m, 3) in the world to signed distances (m,), positive outside, or to lower bounds of them: it may
        change by no more than the distance between two points.
    low, high : array_like (3,)
        Opposite corners of the box.
    spacing : float
        Of the grid, along every axis. Its last points may lie beyond `high`.
    exact : bool, optional
        Whether the function gives distances, not lower bounds of them. By default that is not known: then only where it
        is not positive does it prove that there is no solution.
    truncated : float, optional
        The value at which distances are cut off: below it they are exact.
    name : str, optional

    Attributes
    ----------
    values : ndarray (nx, ny, nz)
        Samples at the points `low + spacing * (i, j, k)`.
    axes : ndarray (3, 3)
        Along which these lie, as columns: those of the world, unless it was turned by a course.

    Raises
    ------
    InputError
        When the box is empty, the grid has more than `MOST` points, or the function returns something else than one
        finite number for each point, or changes faster than the place.
    """

    is_function: ClassVar[bool] = True

    function: Callable[[Floats], Vector]
    low: Floats
    high: Floats
    spacing: float
    values: Floats
    axes: Floats
    exact: bool | None
    truncated: float | None

    def __init__(
        self,
        function: Callable[[Floats], Vector],
        low: Vector,
        high: Vector,
        spacing: Number,
        *,
        exact: Truth | None = None,
        truncated: Number | None = None,
        name: str | None = None,
    ) -> None:
        if not callable(function):
            raise InputError("function", "", function, "a function from points (m, 3) to distances (m,)")
        start, end = checks.vector("low", low), checks.vector("high", high)
        if not (start < end).all():
            raise InputError("high", "is not beyond low", end.tolist(), f"greater in every entry than {start.tolist()}")
        step = checks.number("spacing", spacing, above=0.0)
        values = _sampled(function, start, step, _shape(end - start, step))
        check_lipschitz("function", values, step, float(np.finfo(np.float64).eps))
        values.flags.writeable = False
        known = checked_exactness(exact, truncated)
        self._keep(name, function=function, low=start, high=end, spacing=step, values=values, axes=IDENTITY, **known)

    @property
    def exact_below(self) -> float:
        """From which value on values are lower bounds of the distance alone, unless they are not positive."""
        return exact_below(self.exact, self.truncated, 0.0)

    def at_most(self, points: Floats) -> Floats:
        """Upper bounds (m,) of the distance of points (m, 3); infinite where the function gives none."""
        own = evaluate(self.function, points)
        return np.where((own < self.exact_below) | (own <= 0.0), own, math.inf)

    @property
    def origin(self) -> Floats:
        """Point (3,) of `values[0, 0, 0]`: `low`."""
        return self.low

    def points(self, steps: NDArray[Any]) -> Floats:
        """Places (m, 3) that are so many steps (m, 3) from the first point along the axes."""
        return along_axes(self.low, self.axes, self.spacing * steps)


def _shape(extent: Floats, spacing: float) -> tuple[int, ...]:
    """Points along every axis that cover `extent`."""
    with np.errstate(over="ignore"):
        steps = extent / spacing
        count = float(np.prod(steps + 1.0))
    if count > MOST:
        raise InputError("spacing", f"makes {count:.3g} samples", spacing, f"a coarser one: at most {MOST} samples")
    return tuple(max(1, math.ceil(s - 1e-9)) + 1 for s in steps.tolist())


def _sampled(function: Callable[[Floats], Vector], low: Floats, spacing: float, shape: tuple[int, ...]) -> Floats:
    values = np.empty(math.prod(shape))
    for first in range(0, len(values), CHUNK):
        last = min(first + CHUNK, len(values))
        values[first:last] = evaluate(function, sample_points(low, spacing, shape, first, last))
    return values.reshape(shape)


def evaluate(function: Callable[[Floats], Vector], points: Floats) -> Floats:
    """Call a signed distance for points (m, 3) and check what it returns.

    Raises
    ------
    InputError
        For `function`, when that is not one finite number for each point.
    """
    expected = f"a function that returns {len(points)} finite numbers for as many points"
    result = np.asarray(function(points))
    if result.dtype.kind not in "iuf" or result.shape != (len(points),):
        raise InputError("function", f"shape {result.shape}", result, expected)
    bad = ~np.isfinite(result)
    if bad.any():
        raise InputError("function", f"at {points[bad][0].tolist()}", float(result[bad][0]), expected)
    return result.astype(np.float64)
