"""Whether a shape is at rest under its loads: virtual work, by differences of the potential energy.

Arcs, their centers of gravity and the holes of tendons are put together from rotations; see `imbalance`.

Whether tensions within their limits hold a shape without load is a linear program for each. No kernel is used.

Of the lines of `Robot.segments` that asks what `model.elastic` answers in closed form: how much wider limits would have
to be. Arms, moments and displacements are written out from the segments once more.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.actuators import Lines
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.statics.body import Body, body_of

DIFFERENCE = 1e-5
"""By how much coordinates are changed, rad, and lengths relative to themselves."""

TOGETHER = 20_000
"""How many shapes are looked at together, times the squared number of coordinates of one: their arrays stay in caches.
"""

NODES, SHARES = np.polynomial.legendre.leggauss(6)
"""Where the weight of an arc is integrated, from -1 to 1, and how much each place counts."""


def imbalance(robot: Robot, q: Floats, states: Floats, displacements: Floats | None = None) -> float:
    """Return how far the tip is from a shape at rest, about: what moments and forces that are left bend the body by.

    Of many shapes it is the largest.

    Parameters
    ----------
    q : ndarray (..., n, 3)
        The drive.
    states : ndarray (..., N, 4)
        Bends, twist and length of every arc.
    displacements : ndarray (..., m), optional
        Of the actuators; by default those that belong to `q`.
    """
    own = body_of(robot)
    q, states = q.reshape(-1, len(robot), 3), states.reshape(-1, len(own.owners), 4)
    displacements = None if displacements is None else displacements.reshape(len(q), -1)
    most = 1 + TOGETHER // states[0].size ** 2
    if len(q) > most:
        starts = np.arange(most, len(q), most)
        moved = [None] * (len(starts) + 1) if displacements is None else np.split(displacements, starts)
        return max(map(imbalance, [robot] * len(moved), np.split(q, starts), np.split(states, starts), moved))
    length = (q[..., 2] / own.counts)[:, own.owners]
    columns = (own.stiffness[own.owners] / np.maximum(length, 1e-300)[..., None])[..., [0, 0, 1, 2]]
    give = np.flatnonzero(np.isfinite(own.stiffness[own.owners][:, [0, 0, 1, 2]]))
    steps = np.full(states.shape, DIFFERENCE)
    steps[..., 3] *= length
    steps = steps.reshape(len(q), -1)[:, give]
    moves = np.zeros((len(q), len(give), states[0].size))
    moves[:, np.arange(len(give)), give] = steps
    moves = moves.reshape(len(q), len(give), *states.shape[1:])
    around = np.concatenate([moves, -moves, np.zeros((len(q), 1, *states.shape[1:]))], axis=1) + states[:, None]
    energies, lengths = _energy(robot, own, q, around)
    (ahead, back), (longer, shorter) = (np.split(each[:, :-1], 2, axis=1) for each in (energies, lengths))
    pulls = _tensions(robot, own, q, lengths[:, -1], displacements)
    left = np.zeros((len(q), states[0].size))
    left[:, give] = (ahead - back + ((longer - shorter) @ pulls[..., None])[..., 0]) / (2.0 * steps)
    off = np.abs(left.reshape(states.shape) / columns)
    levers = np.cumsum(states[:, ::-1, 3], axis=1)[:, ::-1]
    return float(((off[..., :3].sum(axis=-1) * levers).sum(axis=-1) + off[..., 3].sum(axis=-1)).max())


def pulls(robot: Robot, q: Floats, states: Floats, displacements: Floats | None = None) -> Floats:
    """Return the tensions (..., m) of all actuators in states; NaN of those that are no lines through what gives.

    Parameters are those of `imbalance`.
    """
    own, shapes = body_of(robot), q.reshape(-1, len(robot), 3)
    _, lengths = _energy(robot, own, shapes, states.reshape(len(shapes), 1, -1, 4))
    result = np.full((len(shapes), len(robot.drive)), np.nan)
    result[:, own.lines.actuators] = _tensions(robot, own, shapes, lengths[:, 0], displacements)
    return result.reshape(*q.shape[:-2], -1)


def _energy(robot: Robot, own: Body, q: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Potential energies (T, b) of states (T, b, N, 4), without that of lines, and the lengths (T, b, t) of these."""
    lines, length = own.lines, (q[..., 2] / own.counts)[:, own.owners]
    bends, twists, extents = states[..., :2], states[..., 2], states[..., 3]
    shares = 0.5 * (1.0 + NODES[:, None, None, None])
    centers = np.tensordot(0.5 * SHARES, _ends(shares[..., None] * bends, shares * extents), 1)
    turns, ends = _turns(bends) @ _roll(twists), _ends(bends, extents)
    gravity = np.zeros(3) if robot.gravity is None else robot.gravity
    rotation, place = np.broadcast_to(robot.base[:3, :3], (*states.shape[:2], 3, 3)), robot.base[:3, 3]
    total = _strain(own, q, states, length[:, None])
    long = np.zeros((*states.shape[:2], len(lines.actuators)))
    for k, segment in enumerate(own.owners):
        weights = (place + _turned(rotation, centers[..., k, :])) @ own.weights[segment]
        total = total - length[:, k, None] * weights
        holes = place[..., None, :] + np.einsum("tbij,lj->tbli", rotation, _across(lines.arms))
        place = place + _turned(rotation, ends[..., k, :])
        rotation = rotation @ turns[..., k, :, :]
        if len(lines.actuators):
            there = place[..., None, :] + np.einsum("tbij,lj->tbli", rotation, _across(lines.arms))
            through = (lines.sections[:, 0] <= segment) & (segment <= lines.sections[:, 1])
            half = np.einsum("tbij,lj->tbli", _roll(0.5 * twists[..., k])[..., :2, :2], lines.arms)
            aside = np.square(lines.arms).sum(axis=1) * twists[..., k, None] ** 2
            bent = np.einsum("tbi,tbli->tbl", bends[..., k, :], half)
            along = np.sqrt((extents[..., k, None] - bent) ** 2 + aside)
            chord = np.linalg.norm(there - holes, axis=-1)
            long += np.where(through, np.where(lines.straight, chord, along), 0.0)
        if k == own.ends[segment]:
            for load in robot.payload:
                if robot.end_row(load.segment) == segment + 1:
                    total = total - load.mass * ((place + rotation @ load.position) @ gravity)
        row = robot.rows[segment]
        if isinstance(row, RigidRow):
            place, rotation = place + rotation @ row.tail[:3, 3], rotation @ row.tail[:3, :3]
    return total, long


