"""The clearance of one segment, sampled in a few places: what heuristics steer by. It proves nothing."""

import math

from sinuous.kernels.chain.arc import point
from sinuous.kernels.fields.distances import nearest
from sinuous.kernels.maths.vectors import ZERO, Mat, Vec, add, mat_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import RADIUS


def sampled_clearance(
    problem: Problem, rotation: Mat, position: Vec, q: Vec, k: int, travel: float, places: int
) -> tuple[float, int, Vec]:
    """Least clearance of segment `k`, laid on from this frame, over so many places, its end among them.

    `travel` is the length of backbone before it. Returns the obstacle (-1: none) and the place, too. Places that are
    sure to be clear, because one before is far enough from everything, are passed over.
    """
    least, which, where = math.inf, -1, ZERO
    inside = 0.0
    if problem.mount > travel:
        inside = (problem.mount - travel) / q[2] if problem.mount < travel + q[2] else 1.0
    j = 1
    while inside < 1.0 and j <= places:
        s = inside + (1.0 - inside) * j / places
        place = add(position, mat_vec(rotation, point(s * q[0], s * q[1], s * q[2])))
        distance, i = nearest(problem.scene, place)
        clearance = distance - problem.limits[k, RADIUS]
        if clearance < least:
            least, which, where = clearance, i, place
        apart = (1.0 - inside) * q[2] / places
        if clearance >= places * apart:
            break
        j += int(clearance / apart) if clearance > apart else 1
    return least, which, where
