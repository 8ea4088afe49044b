"""How far the tip is off a line and turned from it, while the robot goes linearly in q between two configurations.

The tip's acceleration is bounded as `sweep` says. So between two of its places, a duration of h apart, it is within
`h^2 / 8` of that bound of the chord of its way.

`q0` (n, 3) and `q1` (n, 3) are the first and the last configuration.
"""

import math

from sinuous.kernels.body.chords import nearest_share
from sinuous.kernels.chain.kinematics import compose, forward, frame, interpolate, put_base
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, cross, dot, get_vec, norm, scale, sub, transpose
from sinuous.kernels.problem import read_robot
from sinuous.kernels.tables import TAIL_LENGTH

TIP_PIECES = 8
"""Pieces of a step between whose ends the tip's way is examined, where the bound alone is not enough."""


def tip_acceleration(limits: Array, q0: Array, q1: Array, lever: float) -> float:
    """Bound of the tip's acceleration in a motion that takes a unit of time; `lever`: how far the tool is off."""
    total = turning = 0.0
    for k in range(q0.shape[0]):
        before = turning
        turning += math.hypot(q1[k, 0] - q0[k, 0], q1[k, 1] - q0[k, 1])
        total += max(q0[k, 2], q1[k, 2]) * (before * before + before * turning + turning * turning) / 3.0
        total += abs(q1[k, 2] - q0[k, 2]) * (before + turning)
        total += limits[k, TAIL_LENGTH] * turning * turning
    return total + lever * turning * turning


def _distance(p: Vec, a: Vec, along: Vec) -> float:
    """Distance of a place from the straight line that begins at `a`."""
    return norm(add_scaled(sub(p, a), -nearest_share(p, a, along), along))


@entry
def leave_line(robot: Array, ends: Array, line: Array, enough: float, q: Array, frames: Array) -> float:
    """Upper bound (length unit) of how far the tip leaves a `line` (2, 3), of two places in the world, in a motion.

    `ends` (2, n, 3): the first and the last configuration, where the tip is on the line. What is not above `enough`
    need not be bounded more tightly. `q` (n, 3) and `frames` (n + 1, 12) are scratch.
    """
    own = read_robot(robot)
    offset, shift = frame(own.tool, 0)
    acceleration = tip_acceleration(own.limits, ends[0], ends[1], norm(shift))
    if acceleration <= 8.0 * enough:
        return acceleration / 8.0
    put_base(frames, own.base)
    begin = get_vec(line, 0, 0)
    along, far = sub(get_vec(line, 1, 0), begin), 0.0
    for i in range(TIP_PIECES + 1):
        interpolate(ends[0], ends[1], i / TIP_PIECES, q)
        forward(own.limits, q, frames)
        rotation, position = frame(frames, q.shape[0])
        far = max(far, _distance(compose(rotation, position, offset, shift)[1], begin, along))
    return far + acceleration / (8.0 * TIP_PIECES * TIP_PIECES)


def _turned(b: Vec, axis: Vec, sine: float, cosine: float) -> Vec:
    """A vector turned about an axis by an angle."""
    return add_scaled(add_scaled(scale(cosine, b), sine, cross(axis, b)), (1.0 - cosine) * dot(axis, b), axis)


@entry
def turn_off(robot: Array, ends: Array, line: Array, turn: Array, q: Array, frames: Array) -> float:
    """Largest angle of the tip from its line at places of a motion; no bound of what is between these.

    `turn` (5, 3): the axis, the angle and the number of columns of the orientation at the beginning, and these: all
    three, or the direction alone. A `line` (2, 3) without length is one by angles; `ends` (2, n, 3). The rest as for
    `leave_line`.
    """
    own = read_robot(robot)
    offset, shift = frame(own.tool, 0)
    put_base(frames, own.base)
    begin, axis = get_vec(line, 0, 0), get_vec(turn, 0, 0)
    along, angle, three = sub(get_vec(line, 1, 0), begin), turn[1, 0], turn[1, 1] > 1.0
    most = 0.0
    for i in range(1, TIP_PIECES):
        interpolate(ends[0], ends[1], i / TIP_PIECES, q)
        forward(own.limits, q, frames)
        rotation, position = frame(frames, q.shape[0])
        columns, place = compose(rotation, position, offset, shift)
        x, y, z = transpose(columns)
        share = nearest_share(place, begin, along)
        if dot(along, along) == 0.0 and angle > 0.0:
            first = get_vec(turn, 2, 0)
            sine, cosine = dot(cross(axis, first), x if three else z), dot(first, x if three else z)
            if three:
                second, third = get_vec(turn, 3, 0), get_vec(turn, 4, 0)
                sine = 0.5 * (sine + dot(cross(axis, second), y) + dot(cross(axis, third), z))
                cosine = 0.5 * (cosine + dot(second, y) + dot(third, z) - 1.0)
            share = min(1.0, max(0.0, math.atan2(sine, cosine) / angle))
        sine, cosine = math.sin(share * angle), math.cos(share * angle)
        met = dot(_turned(get_vec(turn, 2, 0), axis, sine, cosine), x if three else z)
        if three:
            met += dot(_turned(get_vec(turn, 3, 0), axis, sine, cosine), y)
            met = 0.5 * (met + dot(_turned(get_vec(turn, 4, 0), axis, sine, cosine), z) - 1.0)
        most = max(most, math.acos(min(1.0, max(-1.0, met))))
    return most
