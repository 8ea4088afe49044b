"""What can be proved impossible before anything is tried."""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.compile import shared
from sinuous.kernels.fields.distances import Scene, at_most
from sinuous.kernels.maths.vectors import Array, Vec, dot, get_vec, norm, scale, sub
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap, length_range
from sinuous.kernels.step.targets import backbone_end, end_segment, tangent_back

POSSIBLE = -1
"""In place of what proves that it is impossible: nothing does."""

MOUNT_ROUNDING = 1e-9
"""By what share of its mount a body must be longer at least to end beyond it for certain."""


def sine_area(angle: float) -> float:
    """Integral of sin(min(t, pi / 2)) over t from 0 to `angle`."""
    return 1.0 - math.cos(angle) if angle < 0.5 * math.pi else 1.0 + angle - 0.5 * math.pi


def cosine_area(angle: float) -> float:
    """Integral of cos(min(t, pi)) over t from 0 to `angle`."""
    return math.sin(angle) if angle < math.pi else math.pi - angle


def _misses_goal(limits: Array, k: int, place: Vec, axis: Vec, goal: Vec, loose: float, reverse: bool) -> bool:
    """Whether no curve of segments 0 to `k` that leaves `place` along `axis` comes within `loose` of `goal`.

    By the length t of bend its tangent has turned away from the axis by no more than t. So its end is at most the sum
    of `length * mean of sin t` beside the axis, and at least the sum of `length * mean of cos t` ahead. `reverse`: it
    is run through from the end of segment `k` to the base.
    """
    turned = most_beside = least_ahead = 0.0
    for i in range(k + 1):
        j = k - i if reverse else i
        low, high = limits[j, t.MIN_LENGTH], limits[j, t.MAX_LENGTH]
        bend = bend_cap(limits, j, high)
        sine, cosine = math.sin(min(turned, 0.5 * math.pi)), math.cos(min(turned, math.pi))
        if bend > 1e-6:
            sine = (sine_area(turned + bend) - sine_area(turned)) / bend
            cosine = (cosine_area(turned + bend) - cosine_area(turned)) / bend
        most_beside += high * sine
        least_ahead += cosine * (low if cosine > 0.0 else high)
        turned += bend
    away = sub(goal, place)
    ahead = dot(away, axis)
    beside = norm(sub(away, scale(ahead, axis)))
    return beside - loose > most_beside or ahead + loose < least_ahead


def _out_of_reach(problem: Problem, i: int, k: int) -> bool:
    """Too far for the lengths, too near or aside for lengths and bends together, or a direction that bends cannot give.

    A curve of length L that turns by no more than a < pi in all ends at least `L cos(a / 2)` away: seen along the
    tangent in the middle of its turning, no tangent points back by more than a / 2.
    """
    longest = turning = 0.0
    for j in range(k + 1):
        longest += problem.limits[j, t.MAX_LENGTH] + problem.limits[j, t.TAIL_LENGTH]
        turning += bend_cap(problem.limits, j, problem.limits[j, t.MAX_LENGTH])
    rotation, base = frame(problem.base, 0)
    axis = (rotation[0][2], rotation[1][2], rotation[2][2])
    asked = problem.targets[i, t.ORIENTATION]
    slack = 1e-9 * (problem.unit + longest)
    tilt = 0.0  # of the tool's z axis against the tangent, which adds to what the bends can turn
    if k == problem.limits.shape[0] - 1:
        offset, _ = frame(problem.tool, 0)
        tilt = math.atan2(math.hypot(offset[0][2], offset[1][2]), offset[2][2])
    if problem.targets[i, t.HAS_POSITION] != 0.0:
        place, loose = backbone_end(problem, i, k)
        far = norm(sub(place, base))
        loose += problem.position_tolerance + slack
        if far - loose > longest:
            return True
        # What is said of curves holds for none that begins with a joint.
        if problem.limits[0, t.RIGID] == 0.0 and _no_curve(problem, i, k, (place, base, axis), loose, tilt, turning):
            return True
    if asked == t.DIRECTION and turning < math.pi and problem.limits[0, t.RIGID] == 0.0:
        needed = math.acos(max(-1.0, min(1.0, dot(axis, get_vec(problem.targets, i, t.GOAL)))))
        return bool(needed > turning + tilt + problem.angle_tolerance + 1e-7)
    return False


def _no_curve(
    problem: Problem, i: int, k: int, places: tuple[Vec, Vec, Vec], loose: float, tilt: float, turning: float
) -> bool:
    """Whether no curve of segments 0 to `k` leads from the base to a place within `loose` of it, as target `i` asks.

    `places`: where to, and the base with its tangent; `tilt` (rad): of the tool; `turning` (rad): of all segments.
    """
    place, base, axis = places
    shortest, _ = length_range(problem.limits[: k + 1])
    far = norm(sub(place, base))
    if turning < math.pi and far + loose < shortest * math.cos(0.5 * turning):
        return True
    if _misses_goal(problem.limits, k, base, axis, place, loose, False):
        return True
    if problem.targets[i, t.ORIENTATION] == t.FREE:
        return False
    # The curve is moved by what the place may be off, and turned about it by what the tangent may.
    swing = loose + min(2.0, problem.angle_tolerance + tilt) * (far + loose)
    return _misses_goal(problem.limits, k, place, tangent_back(problem.targets, i), base, swing, True)


def _target_blocked(scene: Scene | None, problem: Problem, i: int, k: int) -> bool:
    if scene is None:
        return False
    if scene.table.shape[0] == 0 or problem.targets[i, t.HAS_POSITION] == 0.0:
        return False
    shortest = 0.0
    for j in range(k + 1):
        if problem.limits[j, t.RIGID] == 0.0:
            shortest += problem.limits[j, t.MIN_LENGTH]
    if shortest <= (1.0 + MOUNT_ROUNDING) * problem.mount:
        return False
    place, loose = backbone_end(problem, i, k)
    loose += problem.position_tolerance
    return bool(at_most(scene, place) + loose < problem.limits[k, t.RADIUS] - 1e-9 * problem.unit)


@shared
def verdict_of(problem: Problem) -> int:
    """POSSIBLE as far as is known, or what proves the contrary."""
    for i in range(problem.targets.shape[0]):
        k = end_segment(problem.targets, i, problem.limits.shape[0])
        if _out_of_reach(problem, i, k):
            return t.OUT_OF_REACH
        if _target_blocked(problem.scene, problem, i, k):
            return t.TARGET_BLOCKED
    return POSSIBLE
