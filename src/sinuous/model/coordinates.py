"""Coordinates of a robot: which may move, and what holds the others.

A bend is free (any direction), in one plane, or locked. Its robot may leave it less than its segment does: where the
robot has actuators that bend, a direction that none of them bends a segment in stays at the rest of that segment, and
limits that are equal hold what they see. What they see of several segments together stays an equation among these.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats, closed
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.kernels.packing import BendLine
from sinuous.model.segment import Segment, across, locked_bend

RANK = 1e-9
"""Weights of actuators that are smaller than this, relative to the largest, move nothing."""

ROUNDING = 1e-12
"""Relative to its direction: what counts as along an axis."""

Bends = float | BendLine
"""The largest bend to all sides, or the bends in one plane."""


class Held(NamedTuple):
    """What holds coordinates of a segment (1 = first), in words that go on after its name."""

    segment: int
    words: str


class Coordinates(Frozen):
    """What of a configuration (n, 3) can move.

    Parameters
    ----------
    segments : sequence of Segment
    curvatures : sequence of float (n,)
        The largest ones.
    jacobian : ndarray (m, 3 n)
        Of the displacements of all actuators.
    limits : ndarray (m, 2)
        Of displacements of rigid actuators; infinite for elastic ones, which limits of displacements do not hold.

    Attributes
    ----------
    bends : tuple
        Of each segment the largest bend to all sides, or the bends in one plane.
    lengths : ndarray (n, 2)
        Least and largest ones.
    origin : ndarray (n, 3)
        What is locked of a configuration, and what it has across the planes of its bends; 0 for what is free.
    basis : ndarray (3 n, c)
        Of what can move: unit vectors, each of one segment.
    owner : ndarray of int (c,)
        Which segment each of them moves.
    held : tuple of Held
        What actuators do not move, and what is locked or in one plane.

    Raises
    ------
    InputError
        When equal limits leave no bend or length of a segment, or it is too curved for any of its lengths.
    """

    bends: tuple[Bends, ...]
    lengths: Floats
    origin: Floats
    basis: Floats
    owner: NDArray[np.intp]
    held: tuple[Held, ...]
    curvatures: tuple[float, ...]

    def __init__(
        self, segments: Sequence[Segment], curvatures: Sequence[float], jacobian: Floats, limits: Floats
    ) -> None:
        bends: list[Bends] = [_own(segment, most) for segment, most in zip(segments, curvatures, strict=True)]
        held = list(_said(segments, bends))
        lengths = np.array([segment.length for segment in segments])
        held += _drive(segments, jacobian, bends)
        equal = np.flatnonzero(limits[:, 0] == limits[:, 1])
        if len(equal):
            held += _equate(jacobian[equal], limits[equal, 0], bends, lengths, _before(segments))
        for k, (bend, curvature) in enumerate(zip(bends, curvatures, strict=True)):
            least = math.hypot(*bend.home) if isinstance(bend, BendLine) else 0.0
            if least > 0.0 and curvature < math.inf:
                if least > curvature * lengths[k, 1]:
                    wanted = f"a bend of at most {curvature * lengths[k, 1]:.4g}, what its curvature and length allow"
                    raise InputError(f"segments[{k - _before(segments)}]", "is locked beyond its limit", least, wanted)
                lengths[k, 0] = max(lengths[k, 0], least / curvature)
        origin, basis, owner = _space(bends, lengths)
        self._set(bends=tuple(bends), lengths=closed(lengths), held=tuple(held), curvatures=tuple(curvatures))
        self._set(origin=closed(origin), basis=closed(basis), owner=closed(owner))

    @property
    def free(self) -> bool:
        """Whether every segment that bends may bend to all sides."""
        return not any(isinstance(each, BendLine) for each in self.bends)

    @property
    def may_be_straight(self) -> bool:
        """Whether every segment may be straight."""
        return not any(isinstance(each, BendLine) and any(each.home) for each in self.bends)

    @property
    def stretches(self) -> NDArray[np.bool_]:
        """Which of the vectors of `basis` (c,) are lengths."""
        result: NDArray[np.bool_] = self.basis[3 * self.owner + 2, np.arange(len(self.owner))] != 0.0
        return result

    @property
    def scales(self) -> Floats:
        """By how much motion along the vectors of `basis` (c,) counts: 1 rad, and mean lengths of segments."""
        result: Floats = np.where(self.stretches, 0.5 * self.lengths[self.owner].sum(axis=1), 1.0)
        return result

    @property
    def unlocked(self) -> NDArray[np.bool_]:
        """Which numbers of a configuration (n, 3) can change."""
        return (self.basis != 0.0).any(axis=1).reshape(-1, 3)

    def moving(self, weights: Floats) -> Floats:
        """What weights (n, 3) see of what can move, a new array."""
        result: Floats = ((weights.ravel() @ self.basis) @ self.basis.T).reshape(-1, 3)
        sizes = np.abs(weights).max(axis=1)
        result[np.abs(result).max(axis=1) <= RANK * sizes] = 0.0
        return result

    def sees(self, row: Floats) -> bool:
        """Whether a row of weights (3 n,) sees anything that can move; rows of robots that are free are kept."""
        return self.free or bool(self.moving(row.reshape(-1, 3)).any())

    @property
    def largest_bends(self) -> tuple[float, ...]:
        """Norm of the largest bend of each segment."""
        return tuple(each.largest if isinstance(each, BendLine) else each for each in self.bends)

    def common(self, seen: Floats) -> Floats | None:
        """Weights (3,) of which the first segments see these (k, 3), if there are any."""
        own = self.owner < len(seen)
        rows = self.basis[: 3 * len(seen), own].reshape(len(seen), 3, -1).sum(axis=0).T
        wanted = seen.ravel() @ self.basis[: 3 * len(seen), own]
        where = np.abs(rows).argmax(axis=1)
        result = np.zeros(3)
        if self.free:
            for c in range(3):
                result[c] = next(iter(wanted[where == c]), 0.0)
        else:
            result = np.asarray(np.linalg.lstsq(rows, wanted, rcond=RANK)[0], np.float64)
            result[np.abs(result) <= ROUNDING * np.abs(result).max(initial=0.0)] = 0.0
        off = np.abs(rows @ result - wanted).max(initial=0.0)
        return result if off <= (0.0 if self.free else RANK * np.abs(wanted).max(initial=0.0)) else None

    def project(self, q: Floats) -> Floats:
        """Configurations (..., n, 3) brought within the limits of segments: first their lengths, then their bends."""
        result = q.copy()
        result[..., 2] = np.clip(q[..., 2], *self.lengths.T)
        most = np.array([math.inf if isinstance(each, BendLine) else each for each in self.bends])
        curvatures = np.array(self.curvatures)
        with np.errstate(invalid="ignore"):  # no limit of curvature, and no length
            curved = curvatures * result[..., 2]
            allowed = np.fmin(most, curved)
        for k, line in enumerate(self.bends):
            if isinstance(line, BendLine):
                along = np.clip(q[..., k, :2] @ np.array(line.plane), line.low, line.high)
                wide = np.sqrt(
                    np.maximum(
                        0.0,
                        np.where(np.isnan(curved[..., k]), np.inf, curved[..., k]) ** 2 - math.hypot(*line.rest) ** 2,
                    )
                )
                along = np.clip(along, np.minimum(-wide, line.high), np.maximum(wide, line.low))
                result[..., k, :2] = np.array(line.rest) + along[..., None] * np.array(line.plane)
                allowed[..., k] = np.inf
        bends = np.hypot(result[..., 0], result[..., 1])
        result[..., :2] *= np.where(bends > allowed, allowed / np.where(bends > 0.0, bends, 1.0), 1.0)[..., None]
        return result

    def notes(self, names: Sequence[str]) -> Iterator[str]:
        """Say what is locked or in one plane, and why; one line for neighbours of which the same is said."""
        for words, group in groupby(sorted(self.held, key=lambda each: each.words), lambda each: each.words):
            for first, last in _runs([each.segment for each in group]):
                who = names[first - 1] if first == last else f"{names[first - 1]} to {names[last - 1]}"
                yield f"{who}: {words}"


def _runs(numbers: Sequence[int]) -> Iterator[tuple[int, int]]:
    first = last = numbers[0]
    for number in numbers[1:]:
        if number != last + 1:
            yield first, last
            first = number
        last = number
    yield first, last


def _own(segment: Segment, curvature: float) -> Bends:
    """Bends that a segment may have by itself; none where it has no length, or must be straight."""
    if (segment.length[1] > 0.0 or segment.rigid) and curvature > 0.0:
        return segment.bends
    return 0.0 if isinstance(segment.bends, float) else locked_bend(segment.bends.home)


def _said(segments: Sequence[Segment], bends: Sequence[Bends]) -> Iterator[Held]:
    """Say what segments themselves hold."""
    for k, (segment, own) in enumerate(zip(segments, bends, strict=True), 1):
        if segment.rigid:
            continue
        if segment.locked is not None:
            for key, value in zip(("bend_x", "bend_y", "length"), segment.locked, strict=True):
                if value is not None:
                    yield Held(k, f"{key} is locked at {value:g}")
        elif segment.plane is not None:
            yield Held(k, f"bends in one plane, at {segment.plane:.4g} rad")
        elif isinstance(own, BendLine):
            yield Held(k, f"max_bend is 0, so its bend is locked at its rest, ({own.rest[0]:g}, {own.rest[1]:g})")


def _drive(segments: Sequence[Segment], jacobian: Floats, bends: list[Bends]) -> Iterator[Held]:
    """Take out of `bends` what no actuator moves, where any actuator bends the robot; yield what is said of it."""
    weights = [_weights(jacobian[:, 3 * k : 3 * k + 2], each) for k, each in enumerate(bends)]
    if not any(len(each) for each in weights):
        return
    for k, (own, seen, segment) in enumerate(zip(bends, weights, segments, strict=True)):
        if segment.rigid:
            continue
        rest = segment.rest
        if isinstance(own, BendLine):
            if own.low < own.high and not len(seen):
                z = min(max(float(rest @ own.plane), own.low), own.high)
                bends[k] = locked_bend(own.at(z))
                yield Held(k + 1, f"no actuator bends it in its plane: its bend is locked at {_pair(own.at(z))}")
        elif own > 0.0 and not len(seen):
            bends[k] = locked_bend((float(rest[0]), float(rest[1])))
            yield Held(k + 1, f"no actuator bends it: its bend is locked at its rest, {_pair(rest)}")
        elif own > 0.0:
            along = _direction(seen[np.argmax(np.linalg.norm(seen, axis=1))])
            beside = np.abs(seen @ (-along[1], along[0]))
            if (beside <= RANK * np.linalg.norm(seen, axis=1)).all():
                off = across(rest, along)
                wide = math.sqrt(max(0.0, own**2 - math.hypot(*off) ** 2))
                bends[k] = BendLine(off, along, -wide, wide)
                angle = math.atan2(along[1], along[0])
                stays = f"; across it, it stays at {_pair(off)}" if any(off) else ""
                yield Held(k + 1, f"no actuator bends it but in one plane, at {angle:.4g} rad{stays}")


def _pair(bend: Sequence[float] | Floats) -> str:
    return f"({bend[0]:g}, {bend[1]:g})"


def _weights(weights: Floats, bends: Bends) -> Floats:
    """What rows (m, 2) weigh of the bends that a segment may have: rows (r, 2) that are not zero."""
    if isinstance(bends, BendLine):
        seen = (weights @ bends.plane)[:, None] * np.array(bends.plane) * float(bends.low < bends.high)
    else:
        seen = weights * float(bends > 0.0)
    sizes = np.linalg.norm(seen, axis=1)
    return seen[(sizes > 0.0) & (sizes > RANK * np.linalg.norm(weights, axis=1))]


def _direction(row: Floats) -> tuple[float, float]:
    """Unit vector along a row (2,), to the right or upwards; exactly along an axis where it nearly is."""
    x, y = row / np.hypot(*row)
    if abs(y) < ROUNDING:
        return 1.0, 0.0
    if abs(x) < ROUNDING:
        return 0.0, 1.0
    return (float(x), float(y)) if x > 0.0 else (-float(x), -float(y))


def _space(bends: Sequence[Bends], lengths: Floats) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Origin (n, 3), basis (3 n, c) and owner (c,) of what can move."""
    origin, columns, owner = np.zeros((len(bends), 3)), [], []
    for k, (own, (low, high)) in enumerate(zip(bends, lengths, strict=True)):
        if isinstance(own, BendLine):
            origin[k, :2] = own.rest
            vectors = [own.plane] if own.low < own.high else []
        else:
            vectors = [(1.0, 0.0), (0.0, 1.0)] if own > 0.0 else []
        if low == high:
            origin[k, 2] = low
        for vector in [(*each, 0.0) for each in vectors] + ([(0.0, 0.0, 1.0)] if low < high else []):
            column = np.zeros(3 * len(bends))
            column[3 * k : 3 * k + 3] = vector
            columns.append(column)
            owner.append(k)
    basis = np.ascontiguousarray(np.array(columns).reshape(-1, 3 * len(bends)).T)
    return origin, basis, np.array(owner, np.intp)


