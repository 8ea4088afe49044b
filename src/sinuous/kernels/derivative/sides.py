"""The right sides of the rows: what a unit of each parameter asks of them.

A row keeps what it has: for a target the residual, for an active limit or contact its slack. So its right side is less
the derivative of that by the parameter. World axes; a twist is `(omega, v)`.

`asked` (14,) int64 is that of `layout`.
"""

from sinuous.kernels import tables as t
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.derivative import layout as d
from sinuous.kernels.derivative.layout import Workspace
from sinuous.kernels.fields.distances import Scene
from sinuous.kernels.maths.vectors import Array, Vec, cross, dot, get_vec, put_vec, scale, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bends_in_plane, possible_bend
from sinuous.kernels.step.targets import end_segment
from sinuous.kernels.velocity.layout import (
    ACTUATOR_LIMIT,
    BEND_LIMIT,
    CLEARANCE_LIMIT,
    CURVATURE_LIMIT,
    LENGTH_LIMIT,
    SELF_CLEARANCE_LIMIT,
)

THICK = 1e-6
"""By what share the largest curvature may be below 1 / radius where the thickness of the body limits it."""

CIRCLE, RADIUS_OF, ACTUATOR_NUMBER = range(3)
"""Columns of `lines`, a row an actuator limit: number of the circle that its line is on (-1: none), the radius of that
circle (length), and the number of the actuator."""


def place_of(scene: Scene, i: int) -> Vec:
    """The place that an obstacle turns about: its center, or the origin of the frame that it is described in."""
    kind = scene.table[i, t.KIND]
    if kind not in (t.TREE, t.SAMPLES):
        return get_vec(scene.table, i, t.CENTER)
    if scene.table[i, t.PLACED] != 0.0:
        return get_vec(scene.table, i, t.PLACE + t.POSE_POSITION)
    return 0.0, 0.0, 0.0


def fill_sides(problem: Problem, asked: Array, lines: Array, work: Workspace, count: int) -> None:
    """Fill `work.sides` for the first `count` rows."""
    sides, about = work.sides[:count], work.about
    sides[:] = 0.0
    for at in range(count):
        wrench = (get_vec(about, at, d.ROW_WRENCH), get_vec(about, at, d.ROW_WRENCH + 3))
        if asked[d.BASE] >= 0:
            put_vec(sides, at, asked[d.BASE], scale(-1.0, wrench[0]))
            put_vec(sides, at, asked[d.BASE] + 3, scale(-1.0, wrench[1]))
        if about[at, d.ROW_KIND] == d.TARGET_ROW:
            _of_target(problem, asked, work, at, wrench)
        else:
            _of_constraint(problem, asked, lines, work, at, wrench)
        for c in range(sides.shape[1]):
            sides[at, c] *= about[at, d.ROW_FACTOR]


def move_directly(problem: Problem, asked: Array, moved: Array) -> None:
    """Fill `moved` (3 n, p) with what parameters move by themselves.

    The length of a segment that cannot stretch moves that segment, and where a search begins moves everything.
    """
    moved[:] = 0.0
    for k in range(problem.limits.shape[0]):
        if asked[d.LENGTHS] >= 0 and problem.limits[k, t.LENGTH_SCALE] == 0.0:
            moved[3 * k + 2, asked[d.LENGTHS] + k] = 1.0
        if asked[d.INITIAL] >= 0:
            for i in range(3):
                if i < 2 or problem.limits[k, t.LENGTH_SCALE] > 0.0:
                    moved[3 * k + i, asked[d.INITIAL] + 3 * k + i] = 1.0
            if bends_in_plane(problem.limits, k):
                for i in range(2):
                    own = possible_bend(problem.limits, k, 1.0 - i, float(i))
                    moved[3 * k, asked[d.INITIAL] + 3 * k + i] = own[0]
                    moved[3 * k + 1, asked[d.INITIAL] + 3 * k + i] = own[1]


