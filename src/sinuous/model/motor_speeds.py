"""How fast the motors of elastic actuators run while a robot moves: their values include the stretch.

The stretch of a line is the least tension that holds the shape, over its stiffness. This tension is `t + c max_j f_j`,
see `tension_rows`: `t` of least squares, and a common tension so great that every line j of the group has its least
one; `f_j`, a *floor*, suffices for line j. Where another floor becomes the highest, speeds of motors jump.

On a way s = 0 to 1 let second derivatives of a value, with any of the floors, be at most b. As c is not negative,
`value + b s^2 / 2` is convex: its slope grows all the way. So slopes at both ends, made wider by b, bound all between.
On a straight way on which no length that matters changes b is 0, and the bound is attained.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.model.tension_rows import Forces, LineGroup, LineLimits, TensionRows

PARTS = (1, 4, 16, 64)
"""Into how many parts a way is cut, one number after the other, until its bound is close."""

CLOSE = 1.01
"""How many times what is attained a bound may be."""

ALIKE = 1e-12
"""Floors that differ by less than this share of the tensions of a robot count as equal: rounding."""


class MotorSpeeds:
    """Speeds of elastic lines: of displacement and stretch together, in the length unit.

    Parameters
    ----------
    groups : sequence of LineGroup
    lines : LineLimits
    forces : Forces
    rows : TensionRows
        Of the same lines. Speeds are known where no group feels the common tensions of others (`decoupled`).

    Attributes
    ----------
    row_lines, row_floors : ndarray of int (r,)
        Of the rows of `slopes_at`: a line, and one of its floors; -1 where it has none.
    jumps : ndarray of bool (e,)
        Whether the speed of a line can jump on a straight way.
    linear : bool
        Whether it is even between jumps.
    """

    def __init__(self, groups: Sequence[LineGroup], lines: LineLimits, forces: Forces, rows: TensionRows) -> None:
        self._jacobian, self._forces, self._of_lines = lines.jacobian, forces, rows.least_squares
        self._stiffness = lines.stiffness
        floors, common, starts = list[tuple[Floats, Floats, float]](), list[Floats](), list[int]()
        for group in groups:
            own = np.zeros(len(self._stiffness))
            own[group.lines] = group.common
            ends = [
                (own[j], rows.least_squares[j], *end) for j in np.flatnonzero(own).tolist() for end in rows.ends(j, 0)
            ]
            if ends:
                starts.append(len(floors))
                common.append(own)
            floors += [(-forced / each, shape / each, least / each) for each, forced, shape, least in ends]
        self._starts, self._common = np.array(starts, np.intp), np.array(common).reshape(-1, len(self._stiffness))
        self._of_forces = np.array([each[0] for each in floors]).reshape(-1, self._of_lines.shape[1])
        self._of_shape = np.array([each[1] for each in floors]).reshape(-1, self._jacobian.shape[1])
        self._constant = np.array([each[2] for each in floors])
        self._group = np.repeat(np.arange(len(starts)), np.diff([*starts, len(floors)]))
        self._alike = ALIKE * (sum(group.hold for group in groups) + float(np.abs(self._constant).max(initial=0.0)))
        pairs = [(i, f) for i in range(len(self._stiffness)) for f in self._floors_of(i).tolist() or [-1]]
        self.row_lines, self.row_floors = np.array(pairs, np.intp).T
        self.jumps = np.bincount(self.row_lines) > 1
        self._used = np.abs(np.concatenate([self._of_lines, self._of_forces])).max(axis=0) > 0.0
        self.linear = not bool((forces.varies & self._used).any())

    def most(self, q: Floats, moves: Floats) -> Floats:
        """Return the greatest speeds (..., e) on straight ways from `q` (..., n, 3), by `moves` (..., n, 3).

        Infinite where a segment that resists vanishes on the way.
        """
        x, dx = (each.reshape(*each.shape[:-2], -1) for each in (q, moves))
        for parts in PARTS:
            shares = np.arange(parts + 1.0).reshape(-1, *[1] * x.ndim) / parts
            places = x + shares * dx
            ends, curve = self._at_ends(places[:-1], dx, places[1:], dx), self._curve(places[:-1], places[1:])
            attained = ends.max(axis=0)
            most = (ends + parts * curve).max(axis=0)
            if self.linear or (most <= CLOSE * attained).all():
                break
        return np.asarray(most)

    def most_curved(self, q: Floats, begin: Floats, end: Floats) -> Floats:
        """Return the same on parabolas from `q` that have these slopes (..., n, 3) at their ends; where `linear`."""
        x, dx0, dx1 = (each.reshape(*each.shape[:-2], -1) for each in (q, begin, end))
        own, floors = self._slopes(x, dx1 - dx0)
        curve = np.abs(own) + self._with_floors(np.abs(floors))
        return np.asarray(self._at_ends(x, dx0, x + 0.5 * (dx0 + dx1), dx1) + curve)

    def slopes_at(self, q: Floats) -> Floats:
        """Return derivatives (r, 3 n) by the shape at `q` (n, 3): a row for every line and each of its floors."""
        forces, lines, floors = self._forces.slopes(q.ravel()), self.row_lines, self.row_floors
        tensions, with_floor = self._of_lines[lines] @ forces, np.flatnonzero(floors >= 0)
        own = floors[with_floor]
        raised = self._of_forces[own] @ forces + self._of_shape[own]
        tensions[with_floor] += self._common[self._group[own], lines[with_floor], None] * raised
        return np.asarray(self._jacobian[lines] + tensions / self._stiffness[lines, None])

    def on_top(self, q: Floats) -> NDArray[np.bool_]:
        """Which rows (r,) of `slopes_at` are of the highest floor at `q` (n, 3): several of a line where equal."""
        levels = self._levels(q.ravel())
        highest = levels >= self._highest(levels)[..., self._group] - self._alike
        return np.asarray(np.append(highest, True)[self.row_floors])

    def breaks(self, q: Floats, move: Floats) -> list[float]:
        """Return the shares of a straight way from `q` by `move` (n, 3) where speeds jump, increasing; where `linear`.

        Of each group the floor that is the highest is followed until a faster one meets it.
        """
        levels, (_, slopes), found = self._levels(q.ravel()), self._slopes(q.ravel(), move.ravel()), set[float]()
        for own in (np.flatnonzero(self._group == group) for group in range(len(self._starts))):
            high, fast = levels[own], slopes[own]
            top = int(np.argmax(np.where(high >= high.max() - self._alike, fast, -np.inf)))
            while (fast > fast[top]).any():
                faster = np.flatnonzero(fast > fast[top])
                meets = (high[top] - high[faster]) / (fast[faster] - fast[top])
                share = float(meets.min())
                top = int(faster[np.argmax(np.where(meets <= share, fast[faster], -np.inf))])
                if 0.0 < share < 1.0:
                    found.add(share)
        return sorted(found)

    def _floors_of(self, line: int) -> NDArray[np.intp]:
        return np.flatnonzero(self._common[self._group, line] > 0.0)

    def _at_ends(self, x0: Floats, dx0: Floats, x1: Floats, dx1: Floats) -> Floats:
        """Return the greater of the speeds (..., e) just after ways (..., 3 n) begin and just before they end."""
        greatest = np.zeros(1)
        for x, dx, sign in ((x0, dx0, 1.0), (x1, dx1, -1.0)):
            own, slopes = self._slopes(x, dx)
            levels = self._levels(x)
            alike = levels >= self._highest(levels)[..., self._group] - self._alike
            greatest = np.maximum(
                greatest, np.abs(own + self._with_floors(np.where(alike, sign * slopes, -np.inf), sign))
            )
        return np.asarray(greatest)

    def _slopes(self, x: Floats, dx: Floats) -> tuple[Floats, Floats]:
        """Return speeds of lines (..., e) without a common tension, and of floors (..., f)."""
        forces = self._forces.speeds(x, dx)
        own = dx @ self._jacobian.T + forces @ self._of_lines.T / self._stiffness
        return own, forces @ self._of_forces.T + dx @ self._of_shape.T

    def _levels(self, x: Floats) -> Floats:
        """Return where floors (..., f) are at shapes (..., 3 n)."""
        return np.asarray(self._forces.at(x) @ self._of_forces.T + x @ self._of_shape.T + self._constant)

    def _highest(self, floors: Floats) -> Floats:
        """Return the greatest of the numbers of the floors (..., f) of each group (..., g)."""
        return np.maximum.reduceat(floors, self._starts, axis=-1) if len(self._starts) else floors

    def _with_floors(self, floors: Floats, sign: float = 1.0) -> Floats:
        """Return what the greatest of the numbers of floors (..., f) make of stretches (..., e)."""
        return np.asarray(sign * self._highest(floors) @ self._common / self._stiffness)

    def _curve(self, x0: Floats, x1: Floats) -> Floats:
        """Return second derivatives (..., e) at most on straight ways between shapes (..., 3 n)."""
        if self.linear:
            return np.zeros(len(self._stiffness))
        curve = np.where(self._used, self._forces.curvature(x0, x1), 0.0)
        raised = _weighed(self._common.T, self._highest(_weighed(self._of_forces, curve)))
        return np.asarray((_weighed(self._of_lines, curve) + raised) / self._stiffness)


def _weighed(weights: Floats, numbers: Floats) -> Floats:
    """Weigh numbers (..., c), some of which are infinite, by the sizes of weights (r, c), to (..., r)."""
    sizes, far = np.abs(weights), np.isinf(numbers)
    result = np.where(far, 0.0, numbers) @ sizes.T
    result[far @ (sizes > 0.0).T] = np.inf
    return np.asarray(result)
