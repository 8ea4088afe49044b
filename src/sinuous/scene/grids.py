"""Distances on a grid of points: sampled by a function, or given; and cells that are occupied."""

import math
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Occupancy, Truth, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.scene.obstacles import IDENTITY, Obstacle, Origin, box_around, check_file

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
    return origin + spacing * index


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Sampled(Obstacle):
    """Values at points of a grid; it may be known whether they are distances, and at which value they are cut off."""

    values: NDArray[Any]
    origin: Floats
    spacing: float
    axes: Floats
    exact: bool | None
    truncated: float | None

    @property
    def exact_below(self) -> float:
        """Values from this one on are only lower bounds of the distance, unless they are not positive."""
        if self.exact is False:
            return 0.0
        unsaid = math.inf if self.exact else 0.0 if self.is_function else float(self.values.max())
        return unsaid if self.truncated is None else self.truncated

    @property
    def _box(self) -> Floats | None:
        """The box that all samples fill."""
        last = np.array(self.values.shape) - 1
        return box_around(self.points(last * np.array(list(np.ndindex(2, 2, 2)))), 0.0)

    def points(self, steps: NDArray[Any]) -> Floats:
        """Places (m, 3) that are so many steps (m, 3) from the first point along the axes."""
        offsets: Floats = self.spacing * steps
        return self.origin + (offsets if np.array_equal(self.axes, IDENTITY) else offsets @ self.axes.T)


def checked_exactness(exact: Truth | None, truncated: Number | None) -> dict[str, Any]:
    """Check what is said of values: whether they are distances, and the value at which they are cut off."""
    return {
        "exact": None if exact is None else checks.truth("exact", exact),
        "truncated": None if truncated is None else checks.number("truncated", truncated, above=0.0),
    }


NAMES = ("values", "origin", "spacing")


def read_arrays(file: Path) -> dict[str, NDArray[Any]]:
    """Return the arrays `values`, `origin` and `spacing` (one number) of an NPZ file.

    Raises
    ------
    InputError
        When it is no such file, one is missing, or one holds Python objects.
    """
    check_file(file, (".npz",))
    if not zipfile.is_zipfile(file):
        raise InputError("file", "cannot be read: no NPZ file", str(file), "an NPZ file")
    try:
        with np.load(file, allow_pickle=False) as arrays:
            found = {name: _array(arrays, name) for name in NAMES}
    except InputError as error:
        raise error.in_file(file) from None
    except (OSError, EOFError, zipfile.BadZipFile, NotImplementedError) as error:
        raise InputError("file", f"cannot be read: {error}", str(file), "an NPZ file") from None
    if found["spacing"].size != 1:
        raise InputError("spacing", "", found["spacing"], "the same spacing along all axes", str(file))
    return found


def _array(arrays: Any, name: str) -> NDArray[Any]:
    if name not in arrays:
        raise InputError(name, "missing", list(arrays), "an array called " + ", ".join(NAMES))
    try:
        return np.asarray(arrays[name])
    except ValueError as error:  # an array of Python objects, or one whose header is no header
        raise InputError(name, "cannot be read", " ".join(str(error).split()), "an array of numbers") from None


MOST = 2**26
"""Samples of a field: half a gigabyte."""