def _before(segments: Sequence[Segment]) -> int:
    """How many rows of joints and links come before the segments."""
    return sum(segment.rigid for segment in segments)


def _equate(rows: Floats, values: Floats, bends: list[Bends], lengths: Floats, before: int) -> Iterator[Held]:
    """Take out of `bends` and `lengths` what rows (r, 3 n) with one value each (r,) leave of single segments."""
    origin, basis, owner = _space(bends, lengths)
    system, sides = rows @ basis, values - rows @ origin.ravel()
    sizes = np.linalg.norm(system, axis=1)
    seen = sizes > RANK * np.linalg.norm(rows, axis=1)
    system, sides = system[seen] / sizes[seen, None], sides[seen] / sizes[seen]
    stretch = basis[3 * owner + 2, np.arange(len(owner))] != 0.0
    for k in range(len(bends)):
        for which in (0, 1):
            own = np.flatnonzero((owner == k) & (stretch == (which == 1)))
            if not len(own) or not len(system):
                continue
            u, s, _ = np.linalg.svd(np.delete(system, own, axis=1), full_matrices=True)
            null = u[:, int((s > RANK).sum()) :].T
            left, size, right = np.linalg.svd(null @ system[:, own], full_matrices=False)
            rank = int((size > RANK).sum())
            if rank == 0:
                continue
            fixed = (left[:, :rank].T @ (null @ sides)) / size[:rank]
            fixed[np.abs(fixed) < ROUNDING] = 0.0
            if which == 1:
                z = _held_at(k - before, float(fixed[0] * right[0, 0]), *lengths[k])
                lengths[k] = z
                yield Held(k + 1, f"equal limits of actuators hold its length at {z:g}")
            else:
                bends[k] = _bends_left(k - before, bends[k], right[:rank], fixed)
                yield Held(k + 1, _equal_words(bends[k]))


