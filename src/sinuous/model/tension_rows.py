"""What limits of tension ask of shapes without load: rows that are linear in the forces of springs and in the shape.

`Elastic.balance` takes the least tensions that hold a shape. Of a group of lines that end at one segment they are
`t + c max_j((low_j - t_j) / c_j)`: `t` of least squares, linear in the forces of the springs, and `c` the common
tension, which no other group feels. So a line i is within its greatest tension where `t_i + c_i / c_j (low_j - t_j)`
is, for every line j of its group: a row for each such pair. Where lengths do not change, forces are linear in the shape
and so are rows: shapes within the limits are convex. Where they do, a force is `EI (bend - rest) / length`, of which
the second derivative on a straight way is bounded.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats

NEUTRAL = 1e-7
"""Moment of a common tension on other segments, relative to the longest arm, up to which it is none."""


HALVINGS = 12
"""How often a way between shapes is halved until it is decided whether tensions are within their limits on it."""


class LineGroup(NamedTuple):
    """The elastic lines that end at one segment; none where what runs through it alone holds it.

    Attributes
    ----------
    lines : ndarray of int (g,)
        Among the elastic ones.
    coordinates : ndarray of int (e,)
        What they pull at: those of this segment that move.
    spread : ndarray (g, e)
        From the sums that they have to make to their tensions of least squares.
    common : ndarray (g,)
        Tensions that cancel each other, at least 0; 0 where there are none.
    arm : float
        The longest distance of a line from the backbone, or 1 for the length alone.
    hold : float
        Tension that bends the segment by 1 rad.
    told : ndarray of int
        The lines that are said to be short where the segment is not held: those that end here, or else run through.
    """

    lines: NDArray[np.intp]
    coordinates: NDArray[np.intp]
    spread: Floats
    common: Floats
    arm: float
    hold: float
    told: NDArray[np.intp]


class LineLimits(NamedTuple):
    """Elastic lines: their arms (e, c), stiffness (e,), limits of tensions and of displacements (e, 2)."""

    arms: Floats
    stiffness: Floats
    tensions: Floats
    displacements: Floats
    jacobian: Floats


class Forces(NamedTuple):
    """The forces (c,) of springs `rod (q - rest) / length`.

    Attributes
    ----------
    basis : ndarray (3 n, c)
        Unit vectors along which they push.
    owner : ndarray of int (c,)
        Which segment each of them moves.
    rod, rest : ndarray (c,)
    lengths : ndarray (c,)
        Of their segments, where these do not change.
    varies : ndarray of bool (c,)
    least : float
        Length below which a segment is as stiff as one of this length.
    """

    basis: Floats
    owner: NDArray[np.intp]
    rod: Floats
    rest: Floats
    lengths: Floats
    varies: NDArray[np.bool_]
    least: float

    @property
    def of_length(self) -> NDArray[np.intp]:
        """The length of the segment of each (c,), of the 3 n coordinates."""
        return 3 * self.owner + 2

    def at(self, x: Floats) -> Floats:
        """Forces (..., c) of shapes (..., 3 n)."""
        return self.rod * (x @ self.basis - self.rest) / self._lengths(x)

    def speeds(self, x: Floats, dx: Floats) -> Floats:
        """How fast they change (..., c) where shapes (..., 3 n) change by `dx` (..., 3 n) a time."""
        lengths = self._lengths(x)
        softer = np.where(self.varies & (x[..., self.of_length] > self.least), dx[..., self.of_length] / lengths, 0.0)
        return np.asarray(self.rod * (dx @ self.basis) / lengths - self.at(x) * softer)

    def slopes(self, x: Floats) -> Floats:
        """Their derivative (c, 3 n) at a shape (3 n,)."""
        rows, lengths = np.arange(len(self.owner)), self._lengths(x)
        result = (self.rod / lengths)[:, None] * self.basis.T
        softer = self.varies & (x[self.of_length] > self.least)
        result[rows[softer], self.of_length[softer]] -= (self.at(x) / lengths)[softer]
        return result

    def curvature(self, x0: Floats, x1: Floats) -> Floats:
        """Greatest second derivative (..., c) on the straight way from shapes (..., 3 n) to others."""
        long, step = self._lengths(x0), self._lengths(x1) - self._lengths(x0)
        off, change = x0 @ self.basis - self.rest, (x1 - x0) @ self.basis
        shortest = np.minimum(long, long + step)
        curve = 2.0 * np.abs(step) * self.rod * np.abs(off * step - change * long) / shortest**3
        inexact = self.varies & (shortest <= self.least) & (step != 0.0)
        return np.where(inexact, np.inf, curve)

    def _lengths(self, x: Floats) -> Floats:
        return np.where(self.varies, np.maximum(x[..., self.of_length], self.least), self.lengths)


class TensionRow(NamedTuple):
    """A row: the line that it holds, weights of forces (c,) and of the shape (3 n,), its least and greatest value."""

    line: int
    of_forces: Floats
    of_shape: Floats
    least: float
    most: float


class TensionRows:
    """Rows within whose bounds shapes are exactly where tensions within their limits hold them; in the length unit.

    Parameters
    ----------
    groups : sequence of LineGroup
        From the tip to the base.
    lines : LineLimits
    forces : Forces
    balance : float
        By how much moments may be out of balance, relative to those that bend a segment by 1 rad.

    Attributes
    ----------
    lines : ndarray of int (p,)
        The line that each row holds, among the elastic ones.
    bounds : ndarray (p, 2)
        Least and greatest value of each row.
    linear : bool
        Whether rows are linear in the shape.
    decoupled : bool
        Whether no group feels the common tensions of others. Otherwise there are no rows, and nothing is known.
    least_squares : ndarray (e, c)
        Tensions of least squares, by the forces of springs.
    """

    def __init__(self, groups: Sequence[LineGroup], lines: LineLimits, forces: Forces, balance: float) -> None:
        self._lines, self._forces = lines, forces
        count, coordinates = lines.arms.shape
        self.least_squares = np.zeros((count, coordinates))
        self.decoupled, found = True, list[TensionRow]()
        for group in groups:
            mine = group.lines
            wanted = np.eye(coordinates)[group.coordinates]
            wanted -= lines.arms[:, group.coordinates].T @ self.least_squares
            self.least_squares[mine] = group.spread @ wanted
            left = wanted - lines.arms[np.ix_(mine, group.coordinates)].T @ self.least_squares[mine]
            found += self._unheld(group, left, balance)
            felt = np.abs(group.common @ lines.arms[mine]).max(initial=0.0)
            self.decoupled &= bool(felt <= NEUTRAL * group.arm * group.common.sum())
        for group in groups:
            found += self._of_group(group)
        found = found if self.decoupled else []
        self.lines = np.array([each.line for each in found], np.intp)
        self.bounds = np.array([each[3:] for each in found]).reshape(-1, 2)
        self._of_forces = np.array([each.of_forces for each in found]).reshape(-1, coordinates)
        self._of_shape = np.array([each.of_shape for each in found]).reshape(-1, lines.jacobian.shape[1])
        used = np.abs(self._of_forces).max(axis=0, initial=0.0) > 0.0
        self.linear = self.decoupled and not bool((forces.varies & used).any())

    def values(self, q: Floats) -> Floats:
        """Values (..., p) of the rows at shapes (..., n, 3)."""
        x = q.reshape(*q.shape[:-2], -1)
        return self._forces.at(x) @ self._of_forces.T + x @ self._of_shape.T

    def excess(self, q: Floats) -> Floats:
        """By how much (..., p) shapes (..., n, 3) are outside the bounds of rows; negative within."""
        values = self.values(q)
        return np.maximum(values - self.bounds[:, 1], self.bounds[:, 0] - values)

    def slopes(self, q: Floats) -> Floats:
        """Derivative (p, 3 n) of the values at a shape (n, 3)."""
        return self._of_forces @ self._forces.slopes(q.ravel()) + self._of_shape

    def most_between(self, q0: Floats, q1: Floats) -> Floats:
        """Upper bound (..., p) of the excess on the straight way from shapes (..., n, 3) to others."""
        ends = np.maximum(self.excess(q0), self.excess(q1))
        if self.linear or not self.decoupled:
            return ends
        flat = (each.reshape(*each.shape[:-2], -1) for each in (q0, q1))
        return ends + self._forces.curvature(*flat) @ np.abs(self._of_forces).T / 8.0

    def share_between(self, q0: Floats, q1: Floats, slack: float) -> float:
        """The share, from its beginning, of the straight way between two shapes (n, 3) that is known to be within.

        It is halved until that is decided; `slack` is what rounding may add to the excess.
        """
        if not self.decoupled:
            return 0.0
        done, step, least = 0.0, 1.0, 0.5**HALVINGS
        while done < 1.0:
            end = min(1.0, done + step)
            here, there = ((1.0 - share) * q0 + share * q1 for share in (done, end))
            if (self.most_between(here, there) <= slack).all():
                done, step = end, 2.0 * step
            elif step <= least or (self.excess(here) > slack).any():
                break
            else:
                step *= 0.5
        return done

    def _unheld(self, group: LineGroup, left: Floats, balance: float) -> Iterator[TensionRow]:
        """Yield a row for every direction of moments that the lines of a group cannot hold."""
        _, sizes, directions = np.linalg.svd(left)
        stiff = float(self._lines.stiffness[group.told].min(initial=np.inf))
        nothing, most = np.zeros(self._lines.jacobian.shape[1]), balance * group.hold / stiff
        for size, direction in zip(sizes, directions, strict=False):
            if size > NEUTRAL and len(group.told):
                weights = size * direction / (group.arm * stiff)
                yield TensionRow(int(group.told[0]), weights, nothing, -most, most)

    def _of_group(self, group: LineGroup) -> Iterator[TensionRow]:
        common = dict(zip(group.lines.tolist(), group.common.tolist(), strict=True))
        raising = [j for j, own in common.items() if own > 0.0 and self.ends(j, 0)]
        for i, own in common.items():
            stiff, raised = self._lines.stiffness[i], own > 0.0 and raising
            for shape, most in self.ends(i, 1):
                if not raised:
                    yield TensionRow(i, self.least_squares[i] / stiff, -shape / stiff, -np.inf, float(most / stiff))
                    continue
                for j in raising:
                    factor = own / common[j]
                    forces = self.least_squares[i] - factor * self.least_squares[j]
                    for other, least in self.ends(j, 0):
                        weights = (factor * other - shape) / stiff
                        yield TensionRow(i, forces / stiff, weights, -np.inf, float((most - factor * least) / stiff))
            for shape, least in () if raised else self.ends(i, 0):
                yield TensionRow(i, self.least_squares[i] / stiff, -shape / stiff, float(least / stiff), np.inf)

    def ends(self, i: int, side: int) -> list[tuple[Floats, float]]:
        """Return the least (side 0) or greatest tensions of a line: weights of the shape (3 n,) and a constant."""
        lines, found = self._lines, []
        if np.isfinite(lines.tensions[i, side]):
            found.append((np.zeros(lines.jacobian.shape[1]), float(lines.tensions[i, side])))
        if np.isfinite(lines.displacements[i, side]):
            stiff = float(lines.stiffness[i])
            found.append((-stiff * lines.jacobian[i], stiff * float(lines.displacements[i, side])))
        return found