def _strain(own: Body, q: Floats, states: Floats, length: Floats) -> Floats:
    """Energy (T, b) of bending, twisting and stretching arcs of lengths (T, 1, N); what is rigid has none."""
    stiffness = own.stiffness[own.owners]
    gives = np.where(np.isfinite(stiffness), stiffness, 0.0) / np.maximum(length, 1e-300)[..., None]
    rest = np.where(own.pulled[:, None], own.rest, q[..., :2]) / own.counts[:, None]
    bent = states[..., :2] - _turned(_roll(0.5 * states[..., 2])[..., :2, :2], rest[:, None, own.owners])
    moved = [np.square(bent).sum(axis=-1), states[..., 2] ** 2, (states[..., 3] - length) ** 2]
    return 0.5 * (np.stack(moved, axis=-1) * gives).sum(axis=(-2, -1))


def _tensions(robot: Robot, own: Body, q: Floats, long: Floats, displacements: Floats | None) -> Floats:
    """Tensions (T, t) of lines of these lengths (T, t)."""
    lines = own.lines
    if not len(lines.actuators):
        return np.zeros(long.shape)
    if displacements is None:
        displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
    reaches = np.pad(np.cumsum(q[..., 2], axis=1), ((0, 0), (1, 0)))
    moved = displacements.reshape(len(q), -1)[:, lines.actuators]
    begins, ends = reaches[:, lines.sections[:, 0]], reaches[:, lines.sections[:, 1] + 1]
    held = np.where(lines.pushes, moved, ends - begins - moved)
    if lines.straight.any():  # holes lie on chords of the arcs that nothing loads
        arcs = q[:, own.owners] / own.counts[own.owners][:, None]
        for i in np.flatnonzero(lines.straight):
            x, y, length = arcs[:, (lines.sections[i, 0] <= own.owners) & (own.owners <= lines.sections[i, 1])].T
            along = length - x * lines.arms[i, 0] - y * lines.arms[i, 1]
            held[:, i] += (along * (np.sinc(0.5 * np.hypot(x, y) / np.pi) - 1.0)).sum(axis=0)
    over = long - held
    return np.where(lines.pushes, over, np.maximum(over, 0.0)) / lines.compliance