CHUNK = 2**16


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Field(Sampled):
    """Where a function is negative.

    The function is called when the field is made, for all points of a grid over a box; solving uses these samples,
    less what a distance can change between them. Outside of the box only that counts as free which the samples at its
    border prove free.

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
        known = checked_exactness(exact, truncated) | {"values": checks.closed(values)}
        self._keep(name, function=function, low=start, high=end, origin=start, spacing=step, axes=IDENTITY, **known)

    def at_most(self, points: Floats) -> Floats:
        """Upper bounds (m,) of the distance of points (m, 3); infinite where the function gives none."""
        own = evaluate(self.function, points)
        return np.where((own < self.exact_below) | (own <= 0.0), own, math.inf)


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


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Grid(Sampled):
    """Values at the points `origin + spacing * (i, j, k)`.

    Numbers are signed distances, positive outside. A value proves that everything nearer to its point is free, also
    outside of the grid, as far from its border as the values there say.

    True and false (or whole numbers 1 and 0) say what is occupied: every true point is the middle of a solid cube with
    edges of `spacing` along the axes. Everything else is free, out of the grid too.

    Parameters
    ----------
    values : array_like (nx, ny, nz)
        Distances, at least two along every axis; or occupancy.
    origin : array_like (3,)
        Point of `values[0, 0, 0]`, in the world.
    spacing : float
        Between neighbours along every axis.
    exact : bool, optional
        Whether distances are exact, not lower bounds of them. By default they are, below the largest of them: that may
        have been cut off.
    truncated : float, optional
        The value at which distances were cut off: below it they are exact.
    name : str, optional

    Attributes
    ----------
    values : ndarray (nx, ny, nz)
        float64 or bool.
    occupancy : bool
        Whether the values are true and false.
    axes : ndarray (3, 3)
        Along which its points lie, as columns: those of the world, unless it was turned by a course.

    Raises
    ------
    InputError
        When the values have another number of axes, are neither numbers nor truth values, are not finite, or are no
        distances because they change faster than the place (to any of the 26 neighbours).
    """

    def __init__(
        self,
        values: Occupancy,
        origin: Vector,
        spacing: Number,
        *,
        exact: Truth | None = None,
        truncated: Number | None = None,
        name: str | None = None,
    ) -> None:
        start, step = checks.vector("origin", origin), checks.number("spacing", spacing, above=0.0)
        given, known = _checked("values", values, step), checked_exactness(exact, truncated)
        for key, value in known.items():
            if value is not None and given.dtype == np.bool_:
                raise InputError(key, "is for distances", value, "none: these values say what is occupied")
        self._keep(name, values=given, origin=start, spacing=step, axes=IDENTITY, **known)

    @property
    def _box(self) -> Floats | None:
        if not self.occupancy:
            return super()._box
        occupied, half = np.argwhere(self.values), 0.5 * self.spacing * np.abs(self.axes).sum(axis=1)
        return box_around(self.points(occupied), half) if len(occupied) else None

    @property
    def occupancy(self) -> bool:
        """See `Grid`."""
        return bool(self.values.dtype == np.bool_)

    @classmethod
    def load(
        cls, file: str | Path, name: str | None = None, *, exact: Truth | None = None, truncated: Number | None = None
    ) -> "Grid":
        """Read an NPZ file with the arrays `values`, `origin` and `spacing`; nothing in it is ever unpickled.

        Parameters
        ----------
        file : path
        name, exact, truncated
            See `Grid`.

        Raises
        ------
        InputError
            When the file cannot be read, lacks an array or has one of Python objects, or as `Grid` does.
        """
        arrays = read_arrays(Path(file))
        try:
            known: dict[str, Any] = {"exact": exact, "truncated": truncated}
            grid = cls(arrays["values"], arrays["origin"], arrays["spacing"].item(), name=name, **known)
        except InputError as error:
            raise error if error.key in ("name", "exact", "truncated") else error.in_file(file) from None
        grid._set(_source=Origin.of(file, exact=grid.exact, truncated=grid.truncated))
        return grid


def _checked(key: str, values: Any, spacing: float) -> NDArray[Any]:
    """Check values of a grid; return a new read-only array of float64 or bool."""
    expected = "numbers or truth values of shape (nx, ny, nz)"
    try:
        given = np.array(values, order="C")
    except (ValueError, TypeError, OverflowError):
        raise InputError(key, "", values, expected) from None
    if given.dtype.kind not in "biuf":
        raise InputError(key, "", given.dtype.name, expected)
    if given.ndim != 3 or not given.size:
        raise InputError(key, f"shape {given.shape}", values, expected)
    if given.dtype.kind == "f":
        result: NDArray[Any] = _distances(key, given, spacing)
    else:
        if given.max() > 1 or given.min() < 0:
            raise InputError(key, "neither distances nor occupancy", int(given.max()), "floats, or only 0 and 1")
        result = given.astype(np.bool_)
    return checks.closed(result)


def _distances(key: str, given: NDArray[Any], spacing: float) -> Floats:
    if min(given.shape) < 2:
        raise InputError(key, f"shape {given.shape}", given, "at least two points along every axis")
    result: Floats = given.astype(np.float64)
    bad = ~np.isfinite(result)
    if bad.any():
        place = [int(i) for i in np.argwhere(bad)[0]]
        raise InputError(f"{key}{place}", "", float(result[tuple(place)]), "a distance")
    check_lipschitz(key, result, spacing, float(np.finfo(given.dtype).eps))
    return result
