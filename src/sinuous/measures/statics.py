"""Whether a shape is at rest under its loads: virtual work, by differences of the potential energy. No kernel is used.

Arcs, their centers of gravity and the holes of tendons are put together from rotations; see `imbalance`.
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.statics.body import Body, body_of

DIFFERENCE = 1e-5
"""By how much coordinates are changed, rad, and lengths relative to themselves."""

NODES, SHARES = np.polynomial.legendre.leggauss(6)
"""Where the weight of an arc is integrated, from -1 to 1, and how much each place counts."""


def imbalance(robot: Robot, q: Floats, states: Floats, displacements: Floats | None = None) -> float:
    """Return how far the tip is from a shape at rest, about: what moments and forces that are left bend the body by.

    Parameters
    ----------
    q : ndarray (n, 3)
        The drive.
    states : ndarray (N, 4)
        Bends, twist and length of every arc.
    displacements : ndarray (m,), optional
        Of the actuators; by default those that belong to `q`.
    """
    own = body_of(robot)
    if displacements is None and len(robot.drive):
        displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
    length = (q[:, 2] / own.counts)[own.owners]
    stiffness = own.stiffness[own.owners] / np.maximum(length, 1e-300)[:, None]
    columns = stiffness[:, [0, 0, 1, 2]]
    gives = np.isfinite(columns)
    steps = np.array([DIFFERENCE] * 3 + [1.0]) * np.where([[False] * 3 + [True]], DIFFERENCE * length[:, None], 1.0)
    moves = np.zeros((states.size, *states.shape))
    moves.reshape(states.size, -1)[np.arange(states.size), np.arange(states.size)] = steps.ravel()
    moves = moves[gives.ravel()]
    (ahead, longer), (back, shorter) = (_energy(robot, own, q, states + sign * moves) for sign in (1.0, -1.0))
    pulls = _tensions(own, q, _energy(robot, own, q, states[None])[1][0], displacements)
    left = np.zeros(states.size)
    left[gives.ravel()] = (ahead - back + (longer - shorter) @ pulls) / (2.0 * steps.ravel()[gives.ravel()])
    off = left.reshape(states.shape) / np.where(gives, columns, np.inf)
    levers = np.cumsum(states[::-1, 3])[::-1]
    return float(np.abs(off[:, :3]).sum(axis=1) @ levers + np.abs(off[:, 3]).sum())


def pulls(robot: Robot, q: Floats, states: Floats, displacements: Floats | None = None) -> Floats:
    """Return the tensions (m,) of all actuators in a state; NaN of those that are no lines through what gives.

    Parameters are those of `imbalance`.
    """
    own = body_of(robot)
    if displacements is None and len(robot.drive):
        displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
    result = np.full(len(robot.drive), np.nan)
    result[own.lines.actuators] = _tensions(own, q, _energy(robot, own, q, states[None])[1][0], displacements)
    return result


def _energy(robot: Robot, own: Body, q: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Potential energies (b,) of states (b, N, 4), without that of lines, and the lengths (b, t) of these."""
    lines, length = own.lines, (q[:, 2] / own.counts)[own.owners]
    bends, twists, extents = states[..., :2], states[..., 2], states[..., 3]
    shares = 0.5 * (1.0 + NODES[:, None, None])
    centers = np.tensordot(0.5 * SHARES, _ends(shares[..., None] * bends, shares * extents), 1)
    turns, ends = _turns(bends) @ _roll(twists), _ends(bends, extents)
    gravity = np.zeros(3) if robot.gravity is None else robot.gravity
    rotation, place = np.broadcast_to(robot.base[:3, :3], (len(states), 3, 3)), robot.base[:3, 3]
    total = _strain(own, q, states, length)
    long = np.zeros((len(states), len(lines.actuators)))
    for k, segment in enumerate(own.owners):
        total = total - length[k] * ((place + _turned(rotation, centers[:, k])) @ own.weights[segment])
        holes = place[..., None, :] + np.einsum("bij,lj->bli", rotation, _across(lines.arms))
        place = place + _turned(rotation, ends[:, k])
        rotation = rotation @ turns[:, k]
        if len(lines.actuators):
            there = place[..., None, :] + np.einsum("bij,lj->bli", rotation, _across(lines.arms))
            through = (lines.sections[:, 0] <= segment) & (segment <= lines.sections[:, 1])
            half = np.einsum("bij,lj->bli", _roll(0.5 * twists[:, k])[:, :2, :2], lines.arms)
            aside = np.square(lines.arms).sum(axis=1) * twists[:, k, None] ** 2
            along = np.sqrt((extents[:, k, None] - np.einsum("bi,bli->bl", bends[:, k], half)) ** 2 + aside)
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
    """Energy (b,) of bending, twisting and stretching arcs (N,) of such lengths; what is rigid has none."""
    stiffness = own.stiffness[own.owners]
    bend, twist, stretch = (np.where(np.isfinite(stiffness), stiffness, 0.0) / np.maximum(length, 1e-300)[:, None]).T
    rest = np.where(own.pulled[:, None], own.rest, q[:, :2]) / own.counts[:, None]
    bent = states[..., :2] - _turned(_roll(0.5 * states[..., 2])[..., :2, :2], rest[own.owners])
    return 0.5 * (
        np.square(bent).sum(axis=-1) @ bend + states[..., 2] ** 2 @ twist + (states[..., 3] - length) ** 2 @ stretch
    )


def _tensions(own: Body, q: Floats, long: Floats, displacements: Floats | None) -> Floats:
    """Tensions (t,) of lines of these lengths (t,)."""
    lines = own.lines
    if displacements is None or not len(lines.actuators):
        return np.zeros(len(long))
    reaches = np.append(0.0, np.cumsum(q[:, 2]))
    moved, reach = displacements[lines.actuators], reaches[lines.sections[:, 1] + 1] - reaches[lines.sections[:, 0]]
    held = np.where(lines.pushes, moved, reach - moved)
    if lines.straight.any():  # holes lie on chords of the arcs that nothing loads
        even = [(x, y, 0.0, z) for (x, y, z), count in zip(q, own.counts, strict=True) for _ in range(count)]
        arcs = np.array(even) / own.counts[own.owners][:, None]
        for i in np.flatnonzero(lines.straight):
            through = (lines.sections[i, 0] <= own.owners) & (own.owners <= lines.sections[i, 1])
            along = arcs[through, 3] - arcs[through, :2] @ lines.arms[i]
            half = 0.5 * np.hypot(arcs[through, 0], arcs[through, 1])
            held[i] += float((along * (np.sinc(half / np.pi) - 1.0)).sum())
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
