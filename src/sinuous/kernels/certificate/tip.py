"""How far the tip is from a straight line, while the robot goes linearly in q from one configuration to another.

The tip's acceleration is bounded as `sweep` says. So between two of its places, a duration of h apart, it is within
`h^2 / 8` of that bound of the chord of its way.
"""

import math

from sinuous.kernels.certificate.sweep import at_time
from sinuous.kernels.chain.kinematics import compose, forward, frame, put_frame
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, get_vec, norm, sub
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
    square, away = dot(along, along), sub(p, a)
    fraction = min(1.0, max(0.0, dot(away, along) / square)) if square > 0.0 else 0.0
    return norm(add_scaled(away, -fraction, along))


@entry
def leave_line(robot: Array, ends: Array, line: Array, enough: float, q: Array, frames: Array) -> float:
    """Upper bound of how far the tip leaves a line from `line[0]` to `line[1]` (2, 3) in a motion.

    `ends` (2, n, 3): the first and the last configuration, where the tip is on the line. What is not above `enough`
    need not be bounded more tightly. `q` (n, 3) and `frames` (n + 1, 12) are scratch.
    """
    own = read_robot(robot)
    offset, shift = frame(own.tool, 0)
    acceleration = tip_acceleration(own.limits, ends[0], ends[1], norm(shift))
    if acceleration <= 8.0 * enough:
        return acceleration / 8.0
    rotation, position = frame(own.base, 0)
    put_frame(frames, 0, rotation, position)
    begin = get_vec(line, 0, 0)
    along, far = sub(get_vec(line, 1, 0), begin), 0.0
    for i in range(TIP_PIECES + 1):
        at_time(ends[0], ends[1], i / TIP_PIECES, q)
        forward(own.limits, q, frames)
        rotation, position = frame(frames, q.shape[0])
        far = max(far, _distance(compose(rotation, position, offset, shift)[1], begin, along))
    return far + acceleration / (8.0 * TIP_PIECES * TIP_PIECES)
