"""Actuators that stretch: the shape that they pull a robot into, and what to pull for a shape.

Of a line with weights `a` of the coordinates, as in `actuation`, `a . q` is the displacement of a rigid one. An elastic
one of stiffness `K` that is displaced by `d` has the tension `t = K max(0, d - a . q)` if it is a tendon, and
`t = K (d - a . q)` if it is a chamber, which pushes, too. Bends have least energy: for each coordinate `c`,

    k_c (q_c - rest_c) = sum over lines of t a_c        with k = EI / l for bends, EA / l for lengths.

Energies are quadratic, so lines that only pull make a convex, piecewise quadratic problem: its minimum is found by a
semismooth Newton method (Qi & Sun 1993) with an exact line search, in a few steps.

Backwards, a shape says the sums on the right. From the tip to the base, the lines that end at a segment carry what the
ones that run on through it do not. Three tendons have one freedom left, their common tension: it is the least with
which every tension and displacement is within its limits.
"""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.model.actuators import Lines
from sinuous.model.coordinates import Coordinates
from sinuous.model.motor_speeds import MotorSpeeds
from sinuous.model.segment import COORDINATES, Segment
from sinuous.model.tension_rows import Forces, LineGroup, LineLimits, TensionRows

STEPS = 100
"""Most Newton steps of an equilibrium; a handful is usual."""

TOGETHER = 200_000
"""Numbers of the matrices that are solved at once; more rows go in several parts."""


class Springs(NamedTuple):
    """What an equilibrium balances: coordinates that resist, and lines that pull at them.

    The energy is `sum s/2 (x - rest)^2 + sum k/2 e^2`, with the elongation `e = pulled - arms . x` of every line; of a
    line that is one-sided only where `e > 0`.

    Attributes
    ----------
    resistance : ndarray (c,) or (N, c)
        `s` of the coordinates, at least 0.
    rest : ndarray (c,)
    arms : ndarray (m, c)
    stiffness : ndarray (m,)
        `k` of the lines.
    one_sided : ndarray of bool (m,)
    """

    resistance: Floats
    rest: Floats
    arms: Floats
    stiffness: Floats
    one_sided: NDArray[np.bool_]

    def pulls(self, elongation: Floats) -> NDArray[np.bool_]:
        """Which lines (N, m) transmit a force at these elongations (N, m)."""
        return ~self.one_sided | (elongation > 0.0)

    def hessian(self, pulls: NDArray[np.bool_]) -> Floats:
        """Second derivative (N, c, c) of the energy while these lines (N, m) pull."""
        weighted = (pulls * self.stiffness)[:, :, None] * self.arms
        result: Floats = np.matmul(self.arms.T, weighted)
        diagonal = np.arange(self.arms.shape[1])
        result[:, diagonal, diagonal] += self.resistance
        return result


