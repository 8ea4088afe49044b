"""Paths of the tip: poses one after the other, perhaps at times; from arrays, splines, or a function of time."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Self, TypedDict, Unpack, overload

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Orientations, Rows, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.model.poses import least_rotation
from sinuous.problem.target import GoalArrays, Target, TipGoals

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