def _across(arms: Floats) -> Floats:
    """Places (t, 3) beside the backbone."""
    return np.concatenate([arms, np.zeros((len(arms), 1))], axis=1)


def _turned(rotations: Floats, vectors: Floats) -> Floats:
    """Rotations (..., d, d) times vectors (..., d)."""
    return (rotations @ vectors[..., None])[..., 0]


def _turns(bends: Floats) -> Floats:
    """Rotations (..., 3, 3) of arcs with bends (..., 2)."""
    angle, x, y = _angles(bends)
    cosine, sine = np.cos(angle), np.sin(angle)
    less = 1.0 - cosine
    rows = [
        [1.0 - less * x * x, -less * x * y, sine * x],
        [-less * x * y, 1.0 - less * y * y, sine * y],
        [-sine * x, -sine * y, cosine],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _ends(bends: Floats, lengths: Floats) -> Floats:
    """Ends (..., 3) of arcs with bends (..., 2) and lengths (...)."""
    angle, x, y = _angles(bends)
    aside = 0.5 * angle * np.sinc(0.5 * angle / np.pi) ** 2 * lengths
    return np.stack([aside * x, aside * y, lengths * np.sinc(angle / np.pi)], axis=-1)


def _angles(bends: Floats) -> tuple[Floats, Floats, Floats]:
    """Angles (...) of bends (..., 2), and the two parts of their directions."""
    angle = np.hypot(bends[..., 0], bends[..., 1])
    some = np.maximum(angle, 1e-300)
    return angle, bends[..., 0] / some, bends[..., 1] / some


def _roll(angle: Floats) -> Floats:
    """Rotations (..., 3, 3) about z."""
    result = np.zeros((*angle.shape, 3, 3))
    result[..., 0, 0] = result[..., 1, 1] = np.cos(angle)
    result[..., 1, 0] = np.sin(angle)
    result[..., 0, 1] = -result[..., 1, 0]
    result[..., 2, 2] = 1.0
    return result


ROUNDING = 1e-9
"""By how much moments may be out of balance, as a share of the largest."""


def lacking_stretch(robot: Robot, q: Floats) -> float:
    """Return by how much limits of tensions and displacements would have to be wider for shapes (..., n, 3) to be held.

    In the length unit: by how much lines would be stretched. 0 where tensions within them hold all shapes; infinite
    where no tensions hold one.
    """
    from scipy import sparse  # noqa: PLC0415
    from scipy.optimize import linprog  # noqa: PLC0415

    lines = [(k, *each) for k, segment in enumerate(robot.rows) for each in _elastic(segment)]
    shapes = q.reshape(-1, len(robot), 3)
    if not lines:
        return 0.0
    arms, bounds = np.zeros((len(lines), len(robot), 3)), np.zeros((len(lines), 4))
    for row, (k, own, j) in enumerate(lines):
        along = np.array([np.cos(own.angles[j]), np.sin(own.angles[j])]) * own.radius
        if own.one_sided:
            arms[row, robot.drive.before : k + 1, :2] = along
        else:
            arms[row, k] = [*-along, 1.0]
        bounds[row] = *own.tensions, *own.displacements[j]
    stiff = np.array([own.stiffnesses[j] for _, own, j in lines])
    basis = robot.drive.coordinates.basis  # a plane holds what would bend out of it
    arms_along = arms.reshape(len(lines), -1) @ basis
    pulled = (arms_along != 0.0).any(axis=0) | _left_to_stiffness(robot, basis)
    moments = np.array([list(map(_moments, robot.rows, shape)) for shape in shapes]).reshape(len(shapes), -1)
    needed = moments @ basis[:, pulled]
    there, sizes = np.tensordot(shapes, arms, ((1, 2), (1, 2))), np.abs(needed).max(axis=1, initial=1e-300)
    # Tensions t and the lack s: low - s <= t / K <= high + s, and the same of displacements a . q + t / K.
    over = np.concatenate([np.eye(len(lines)), -np.eye(len(lines))] * 2) / np.tile(stiff, 4)[:, None]
    fixed = np.broadcast_to(
        np.concatenate([bounds[:, 1], -bounds[:, 0]]) / np.tile(stiff, 2), (len(shapes), 2 * len(lines))
    )
    most = np.concatenate([fixed, bounds[:, 3] - there, there - bounds[:, 2]], axis=1)
    kept, slack, balance = np.isfinite(most[0]), ROUNDING * sizes[:, None], arms_along[:, pulled].T
    values = np.concatenate([most[:, kept], needed + slack, slack - needed], axis=1)
    of_one = np.concatenate([over[kept], balance, -balance])
    widened = np.tile(np.repeat([-1.0, 0.0], [kept.sum(), 2 * len(balance)]), len(shapes))
    every: Any = sparse.kron(sparse.eye(len(shapes)), of_one)
    rows: Any = sparse.hstack([every, sparse.csr_array(widened[:, None])])
    count = len(shapes) * len(lines)
    least = [(None, None)] * count + [(0.0, None)]
    found = linprog([0.0] * count + [1.0], A_ub=rows, b_ub=values.ravel(), bounds=least)
    return float(found.x[-1]) if found.status == 0 and found.x is not None else np.inf


def _elastic(segment: Segment) -> Iterator[tuple[Lines, int]]:
    for lines in (segment.tendons, segment.chambers):
        if lines is not None and lines.stiffness is not None:
            yield from ((lines, j) for j in range(len(lines.angles)))


def _left_to_stiffness(robot: Robot, basis: Floats) -> np.ndarray:
    """Which bends, of the coordinates of a basis (3 n, c), stiffness resists and no rigid actuator holds."""
    names = [each.name for each in robot.actuators]
    jacobian = robot.drive.jacobian.reshape(len(names), -1)
    rigid = np.ones(len(names), np.bool_)
    if robot.drive.elastic is not None:
        rigid[robot.drive.elastic.places] = False
    driven = (jacobian[rigid] @ basis != 0.0).any(axis=0)
    bends = np.array([[each.stiffness is not None] * 2 + [False] for each in robot.rows]).ravel()
    return np.asarray(~driven & (basis[bends] != 0.0).any(axis=0))


def _moments(segment: Segment, q: Floats) -> tuple[float, float, float]:
    """What a segment resists with: moments of both bends, and the force of its length."""
    own = segment.stiffness
    if own is None:
        return 0.0, 0.0, 0.0
    mean = 0.5 * sum(segment.length)
    pushed = segment.chambers is not None and segment.chambers.stiffness is not None
    length = mean if pushed or segment.length[0] == segment.length[1] else q[2]
    stretch = 0.0 if np.isinf(own.stretch) else own.stretch / mean * (q[2] - mean)
    x, y = own.bend / length * (q[:2] - segment.rest)
    return float(x), float(y), float(stretch)