def equilibrium(springs: Springs, pulled: Floats) -> Floats:
    """Coordinates (N, c) of least energy, where lines are pulled by (N, m).

    The energy must be strictly convex: coordinates resist, or two-sided lines hold them.
    """
    count, c = len(pulled), len(springs.rest)
    out, resistance = np.empty((count, c)), np.broadcast_to(springs.resistance, (count, c))
    part = max(1, TOGETHER // max(1, c * c + len(springs.arms) ** 2))
    for first in range(0, count, part):
        rows = slice(first, first + part)
        out[rows] = _equilibrium(springs._replace(resistance=resistance[rows]), pulled[rows])
    return out


def _equilibrium(springs: Springs, pulled: Floats) -> Floats:
    x = np.tile(springs.rest, (len(pulled), 1))
    own, goal, left = springs, pulled, np.arange(len(pulled))
    for _ in range(STEPS):
        now = x[left]
        elongation = goal - now @ own.arms.T
        pulls = own.pulls(elongation)
        slope = own.resistance * (now - own.rest) - (pulls * own.stiffness * elongation) @ own.arms
        step = -np.asarray(np.linalg.solve(own.hessian(pulls), slope[..., None])[..., 0], np.float64)
        change = step @ own.arms.T
        done = (own.pulls(elongation - change) == pulls).all(axis=1)
        share = np.where(done, 1.0, _best_share(own, now, step, elongation, change))
        x[left] = now + share[:, None] * step
        if done.all():
            break
        left, goal, own = left[~done], goal[~done], own._replace(resistance=own.resistance[~done])
    return x


def _best_share(springs: Springs, x: Floats, step: Floats, elongation: Floats, change: Floats) -> Floats:
    """The share (N,) of a step at which the energy along it is least: its slope is piecewise linear, and increases."""
    bends = np.where(change != 0.0, elongation / np.where(change != 0.0, change, 1.0), 0.0)
    kinks = np.sort(np.where(springs.one_sided & (bends > 0.0), bends, 0.0), axis=1)

    def slopes(shares: Floats) -> Floats:
        there = elongation[:, None, :] - shares[:, :, None] * change[:, None, :]
        pulled = np.einsum("nkm,nm->nk", springs.pulls(there) * springs.stiffness * there, change)
        own = np.einsum("nc,nc->n", springs.resistance * (x - springs.rest), step)
        curve = np.einsum("nc,nc->n", springs.resistance * step, step)
        return own[:, None] + shares * curve[:, None] - pulled

    at = slopes(kinks)
    below = (at <= 0.0).sum(axis=1)
    rows = np.arange(len(x))
    left = np.where(below > 0, kinks[rows, np.maximum(below - 1, 0)], 0.0)
    right = np.where(below < kinks.shape[1], kinks[rows, np.minimum(below, kinks.shape[1] - 1)], left + 1.0)
    ends = np.stack([left, right], axis=1)
    low, high = slopes(ends).T
    return left - low * (right - left) / np.where(high != low, high - low, 1.0)


SHORTEST = 1e-9
"""Of the length of the robot: a segment that is retracted further is as stiff as one of this length."""

RANK = 1e-9
"""Lines of a segment that are as nearly dependent as this count as dependent."""

BALANCE = 1e-9
"""By how much moments may be out of balance, relative to those of the stiffness at 1 rad, and count as balanced."""


class Balance(NamedTuple):
    """Tensions of a shape.

    Attributes
    ----------
    tensions : ndarray (..., e)
        Of the elastic lines.
    short : ndarray (..., e)
        By how much displacements miss what would make it possible, in the length unit; at most 0 where it is.
    """

    tensions: Floats
    short: Floats


class Elastic(Frozen):
    """The elastic actuators of a robot.

    Parameters
    ----------
    segments : sequence of Segment
    coordinates : Coordinates
        What of a configuration can move.
    jacobian : ndarray (m, 3 n)
        Of the displacements of all actuators.
    lines : sequence of (int, Lines, int)
        Of the elastic ones: the place among all actuators, what it belongs to, and which of its lines it is.

    Attributes
    ----------
    places : ndarray of int (e,)
        The elastic ones among all actuators.
    determined : ndarray of bool (c,)
        Which of the coordinates they and the stiffness of the segments determine.
    limits : ndarray (e, 2)
        Of tensions.
    bounded : bool
        Whether there are shapes that no tensions within the limits hold.

    Raises
    ------
    InputError
        When a segment that is pulled has no stiffness and its lines do not hold it, or a rigid actuator moves what an
        elastic one pulls at.
    """

    places: NDArray[np.intp]
    determined: NDArray[np.bool_]
    bounded: bool
    limits: Floats
    _bounds: Floats
    _jacobian: Floats
    _rod: Floats
    _lengths: Floats
    _varies: NDArray[np.bool_]
    springs: Springs
    _basis: Floats
    _owner: NDArray[np.intp]
    _stretches: NDArray[np.intp]
    _groups: tuple[LineGroup, ...]

    def __init__(
        self,
        segments: Sequence[Segment],
        coordinates: Coordinates,
        jacobian: Floats,
        lines: Sequence[tuple[int, Lines, int]],
    ) -> None:
        places = np.array([place for place, _, _ in lines], np.intp)
        own = jacobian[places]
        determined = _determined(segments, coordinates, own, np.delete(jacobian, places, axis=0))
        basis, owner = np.ascontiguousarray(coordinates.basis[:, determined]), coordinates.owner[determined]
        stretches = coordinates.stretches[determined].astype(np.intp)
        low, high = np.array([segment.length for segment in segments]).T
        lengths, (least, most) = 0.5 * (low + high), coordinates.lengths.T
        rest = np.stack([*np.array([s.rest for s in segments]).T, lengths], axis=1)
        one_sided = np.array([each.one_sided for _, each, _ in lines])
        stiffness = np.array([each.stiffnesses[j] for _, each, j in lines])
        springs = Springs(np.zeros(len(owner)), rest.ravel() @ basis, own @ basis, stiffness, one_sided)
        loose = (coordinates.stretches & ~determined).nonzero()[0]
        self._set(
            places=places,
            determined=determined,
            limits=np.array([each.tensions for _, each, _ in lines]),
            _bounds=np.array([each.displacements[j] for _, each, j in lines]),
            _jacobian=own,
            _rod=_rod(segments),
            _lengths=np.where(least == most, least, lengths),
            _varies=np.isin(np.arange(len(segments)), coordinates.owner[loose]),
            _basis=basis,
            _owner=owner,
            _stretches=stretches,
            springs=springs,
        )
        self._set(springs=self._springs_at(rest[None]))
        _refuse_loose(segments, self.springs, owner)
        ends = [int(np.flatnonzero(row)[-1]) // 3 for row in own]
        groups = tuple(_groups(springs, owner, ends))
        free = np.isneginf(self._bounds[:, 0]) & np.isposinf(self._bounds[:, 1]) & np.isposinf(self.limits[:, 1])
        free &= ~one_sided | np.isin(np.arange(len(own)), [i for g in groups if g.common.any() for i in g.lines])
        held = sum(np.linalg.matrix_rank(springs.arms[np.ix_(g.lines, g.coordinates)]) for g in groups)
        self._set(_groups=groups, bounded=not (free.all() and held == len(owner)))

    def beyond(self, tensions: Floats) -> Floats:
        """By how much tensions (..., e) are outside their limits, as a stretch in the length unit; 0 within."""
        low, high = self.limits.T
        return np.maximum(0.0, np.maximum(low - tensions, tensions - high)) / self.springs.stiffness

    def shape(self, displacements: Floats, q: Floats) -> Floats:
        """Configurations (..., n, 3) for displacements (..., m) of all actuators; `q` says what rigid ones do."""
        there = np.array(q.reshape(-1, *q.shape[-2:]))
        elastic = displacements[..., self.places]
        pulled = np.broadcast_to(elastic, (*q.shape[:-2], len(self.places))).reshape(len(there), -1)
        own = equilibrium(self._springs_at(there), pulled - self._carried(there))
        flat = there.reshape(len(there), -1)
        return (self._others(flat) + own @ self._basis.T).reshape(q.shape)

    def tensions(self, displacements: Floats, q: Floats) -> Floats:
        """Tensions (..., e) of elastic lines in configurations (..., n, 3), at displacements (..., m) of all."""
        elongation = displacements[..., self.places] - q.reshape(*q.shape[:-2], -1) @ self._jacobian.T
        return np.where(self.springs.pulls(elongation), self.springs.stiffness * elongation, 0.0)

    def stretch(self, q: Floats) -> Floats:
        """By how much (..., e) lines are displaced more than rigid ones would be, in configurations (..., n, 3)."""
        return self.balance(q).tensions / self.springs.stiffness

    def balance(self, q: Floats) -> Balance:
        """The least tensions that hold configurations (..., n, 3)."""
        found = self._balance(q.reshape(-1, *q.shape[-2:]))
        return Balance(*(each.reshape(*q.shape[:-2], -1) for each in found))

    def _balance(self, q: Floats) -> Balance:
        springs = self._springs_at(q)
        x = q.reshape(len(q), -1)
        rigid = x @ self._jacobian.T
        low, high = np.moveaxis(springs.stiffness[:, None] * (self._bounds - rigid[..., None]), -1, 0)
        low, high = np.maximum(self.limits[:, 0], low), np.minimum(self.limits[:, 1], high)
        needed = springs.resistance * (x @ self._basis - springs.rest)
        tensions, short = np.zeros_like(rigid), np.zeros_like(rigid)
        for group in self._groups:
            mine = group.lines
            wanted = needed[:, group.coordinates] - tensions @ springs.arms[:, group.coordinates]
            tension = wanted @ group.spread.T
            left = wanted - tension @ springs.arms[np.ix_(mine, group.coordinates)]
            tension = tension + _common(group.common, tension, low[:, mine])[:, None] * group.common
            tensions[:, mine] = tension
            outside = np.maximum(low[:, mine] - tension, tension - high[:, mine])
            unheld = np.linalg.norm(left, axis=1, keepdims=True) / group.arm
            short[:, mine] = np.where(np.isfinite(outside), outside, -np.inf) / springs.stiffness[mine]
            told, missing = group.told, unheld - BALANCE * group.hold
            short[:, told] = np.maximum(short[:, told], missing / springs.stiffness[told])
        return Balance(tensions, short)

    @cached_property
    def rows(self) -> TensionRows:
        """What limits of tension ask of shapes, row by row."""
        return TensionRows(self._groups, self._line_limits, self._forces, BALANCE)

    @cached_property
    def speeds(self) -> MotorSpeeds:
        """How fast displacements and stretches change together."""
        return MotorSpeeds(self._groups, self._line_limits, self._forces, self.rows)

    @cached_property
    def _line_limits(self) -> LineLimits:
        return LineLimits(self.springs.arms, self.springs.stiffness, self.limits, self._bounds, self._jacobian)

    @cached_property
    def _forces(self) -> Forces:
        own, shortest = self._owner, SHORTEST * float(self._lengths.sum())
        lengths = np.maximum(self._lengths[own], shortest)
        rod = self._rod[own, 2 * self._stretches]
        return Forces(self._basis, own, rod, self.springs.rest, lengths, self._varies[own], shortest)

    def _carried(self, q: Floats) -> Floats:
        """What coordinates that rigid actuators determine make of the displacements (N, e)."""
        return self._others(q.reshape(len(q), -1)) @ self._jacobian.T

    def _others(self, x: Floats) -> Floats:
        """Configurations (N, 3 n) without what these determine."""
        return x - (x @ self._basis) @ self._basis.T

    def _springs_at(self, q: Floats) -> Springs:
        """The springs of configurations (N, n, 3): a segment that rigid actuators lengthen is softer."""
        lengths = np.where(self._varies, q[..., 2], self._lengths) if self._varies.any() else self._lengths
        least = np.maximum(lengths, SHORTEST * self._lengths.sum())
        resists = self._rod / least[..., None]
        return self.springs._replace(resistance=resists[..., self._owner, 2 * self._stretches])


def _common(common: Floats, tension: Floats, low: Floats) -> Floats:
    """How much (N,) of the common tension brings all of a group (N, g) to their least ones."""
    held = (common > 0.0) & np.isfinite(low)
    if not held.any():
        return np.zeros(len(tension))
    lacking = np.where(held, (low - tension) / np.where(common > 0.0, common, 1.0), -np.inf)
    result: Floats = lacking.max(axis=1)
    return np.where(np.isfinite(result), result, 0.0)


def _rod(segments: Sequence[Segment]) -> Floats:
    """EI, EI, EA (n, 3) of segments; 0 where nothing resists."""
    stiff = [segment.stiffness for segment in segments]
    bend = np.array([0.0 if each is None else each.bend for each in stiff])
    stretch = np.array([0.0 if each is None or math.isinf(each.stretch) else each.stretch for each in stiff])
    return np.stack([bend, bend, stretch], axis=1)


def _determined(
    segments: Sequence[Segment], coordinates: Coordinates, elastic: Floats, rigid: Floats
) -> NDArray[np.bool_]:
    """Coordinates (c,) that elastic lines, with these weights (e, 3 n), and the stiffness of segments determine.

    Refused where rigid actuators, with weights (r, 3 n), move the same.
    """
    pulled, driven = ((rows @ coordinates.basis != 0.0).any(axis=0) for rows in (elastic, rigid))
    for c in np.flatnonzero(pulled & driven):
        k, which = int(coordinates.owner[c]), int(np.argmax(np.abs(coordinates.basis[:, c]))) % 3
        problem = f"a rigid actuator moves {COORDINATES[which]}, which elastic ones pull at"
        raise InputError(_key(segments, k), problem, segments[k], "stiffness for all tendons and chambers, or for none")
    resists = np.array([segment.stiffness is not None for segment in segments])[coordinates.owner]
    result: NDArray[np.bool_] = pulled | (~driven & resists & ~coordinates.stretches)
    return result


def _key(segments: Sequence[Segment], k: int) -> str:
    """What the problem file calls row `k`; joints and links are not counted."""
    return f"segments[{k - sum(each.rigid for each in segments)}]"


def _refuse_loose(segments: Sequence[Segment], springs: Springs, owner: NDArray[np.intp]) -> None:
    """Refuse a robot some coordinate of which nothing holds when its one-sided lines are slack."""
    hold = springs.hessian(~springs.one_sided[None])[0]
    hold /= max(float(np.abs(hold).max(initial=0.0)), np.finfo(float).tiny)
    _, sizes, directions = np.linalg.svd(hold)
    loose = np.flatnonzero((np.abs(directions[sizes < RANK]) > RANK).any(axis=0))
    if len(loose):
        k = int(owner[loose[0]])
        key, wanted = f"{_key(segments, k)}.stiffness", "the stiffness of what elastic lines bend, like {bend: EI}"
        raise InputError(key, "missing", segments[k].stiffness, wanted)


def _groups(springs: Springs, owner: NDArray[np.intp], ends: list[int]) -> Iterator[LineGroup]:
    """Yield the lines that end at each segment, from the tip to the base."""
    for k in sorted({*ends, *owner.tolist()}, reverse=True):
        lines = np.array([i for i, end in enumerate(ends) if end == k], np.intp)
        coordinates = np.flatnonzero(owner == k)
        arms = springs.arms[np.ix_(lines, coordinates)]
        if not len(coordinates):
            arms = np.zeros((len(lines), 0))
        pull = springs.one_sided[lines]
        common = np.where(pull, 1.0, 0.0)
        tendons = arms[pull]
        common[pull] -= tendons @ (np.linalg.pinv(tendons, rcond=RANK) @ np.ones(int(pull.sum())))
        if (common[pull] < RANK).any():
            common[:] = 0.0
        hold = float(np.abs(springs.resistance[..., coordinates]).sum())
        arm = float(np.linalg.norm(arms, axis=1).max(initial=0.0)) or 1.0
        spread = np.asarray(np.linalg.pinv(arms.T, rcond=RANK), np.float64)
        told = lines if len(lines) else np.array([i for i, end in enumerate(ends) if end > k], np.intp)
        yield LineGroup(lines, coordinates, spread, common, arm, hold / arm, told)
