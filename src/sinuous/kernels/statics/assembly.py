"""What is known of every arc in one state: kinematics, its own energy, its weight, and its lines."""

import math

from sinuous.kernels.chain.arc import carry, pose_and_columns
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Mat,
    Vec,
    add,
    cross,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    put_vec,
    scale,
    sub,
    vec_mat,
)
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.lines import add_curved, along, straight
from sinuous.kernels.statics.profile import (
    Profile,
    by_bends,
    by_length,
    center_profile,
    end_profile,
    even_functions,
    place,
    slopes,
)
from sinuous.kernels.tables import POSE_POSITION


def assemble(
    x: Array,
    arcs: Array,
    lines: Array,
    tensions: Array,
    load_factor: float,
    frames: Array,
    stages: Array,
    along_arcs: Array,
) -> None:
    """Fill frames (N + 1, 12) but the base, `stages` but the factors, and `along_arcs` (s, 5).

    A row of `along_arcs` is the length of a line in one arc and its derivatives. `load_factor` of the weights acts.
    """
    rotation, position = frame(frames, 0)
    origin = position
    for k in range(x.shape[0]):
        vx, vy, angle, length = x[k, t.BEND_X], x[k, t.BEND_Y], x[k, t.TORSION], x[k, t.LENGTH]
        even = even_functions(vx * vx + vy * vy)
        _add_elastic_energy(x, arcs, k, stages)
        _add_lines(x, lines, tensions, k, end_profile(even), stages, along_arcs)
        weight = scale(load_factor, get_vec(arcs, k, t.WEIGHT))
        arm = sub(position, origin)
        _add_weight(vx, vy, length, center_profile(even), rotation, arm, weight, k, stages)
        turn, shift, by_x, by_y, stretch = pose_and_columns(vx, vy, length)
        _put_twist(stages, k, t.TWIST_COLUMNS, carry(rotation, arm, by_x[0], by_x[1]))
        _put_twist(stages, k, t.TWIST_COLUMNS + 6, carry(rotation, arm, by_y[0], by_y[1]))
        rotation, position = compose(rotation, position, turn, shift)
        axis = (rotation[0][2], rotation[1][2], rotation[2][2])
        _put_twist(stages, k, t.TWIST_COLUMNS + 12, (axis, cross(sub(position, origin), axis)))
        put_vec(stages, k, t.TWIST_COLUMNS + 18, ZERO)
        put_vec(stages, k, t.TWIST_COLUMNS + 21, mat_vec(frame(frames, k)[0], stretch))
        rotation, position = compose(rotation, position, about_z(angle), ZERO)
        if arcs[k, t.ARC_TAIL] != 0.0:
            tail = get_mat(arcs, k, t.ARC_TAIL + 1), get_vec(arcs, k, t.ARC_TAIL + 1 + POSE_POSITION)
            rotation, position = compose(rotation, position, tail[0], tail[1])
        put_frame(frames, k + 1, rotation, position)