def _of_target(problem: Problem, asked: Array, work: Workspace, at: int, wrench: tuple[Vec, Vec]) -> None:
    sides, targets, i = work.sides, problem.targets, int(work.about[at, d.ROW_OTHER])
    torque, force = wrench
    placed = dot(force, force) > 0.0
    if asked[d.TARGET] >= 0:
        if placed:
            put_vec(sides, at, asked[d.TARGET] + d.TARGET_COLUMNS * i, force)
        else:
            put_vec(sides, at, asked[d.TARGET] + d.TARGET_COLUMNS * i + 3, torque)
    n = work.q.shape[0]
    if asked[d.TOOL] >= 0 and end_segment(targets, i, n) == n - 1:
        rotation = frame(work.frames, n)[0]
        if placed:
            put_vec(sides, at, asked[d.TOOL] + 3, scale(-1.0, vec_mat(force, rotation)))
        else:
            put_vec(sides, at, asked[d.TOOL], scale(-1.0, vec_mat(torque, rotation)))


def _of_constraint(
    problem: Problem, asked: Array, lines: Array, work: Workspace, at: int, wrench: tuple[Vec, Vec]
) -> None:
    sides, about, limits = work.sides, work.about, problem.limits
    kind, k, other = int(about[at, d.ROW_KIND]), int(about[at, d.ROW_SEGMENT]), int(about[at, d.ROW_OTHER])
    upper = about[at, d.ROW_SIDE] == 1.0
    if asked[d.LENGTHS] >= 0 and kind == LENGTH_LIMIT:
        sides[at, asked[d.LENGTHS] + k] = -1.0 if upper else 1.0
    if asked[d.BENDS] >= 0 and kind == BEND_LIMIT:
        sides[at, asked[d.BENDS] + k] = -1.0
    if kind == CURVATURE_LIMIT:
        thick = problem.avoids_itself and limits[k, t.MAX_CURVATURE] * limits[k, t.SELF_RADIUS] >= 1.0 - THICK
        if asked[d.CURVATURES] >= 0 and not thick:
            sides[at, asked[d.CURVATURES] + k] = -work.q[k, 2]
        if asked[d.RADII] >= 0 and thick:
            sides[at, asked[d.RADII] + k] = work.q[k, 2] * limits[k, t.MAX_CURVATURE] ** 2
    if asked[d.RADII] >= 0 and kind in (CLEARANCE_LIMIT, SELF_CLEARANCE_LIMIT):
        sides[at, asked[d.RADII] + k] += 1.0
        if kind == SELF_CLEARANCE_LIMIT:
            sides[at, asked[d.RADII] + other] += 1.0
    if kind == ACTUATOR_LIMIT:
        _of_actuator(problem, asked, lines, work, at, other, upper)
    if kind == CLEARANCE_LIMIT and asked[d.OBSTACLES] >= 0:
        torque, force = wrench
        first = asked[d.OBSTACLES] + 6 * other
        arm = sub(place_of(problem.scene, other), frame(work.frames, 0)[1])
        put_vec(sides, at, first, sub(torque, cross(arm, force)))
        put_vec(sides, at, first + 3, force)


def _of_actuator(problem: Problem, asked: Array, lines: Array, work: Workspace, at: int, j: int, upper: bool) -> None:
    """The same of limit `j` of an actuator."""
    if asked[d.ACTUATORS] >= 0:
        work.sides[at, asked[d.ACTUATORS] + 2 * int(lines[j, ACTUATOR_NUMBER]) + (1 if upper else 0)] = (
            -1.0 if upper else 1.0
        )
    if asked[d.TENDONS] >= 0 and lines[j, CIRCLE] >= 0.0:
        table = problem.actuation
        grown = 0.0
        for k in range(int(table[j, t.FIRST_SEGMENT]), int(table[j, t.LAST_SEGMENT]) + 1):
            grown += table[j, t.WEIGHTS] * work.q[k, 0] + table[j, t.WEIGHTS + 1] * work.q[k, 1]
        grown /= lines[j, RADIUS_OF]
        work.sides[at, asked[d.TENDONS] + int(lines[j, CIRCLE])] = grown if upper else -grown
