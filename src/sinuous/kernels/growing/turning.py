"""Chains that were grown from the target to the base, turned round.

Seen from its end, an arc with the bends `(ux, uy)` is the arc `(ux, -uy)`, in frames that are turned by half a turn
about x. Frames along a chain do not turn about its tangent, so what the base is turned about it is the same for all
segments.
"""

import math

from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array, get_vec, mat_mat, put_vec, transpose
from sinuous.kernels.problem import read_robot


@entry
def turn_round(robot: Array, turned: Array, chain: Array, q: Array) -> None:
    """Turn a chain round: fill `q` (n, 3) for a robot with `chain` (n, 3) of the robot `turned` (w,); both are groups.

    The chain has to end at the base of the robot, against its tangent.
    """
    base = frame(read_robot(robot).base, 0)[0]
    rotation = frame(read_robot(turned).base, 0)[0]
    n = chain.shape[0]
    for k in range(n):
        rotation = mat_mat(rotation, pose(chain[k, 0], chain[k, 1], chain[k, 2])[0])
    m = mat_mat(transpose(base), rotation)
    angle = math.atan2(m[1][0] + m[0][1], m[0][0] - m[1][1])
    cosine, sine = math.cos(angle), math.sin(angle)
    for k in range(n):
        x, y, length = get_vec(chain, n - 1 - k, 0)
        put_vec(q, k, 0, (cosine * x + sine * y, sine * x - cosine * y, length))
