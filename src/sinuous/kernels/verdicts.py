"""What can be proved impossible before anything is tried."""

import math

from sinuous.kernels.chain import frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.distances import at_most
from sinuous.kernels.limits import HIGH, LOW, RADIUS, bend_cap
from sinuous.kernels.states import Problem
from sinuous.kernels.targets import DIRECTION, GOAL, HAS_POSITION, ORIENTATION, POSITION, ROTATION, end_segment
from sinuous.kernels.vectors import Vec, dot, get_vec, mat_vec, norm, sub, transpose

POSSIBLE, OUT_OF_REACH, TARGET_BLOCKED = -1, 4, 5


@kernel
def _backbone_end(problem: Problem, i: int, k: int) -> tuple[Vec, float]:
    """Where target `i` puts the end of its segment, and how far it may be from there because the tool can turn."""
    place = get_vec(problem.targets, i, POSITION)
    if k < problem.limits.shape[0] - 1:
        return place, 0.0
    offset, shift = frame(problem.tool, 0)
    if norm(shift) == 0.0:
        return place, 0.0
    if problem.targets[i, ORIENTATION] != ROTATION:
        return place, norm(shift)
    row = problem.targets
    goal = (get_vec(row, i, GOAL), get_vec(row, i, GOAL + 3), get_vec(row, i, GOAL + 6))
    turned = mat_vec(goal, mat_vec(transpose(offset), shift))
    return sub(place, turned), min(2.0, problem.angle_tolerance) * norm(shift)


@kernel
def _out_of_reach(problem: Problem, i: int, k: int) -> bool:
    """Too far for the lengths, too near for lengths and bends together, or pointing where the bends cannot turn to.

    A curve of length L that turns by no more than a < pi in all ends at least `L cos(a / 2)` away: seen along the
    tangent in the middle of its turning, no tangent points back by more than a / 2.
    """
    longest = shortest = turning = 0.0
    for j in range(k + 1):
        longest += problem.limits[j, HIGH]
        shortest += problem.limits[j, LOW]
        turning += bend_cap(problem.limits, j, problem.limits[j, HIGH])
    rotation, base = frame(problem.base, 0)
    slack = 1e-9 * (problem.unit + longest)
    if problem.targets[i, HAS_POSITION] != 0.0:
        place, loose = _backbone_end(problem, i, k)
        far = norm(sub(place, base))
        loose += problem.position_tolerance + slack
        if far - loose > longest:
            return True
        if turning < math.pi and far + loose < shortest * math.cos(0.5 * turning):
            return True
    if problem.targets[i, ORIENTATION] == DIRECTION and turning < math.pi:
        # The tool's z axis is away from the tangent by a fixed angle, which adds to what the bends can turn.
        axis = (rotation[0][2], rotation[1][2], rotation[2][2])
        off = 0.0
        if k == problem.limits.shape[0] - 1:
            offset, _ = frame(problem.tool, 0)
            off = math.acos(max(-1.0, min(1.0, offset[2][2])))
        needed = math.acos(max(-1.0, min(1.0, dot(axis, get_vec(problem.targets, i, GOAL)))))
        return bool(needed > turning + off + problem.angle_tolerance + 1e-7)
    return False


@kernel
def _target_blocked(problem: Problem, i: int, k: int) -> bool:
    if problem.scene.table.shape[0] == 0 or problem.targets[i, HAS_POSITION] == 0.0:
        return False
    shortest = 0.0
    for j in range(k + 1):
        shortest += problem.limits[j, LOW]
    if shortest <= problem.mount:
        return False
    place, loose = _backbone_end(problem, i, k)
    return bool(
        at_most(problem.scene, place) + loose + problem.position_tolerance
        < problem.limits[k, RADIUS] - 1e-9 * problem.unit
    )


@kernel
def verdict_of(problem: Problem) -> int:
    """POSSIBLE as far as is known, or what proves the contrary."""
    for i in range(problem.targets.shape[0]):
        k = end_segment(problem.targets, i, problem.limits.shape[0])
        if _out_of_reach(problem, i, k):
            return OUT_OF_REACH
        if _target_blocked(problem, i, k):
            return TARGET_BLOCKED
    return POSSIBLE
