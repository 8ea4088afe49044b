"""Obstacles on a regular grid: sampled distances, or occupied cells."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Number, Occupancy, Truth, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.grids.samples import along_axes, check_lipschitz, checked_exactness, exact_below
from sinuous.scene.obstacles import IDENTITY, Obstacle
from sinuous.scene.sources import Source

KNOWN = ("exact", "truncated")
"""Arguments that say what is known of values."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Grid(Obstacle):
    """Values at the points `origin + spacing * (i, j, k)`.

    Numbers are signed distances, positive outside. They prove free what is nearer to a point than its value: out of
    the grid, that ends as far from its border as the values there say.

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

    values: NDArray[Any]
    origin: Floats
    spacing: float
    axes: Floats
    exact: bool | None
    truncated: float | None

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
    def exact_below(self) -> float:
        """From which value on values are lower bounds of the distance alone, unless they are not positive."""
        return exact_below(self.exact, self.truncated, float(self.values.max()))

    @property
    def occupancy(self) -> bool:
        """See `Grid`."""
        return bool(self.values.dtype == np.bool_)

    def points(self, steps: NDArray[Any]) -> Floats:
        """Places (m, 3) that are so many steps (m, 3) from the first point along the axes."""
        return along_axes(self.origin, self.axes, self.spacing * steps)

    @classmethod
    def load(
        cls,
        file: str | Path,
        name: str | None = None,
        *,
        exact: Truth | None = None,
        truncated: Number | None = None,
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
        from sinuous.scene.grids.grid_files import read_arrays  # noqa: PLC0415

        arrays = read_arrays(Path(file))
        try:
            known = checked_exactness(exact, truncated)
            grid = cls(arrays["values"], arrays["origin"], arrays["spacing"].item(), name=name, **known)
        except InputError as error:
            raise error if error.key in ("name", *KNOWN) else error.in_file(file) from None
        grid._set(_source=Source.of(file, **known))
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
    result.flags.writeable = False
    return result


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
