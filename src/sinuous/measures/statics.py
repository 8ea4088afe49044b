"""Whether a shape is at rest under its loads: virtual work, by differences of the potential energy. No kernel is used.

Arcs, their centers of gravity and the holes of tendons are put together from rotations; see `imbalance`.
"""

import numpy as np

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
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


def _energy(robot: Robot, own: Body, q: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Potential energies (b,) of states (b, N, 4), without that of lines, and the lengths (b, t) of these."""
    length = q[:, 2] / own.counts
    rotation, place = np.broadcast_to(robot.base[:3, :3], (len(states), 3, 3)), robot.base[:3, 3]
    total = np.zeros(len(states))
    lines = own.lines
    long = np.zeros((len(states), len(lines.actuators)))
    payloads = {each.segment or len(robot): [] for each in robot.payload}  # type: ignore[var-annotated]
    for each in robot.payload:
        payloads[each.segment or len(robot)].append(each)
    for k in range(states.shape[1]):
        segment = int(own.owners[k])
        bend, twist, extent = states[:, k, :2], states[:, k, 2], states[:, k, 3]
        rest = own.rest[segment] if own.pulled[segment] else q[segment, :2]
        total = total + _strain(own, segment, rest / own.counts[segment], states[:, k], float(length[segment]))
        middles = [_arc(0.5 * (1.0 + node) * bend, 0.5 * (1.0 + node) * extent)[1] for node in NODES]
        center = place + np.einsum("bij,bj->bi", rotation, np.einsum("g,gbi->bi", 0.5 * SHARES, np.array(middles)))
        total = total - length[segment] * (center @ own.weights[segment])
        holes = place[..., None, :] + np.einsum("bij,lj->bli", rotation, _across(lines.arms))
        turn, shift = _arc(bend, extent)
        place = place + np.einsum("bij,bj->bi", rotation, shift)
        rotation = rotation @ turn @ _roll(twist)
        if len(lines.actuators):
            there = place[..., None, :] + np.einsum("bij,lj->bli", rotation, _across(lines.arms))
            through = (lines.sections[:, 0] <= segment) & (segment <= lines.sections[:, 1])
            half = np.einsum("bij,lj->bli", _roll(0.5 * twist)[:, :2, :2], lines.arms)
            aside = np.square(lines.arms).sum(axis=1) * twist[:, None] ** 2
            along = np.sqrt((extent[:, None] - np.einsum("bi,bli->bl", bend, half)) ** 2 + aside)
            chord = np.linalg.norm(there - holes, axis=-1)
            long += np.where(through, np.where(lines.straight, chord, along), 0.0)
        if k == own.ends[segment]:
            for load in payloads.get(segment + 1, ()):
                total = total - load.mass * ((place + rotation @ load.position) @ robot.gravity)
    return total, long


def _strain(own: Body, segment: int, rest: Floats, state: Floats, length: float) -> Floats:
    """Energy (b,) of bending, twisting and stretching one arc; what is rigid has none."""
    bend, twist, stretch = (
        np.where(np.isfinite(own.stiffness[segment]), own.stiffness[segment], 0.0) / length
    ).tolist()
    bent = state[:, :2] - np.einsum("bij,j->bi", _roll(0.5 * state[:, 2])[:, :2, :2], rest)
    result: Floats = 0.5 * (
        bend * np.square(bent).sum(axis=1) + twist * state[:, 2] ** 2 + stretch * (state[:, 3] - length) ** 2
    )
    return result


def _tensions(own: Body, q: Floats, long: Floats, displacements: Floats | None) -> Floats:
    """Tensions (t,) of lines of these lengths (t,)."""
    lines = own.lines
    if displacements is None or not len(lines.actuators):
        return np.zeros(len(long))
    moved, reach = displacements[lines.actuators], np.cumsum(q[:, 2])[lines.sections[:, 1]]
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
    result: Floats = np.where(lines.pushes, over, np.maximum(over, 0.0)) / lines.compliance
    return result


def _across(arms: Floats) -> Floats:
    """Places (t, 3) beside the backbone."""
    return np.concatenate([arms, np.zeros((len(arms), 1))], axis=1)


def _arc(bend: Floats, length: Floats) -> tuple[Floats, Floats]:
    """Rotations (b, 3, 3) and ends (b, 3) of arcs with bends (b, 2) and lengths (b,)."""
    angle = np.hypot(bend[:, 0], bend[:, 1])
    x, y = (bend / np.maximum(angle, 1e-300)[:, None]).T
    cosine, sine = np.cos(angle), np.sin(angle)
    less = 1.0 - cosine
    rows = [
        [1.0 - less * x * x, -less * x * y, sine * x],
        [-less * x * y, 1.0 - less * y * y, sine * y],
        [-sine * x, -sine * y, cosine],
    ]
    aside = 0.5 * angle * np.sinc(0.5 * angle / np.pi) ** 2 * length
    return np.moveaxis(np.array(rows), -1, 0), np.stack(
        [aside * x, aside * y, length * np.sinc(angle / np.pi)], axis=-1
    )


def _roll(angle: Floats) -> Floats:
    """Rotations (b, 3, 3) about z."""
    result = np.zeros((len(angle), 3, 3))
    result[:, 0, 0] = result[:, 1, 1] = np.cos(angle)
    result[:, 1, 0] = np.sin(angle)
    result[:, 0, 1] = -result[:, 1, 0]
    result[:, 2, 2] = 1.0
    return result
