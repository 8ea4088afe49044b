"""A smooth curve through points, by the length along it: what a body is to follow."""

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Rows, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.packing import read_only

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline, CubicSpline
    from scipy.spatial import cKDTree

FINE = 16
"""Pieces between two points, at least, of which lengths are summed."""

LEAST_PIECES = 2000

REFINEMENTS = 4
"""Newton steps towards the nearest place of a curve."""


class Curve(Frozen):
    """The cubic spline through points (parameter: length of the chords); a straight line through two.

    Parameters
    ----------
    points : array_like (K, 3)
        At least two, in the order in which they are passed, in the length unit.
    start : array_like (3,), optional
        Where a straight line to the first point begins, which belongs to the curve.

    Attributes
    ----------
    points : ndarray (K, 3)
    start : ndarray (3,)
    lead : float
        Length of the straight line in front; 0 without one.
    length : float
        Of all of it.

    Raises
    ------
    InputError
        When there are fewer than two points, or two neighbours are equal.
    """

    points: Floats
    start: Floats
    lead: float
    length: float

    def __init__(self, points: Rows, start: Vector | None = None) -> None:
        from scipy.interpolate import CubicSpline  # noqa: PLC0415

        checked = checks.points("curve", points)
        if len(checked) < 2:
            raise InputError("curve", "", points, "at least two points")
        chords = np.linalg.norm(np.diff(checked, axis=0), axis=1)
        if not chords.all():
            first = int(np.argmin(chords)) + 1
            raise InputError(
                f"curve[{first}]", "equal to the point before", checked[first].tolist(), "points that differ"
            )
        knots = np.concatenate([[0.0], np.cumsum(chords)])
        spline = CubicSpline(knots, checked)
        fine = np.interp(
            np.linspace(0.0, len(knots) - 1.0, max(LEAST_PIECES, FINE * len(knots)) + 1), range(len(knots)), knots
        )
        along = np.concatenate([[0.0], np.cumsum(_lengths(spline, fine))])
        begin = checked[0] if start is None else checks.vector("start", start)
        lead = float(np.linalg.norm(checked[0] - begin))
        self._set(points=checked, start=begin, lead=lead, length=lead + float(along[-1]))
        self._set(_spline=spline, _fine=read_only(fine), _along=read_only(along))

    @classmethod
    def bezier(cls, control: Rows, samples: Whole = 200) -> "Curve":
        """Make the Bezier curve of control points (d + 1, 3), through so many of its points."""
        from scipy.special import binom  # noqa: PLC0415

        points = checks.points("control", control)
        t = np.linspace(0.0, 1.0, checks.integer("samples", samples, 2, 100_000))[:, None]
        i, degree = np.arange(len(points)), len(points) - 1
        return cls(binom(degree, i) * (1.0 - t) ** (degree - i) * t**i @ points)

    if TYPE_CHECKING:
        _spline: CubicSpline
        _fine: Floats
        _along: Floats

    def at(self, along: Number | Stack) -> Floats:
        """Points (..., 3) at lengths (...) along the curve; beyond an end, that end."""
        where = checks.stack("along", along, ())
        before = np.clip(self.lead - where, 0.0, self.lead)[..., None]
        return np.where(before > 0.0, self.points[0] - before * self._axis, self._spline(self._parameter(where)))

    def tangent(self, along: Number | Stack) -> Floats:
        """Unit tangents (..., 3) at lengths (...) along the curve."""
        where = checks.stack("along", along, ())
        slopes = np.where((where < self.lead)[..., None], self._axis, self._spline(self._parameter(where), 1))
        return slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)

    def distance(self, points: Stack) -> Floats:
        """Distances (...) of points (..., 3) from the nearest place of the curve."""
        p = checks.stack("points", points, (3,))
        _, nearest = self._tree.query(p)
        t, (low, high) = self._fine[nearest], self._fine[[0, -1]]
        for _ in range(REFINEMENTS):
            off, slope, turn = self._spline(t) - p, self._spline(t, 1), self._spline(t, 2)
            down = (off * slope).sum(-1)
            curvature = (slope * slope).sum(-1) + (off * turn).sum(-1)
            t = np.clip(t - np.where(curvature > 0.0, down / np.where(curvature > 0.0, curvature, 1.0), 0.0), low, high)
        ahead = np.clip(((p - self.start) * self._axis).sum(-1, keepdims=True), 0.0, self.lead)
        feet = self.start + ahead * self._axis, self._spline(self._fine[nearest]), self._spline(t)
        return np.min([np.linalg.norm(foot - p, axis=-1) for foot in feet], axis=0)

    def __repr__(self) -> str:
        return call("Curve", [f"{len(self.points)} points", f"length {self.length:g}"])

    def _parameter(self, along: Floats) -> Floats:
        return self._by_length(np.clip(along - self.lead, 0.0, self._along[-1]))

    @cached_property
    def _by_length(self) -> "CubicHermiteSpline":
        """The parameter by the length along the spline: smooth and rising (slopes as of Fritsch & Carlson 1980)."""
        from scipy.interpolate import CubicHermiteSpline  # noqa: PLC0415

        secants = np.diff(self._fine) / np.diff(self._along)
        steepest = 3.0 * np.minimum(np.append(secants, secants[-1]), np.append(secants[0], secants))
        speeds = np.linalg.norm(self._spline(self._fine, 1), axis=-1)
        slopes = np.divide(1.0, speeds, out=steepest.copy(), where=speeds * steepest > 1.0)
        return CubicHermiteSpline(self._along, self._fine, slopes)

    @property
    def _axis(self) -> Floats:
        """Unit vector (3,) of the straight line in front; zero without one."""
        line: Floats = self.points[0] - self.start
        return line / self.lead if self.lead > 0.0 else line

    @cached_property
    def _tree(self) -> "cKDTree":
        from scipy.spatial import cKDTree  # noqa: PLC0415

        return cKDTree(self._spline(self._fine))


def _lengths(spline: "CubicSpline", parameters: Floats) -> Floats:
    """Lengths of the pieces between neighbouring parameters (m,), by Simpson's rule for the speed."""
    between = 0.5 * (parameters[1:] + parameters[:-1])
    ends, middles = (np.linalg.norm(spline(t, 1), axis=-1) for t in (parameters, between))
    return np.diff(parameters) * (ends[1:] + 4.0 * middles + ends[:-1]) / 6.0
