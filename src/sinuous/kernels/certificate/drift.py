"""Obstacles that move while the robot does.

During a step, of times 0 to 1, the frame in which an obstacle is described is at `c(t) = c0 + t v`, turned by
`R(t) = R0 exp(t [w])`. In that frame a place x of the world is at `R(t)' (x - c(t))`, and distances change by no more
than one moves. So from the middle m of an interval of duration h to any time t in it, the distance of x changes by at
most

    |t - m| (|v| + |w| |x - c(m)|)  <=  h / 2 (|v| + |w| |x - c(m)|).

Hence what is proved of the scene as it is half-way through an interval holds for all of it, with this taken off.
"""

from sinuous.kernels.certificate.sweep import Motion, Sweep
from sinuous.kernels.maths.rotations import exponential
from sinuous.kernels.maths.vectors import (
    Vec,
    add,
    add_scaled,
    get_mat,
    get_vec,
    mat_mat,
    mat_vec,
    norm,
    put_mat,
    put_vec,
    scale,
    sub,
)
from sinuous.kernels.tables import AXES, CENTER, KIND, PLACE, PLACED, POSE_POSITION, POSE_ROTATION, TREE

OF, BEGIN, VELOCITY, TURNED, TURN, OWN_CENTER, OWN_AXES = 0, 1, 4, 7, 16, 19, 22
"""Columns of a drift: the obstacle; c0 (3) and v (3), length unit; R0 (9, row by row) and w (3), rad; and of a
primitive its center (3) and axes (9) in the frame in which it is described."""

SPEED, SPIN, FRAME_AT = 0, 1, 2
"""Columns of a pace: |v| and |w|, 0 of what stands still, and c (3) at the time that the scene is of."""


def place_obstacles(motion: Motion, t: float, sweep: Sweep) -> None:
    """Put all obstacles that move where they are at time t, in the rows of the scene."""
    drifts, table = motion.drifts, motion.scene.table
    for e in range(drifts.shape[0]):
        i = int(drifts[e, OF])
        center = add_scaled(get_vec(drifts, e, BEGIN), t, get_vec(drifts, e, VELOCITY))
        rotation = mat_mat(get_mat(drifts, e, TURNED), exponential(scale(t, get_vec(drifts, e, TURN))))
        put_vec(sweep.paces, i, FRAME_AT, center)
        if table[i, KIND] < TREE:
            put_vec(table, i, CENTER, add(center, mat_vec(rotation, get_vec(drifts, e, OWN_CENTER))))
            put_mat(table, i, AXES, mat_mat(rotation, get_mat(drifts, e, OWN_AXES)))
        else:
            table[i, PLACED] = 1.0
            put_vec(table, i, PLACE + POSE_POSITION, center)
            put_mat(table, i, PLACE + POSE_ROTATION, rotation)


def measure_paces(motion: Motion, base: Vec, reach: float, sweep: Sweep) -> tuple[float, float]:
    """Fill the paces of all obstacles.

    Returns how far anything that moves may come nearer to a place within `reach` of the `base`, and how far from there
    and from the origin of the world what it turns about may be.
    """
    drifts, paces = motion.drifts, sweep.paces
    for i in range(paces.shape[0]):
        paces[i, SPEED] = paces[i, SPIN] = 0.0
    most = far = 0.0
    for e in range(drifts.shape[0]):
        i, begin = int(drifts[e, OF]), get_vec(drifts, e, BEGIN)
        speed, spin = norm(get_vec(drifts, e, VELOCITY)), norm(get_vec(drifts, e, TURN))
        paces[i, SPEED], paces[i, SPIN] = speed, spin
        most = max(most, speed + spin * (norm(sub(begin, base)) + speed + reach))
        far = max(far, norm(begin) + speed + norm(get_vec(drifts, e, OWN_CENTER)))
    return most, far


def drift_of(sweep: Sweep, i: int, h: float, place: Vec, reach: float) -> float:
    """How much the distance to obstacle `i` may change within h / 2, for what is within `reach` of a place."""
    speed, spin = sweep.paces[i, SPEED], sweep.paces[i, SPIN]
    if spin == 0.0:
        return float(0.5 * h * speed)
    return float(0.5 * h * (speed + spin * (norm(sub(place, get_vec(sweep.paces, i, FRAME_AT))) + reach)))
