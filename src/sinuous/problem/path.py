"""Paths of the tip, poses one after the other, perhaps at times; and smooth curves that a body is to follow."""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, TypedDict, Unpack, overload

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientations, Rows, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.packing import read_only
from sinuous.model.poses import least_rotation
from sinuous.problem.target import GoalArrays, Target, TipGoals

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


MOST_BETWEEN = 100_000


class Orientation(TypedDict, total=False):
    """How the tip points at each position: one of three, as `GoalArrays` has them."""

    directions: Rows | None
    rotations: Orientations | None
    xyzw: Rows | None


OPPOSITE = 1e-6
"""Directions are opposite where the sine of half the angle between them falls short of 1 by less, squared."""


class Path(Frozen, Sequence[Target]):
    """Poses that the tip is to pass one after the other: a sequence of `Target`, which `track` follows.

    Parameters
    ----------
    times : array_like (T,), optional
        When it is to be there, increasing.
    **goals
        As for `Solver.solve_many`: positions (T, 3); and directions (T, 3), rotations (T, 3, 3) or (T, 4), or xyzw.

    Attributes
    ----------
    positions, directions : ndarray (T, 3) or None
    rotations : ndarray (T, 3, 3) or None
    times : ndarray (T,) or None

    Raises
    ------
    InputError
        When it has one point only, or times do not increase.
    """

    positions: Floats | None
    directions: Floats | None
    rotations: Floats | None
    times: Floats | None
    _targets: tuple[Target, ...]

    def __init__(self, times: Vector | None = None, **goals: Unpack[GoalArrays]) -> None:
        self._of(TipGoals.read(goals), times)

    def _of(self, goals: TipGoals, times: Any) -> None:
        if len(goals) < 2:
            raise InputError("path", "", len(goals), "at least two points")
        when = None if times is None else checks.increasing("times", times, len(goals))
        for part in (goals.positions, goals.directions, goals.rotations):
            if part is not None:
                part.flags.writeable = False
        self._set(positions=goals.positions, directions=goals.directions, rotations=goals.rotations, times=when)
        self._set(_targets=Target.of_rows(goals.rows))

    @classmethod
    def spline(
        cls, positions: Rows, times: Vector | None = None, between: Whole = 10, **orientations: Unpack[Orientation]
    ) -> Self:
        """Draw a spline through poses: all of them are on the path, with others between them.

        Positions are on the cubic spline through those that are given (not-a-knot), by time, or by the length of the
        chords. Rotations are on a spline of rotations with continuous angular acceleration (SciPy's `RotationSpline`).
        Directions go with frames that turn from each to the next by the least rotation, on the same spline.

        Parameters
        ----------
        positions : array_like (K, 3)
        times : array_like (K,), optional
        between : int
            How many poses are put between two that are given, evenly by time, or by the length of the chord.
        **orientations
            `directions`, `rotations` or `xyzw`, one for each position.

        Raises
        ------
        InputError
            When two neighbouring points are equal, or two neighbouring directions are opposite.
        """
        from scipy.interpolate import CubicSpline  # noqa: PLC0415

        goals = TipGoals.read({**orientations, "positions": positions})
        points = checks.points("positions", positions)
        if len(points) < 2:
            raise InputError("path", "", len(points), "at least two points")
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if not chords.all():
            equal = int(np.argmin(chords)) + 1
            raise InputError(f"positions[{equal}]", "equal to the one before", points[equal].tolist(), "another point")
        when = None if times is None else checks.increasing("times", times, len(points))
        knots = np.concatenate([[0.0], np.cumsum(chords)]) if when is None else when
        count = checks.integer("between", between, 0, MOST_BETWEEN)
        along = np.interp(np.arange((len(knots) - 1) * (count + 1) + 1) / (count + 1), range(len(knots)), knots)
        path = cls.__new__(cls)
        turned = _turned(goals, knots, along)
        path._of(TipGoals(CubicSpline(knots, points)(along), *turned), None if when is None else along)
        return path

    @classmethod
    def of(cls, function: Callable[[float], Any], times: Vector) -> Self:
        """Take poses from a function of time: a position (3,), position and direction (6,), or a pose (4, 4).

        Raises
        ------
        InputError
            When it returns something else, or times do not increase.
        """
        when = checks.increasing("times", times, None)
        places = [np.asarray(function(t), np.float64) for t in when.tolist()]
        shapes = {place.shape for place in places}
        if len(shapes) > 1 or not shapes <= {(3,), (6,), (4, 4)}:
            raise InputError("function", "", sorted(shapes), "arrays (3,), (6,) or (4, 4), all alike")
        stacked = np.stack(places) if places else np.empty((0, 3))
        if stacked.ndim == 3:
            return cls(when, positions=stacked[:, :3, 3], rotations=stacked[:, :3, :3])
        if stacked.shape[1] == 6:
            return cls(when, positions=stacked[:, :3], directions=stacked[:, 3:])
        return cls(when, positions=stacked)

    @property
    def length(self) -> float:
        """Length of the straight lines from each position to the next; 0 without positions."""
        if self.positions is None:
            return 0.0
        return float(np.linalg.norm(np.diff(self.positions, axis=0), axis=1).sum())

    @overload
    def __getitem__(self, index: int) -> Target: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Target]: ...
    def __getitem__(self, index: int | slice) -> Target | Sequence[Target]:
        return self._targets[index]

    def __len__(self) -> int:
        return len(self._targets)

    def __iter__(self) -> Iterator[Target]:
        return iter(self._targets)

    def __repr__(self) -> str:
        timed = [] if self.times is None else [f"times {self.times[0]:g} to {self.times[-1]:g}"]
        return call("Path", [f"{len(self)} points", f"length {self.length:g}", *timed])


def _turned(goals: TipGoals, knots: Floats, along: Floats) -> tuple[Floats | None, Floats | None]:
    """Directions and rotations of a spline at `along`, of those that are given at `knots`."""
    from scipy.spatial.transform import Rotation, RotationSpline  # noqa: PLC0415

    if goals.rotations is not None:
        matrices: Floats = RotationSpline(knots, Rotation.from_matrix(goals.rotations))(along).as_matrix()
        return None, matrices
    if goals.directions is None:
        return None, None
    frames = RotationSpline(knots, Rotation.from_matrix(_carried(goals.directions)))
    axes: Floats = frames(along).as_matrix()[..., 2]
    return axes, None


def _carried(directions: Floats) -> Floats:
    """Frames (K, 3, 3) with these z axes, each the one before turned by the least rotation."""
    frames = [least_rotation(directions[0])]
    for i in range(1, len(directions)):
        a, b = directions[i - 1], directions[i]
        half = a + b
        square = float(half @ half)
        if square < OPPOSITE:
            raise InputError(f"directions[{i}]", "opposite to the one before", b.tolist(), "less than half a turn")
        turn = 2.0 * np.outer(half, half) / square - np.eye(3)  # half a turn about the middle, after one about a
        frames.append(turn @ (2.0 * np.outer(a, a) - np.eye(3)) @ frames[-1])
    return np.stack(frames)