def _held_at(k: int, value: float, low: float, high: float) -> float:
    """Check the only value that is left of a segment (0 = first); of joints the numbers are negative."""
    if not low - ROUNDING * max(1.0, abs(low)) <= value <= high + ROUNDING * max(1.0, abs(high)):
        raise InputError(
            f"segments[{k}]" if k >= 0 else "joints",
            "equal limits of actuators hold it outside its own limits",
            value,
            f"[{low:g}, {high:g}]",
        )
    return min(max(value, low), high)


def _bends_left(k: int, own: Bends, right: Floats, fixed: Floats) -> BendLine:
    """Bends of segment `k` of which the products with rows (r, d) are fixed (r,)."""
    if isinstance(own, BendLine):
        return locked_bend(own.at(_held_at(k, float(fixed[0] * right[0, 0]), own.low, own.high)))
    rest = fixed @ right
    size = _held_at(k, float(np.hypot(*rest)), 0.0, own)
    if len(fixed) == len(rest):
        return locked_bend((float(rest[0]), float(rest[1])))
    along = _direction(np.array([-right[0, 1], right[0, 0]]))
    wide = math.sqrt(max(0.0, own**2 - size**2))
    return BendLine(across(rest, along), along, -wide, wide)


def _equal_words(bends: Bends) -> str:
    assert isinstance(bends, BendLine)
    if bends.low == bends.high:
        return f"equal limits of actuators lock its bend at {_pair(bends.rest)}"
    return f"equal limits of actuators leave it one plane, at {math.atan2(bends.plane[1], bends.plane[0]):.4g} rad"