def about_z(angle: float) -> Mat:
    """The rotation about z by an angle, rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return (cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)


def _put_twist(stages: Array, k: int, column: int, twist: tuple[Vec, Vec]) -> None:
    put_vec(stages, k, column, twist[0])
    put_vec(stages, k, column + 3, twist[1])


def _add_elastic_energy(x: Array, arcs: Array, k: int, stages: Array) -> None:
    """Set the derivatives to those of bending, torsion and stretch; what is rigid adds nothing."""
    for i in range(t.CENTER_COLUMNS - t.GRADIENT):
        stages[k, t.GRADIENT + i] = 0.0
    vx, vy, angle = x[k, t.BEND_X], x[k, t.BEND_Y], x[k, t.TORSION]
    bend, torsion, stretch = arcs[k, t.BEND_STIFFNESS], arcs[k, t.TORSION_STIFFNESS], arcs[k, t.STRETCH_STIFFNESS]
    if bend < t.RIGID:
        turn = about_z(0.5 * angle)
        cx, cy, _ = mat_vec(turn, (arcs[k, t.REST_X], arcs[k, t.REST_Y], 0.0))
        _add_even(stages, k, t.BEND_X, bend * (vx - cx), bend)
        _add_even(stages, k, t.BEND_Y, bend * (vy - cy), bend)
        if torsion < t.RIGID:
            _add_even(stages, k, t.TORSION, 0.5 * bend * (vx * cy - vy * cx), 0.25 * bend * (vx * cx + vy * cy))
            _add_mixed(stages, k, t.BEND_X, t.TORSION, 0.5 * bend * cy)
            _add_mixed(stages, k, t.BEND_Y, t.TORSION, -0.5 * bend * cx)
    if torsion < t.RIGID:
        _add_even(stages, k, t.TORSION, torsion * angle, torsion)
    if stretch < t.RIGID:
        _add_even(stages, k, t.LENGTH, stretch * (x[k, t.LENGTH] - arcs[k, t.REST_LENGTH]), stretch)


def _add_even(stages: Array, k: int, i: int, first: float, second: float) -> None:
    stages[k, t.GRADIENT + i] += first
    stages[k, t.HESSIAN + 5 * i] += second


def _add_mixed(stages: Array, k: int, i: int, j: int, value: float) -> None:
    stages[k, t.HESSIAN + 4 * i + j] += value
    stages[k, t.HESSIAN + 4 * j + i] += value


def _add_lines(x: Array, lines: Array, tensions: Array, k: int, end: Profile, stages: Array, along_arcs: Array) -> None:
    """Add the lines that run through arc `k`, with their tensions; fill their rows of `along_arcs` (s, 5)."""
    vx, vy, angle, length = x[k, t.BEND_X], x[k, t.BEND_Y], x[k, t.TORSION], x[k, t.LENGTH]
    for i in range(lines.shape[0]):
        first = int(lines[i, t.FIRST_ARC])
        if first <= k <= lines[i, t.LAST_ARC]:
            hx, hy = lines[i, t.ARM], lines[i, t.ARM + 1]
            if lines[i, t.STRAIGHT] > 0.0:
                own, slope, curved = straight(vx, vy, angle, length, hx, hy, end)
            else:
                own, slope, curved = along(vx, vy, angle, length, hx, hy)
            row = int(lines[i, t.FIRST_SLOPE]) + k - first
            along_arcs[row, 0] = own
            for j in range(4):
                along_arcs[row, 1 + j] = slope[j]
                stages[k, t.GRADIENT + j] += tensions[i] * slope[j]
            add_curved(stages, k, tensions[i], curved)


def _add_weight(
    vx: float, vy: float, length: float, own: Profile, rotation: Mat, arm: Vec, weight: Vec, k: int, stages: Array
) -> None:
    """Add what the weight of arc `k` does to its own state; `rotation` and `arm` are where it begins."""
    local = vec_mat(weight, rotation)
    by_x, by_y, by_l = slopes(vx, vy, length, own)
    put_vec(stages, k, t.ARC_CENTER, add(arm, mat_vec(rotation, place(vx, vy, length, own))))
    put_vec(stages, k, t.CENTER_COLUMNS, mat_vec(rotation, by_x))
    put_vec(stages, k, t.CENTER_COLUMNS + 3, mat_vec(rotation, by_y))
    put_vec(stages, k, t.CENTER_COLUMNS + 6, mat_vec(rotation, by_l))
    xx, xy, yy = by_bends(vx, vy, local, length, own)
    xl, yl = by_length(vx, vy, local, own)
    _add_even(stages, k, t.BEND_X, -dot(local, by_x), -xx)
    _add_even(stages, k, t.BEND_Y, -dot(local, by_y), -yy)
    _add_even(stages, k, t.LENGTH, -dot(local, by_l), 0.0)
    _add_mixed(stages, k, t.BEND_X, t.BEND_Y, -xy)
    _add_mixed(stages, k, t.BEND_X, t.LENGTH, -xl)
    _add_mixed(stages, k, t.BEND_Y, t.LENGTH, -yl)
