"""A body slides back along itself, to first order: how bodies are drawn out of narrow places.

The ends of segments are to go back along their tangents, each by as much, and each counts by its weight; what that
leaves free changes as is wished. With `T_i` from a twist about the base to the velocity of end i, and `c` the twists of
the coordinates, the normal matrix of these least squares is `c_k' (sum over i >= max(k, l) of w_i^2 T_i' T_i) c_l`. So
sums over the ends, from the tip on, are enough: of the weights, of the places, and of products of these.
"""

import math

from sinuous.kernels.chain.kinematics import forward_with_columns, frame, put_frame
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import (
    NOTHING,
    ZERO,
    Array,
    Mat,
    Vec,
    add,
    add_outer,
    add_scaled,
    cross,
    dot,
    get_vec,
    mat_vec,
    put_vec,
    scale,
    sub,
)
from sinuous.kernels.problem import Robot, read_robot
from sinuous.kernels.step.dense import solve_symmetric
from sinuous.kernels.step.limits import bends_in_plane, move
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, PLANE

DAMPING = 1e-3
"""Of the motion with which a body slides back, as a share of the mean diagonal entry of its normal matrix."""


def sliding_size(segments: int) -> int:
    """Numbers (float64) of the workspace: frames, columns, the system, and the step."""
    n = segments
    return 12 * (n + 1) + 18 * n + 3 * n * (3 * n + 1) + 3 * n


def _combine(columns: Array, k: int, x: float, y: float, z: float) -> tuple[Vec, Vec]:
    """The twist of segment `k` whose three coordinates change by so much."""
    turn = add(scale(x, get_vec(columns, k, 0)), scale(y, get_vec(columns, k, 6)))
    shift = add(scale(x, get_vec(columns, k, 3)), scale(y, get_vec(columns, k, 9)))
    return add_scaled(turn, z, get_vec(columns, k, 12)), add_scaled(shift, z, get_vec(columns, k, 15))


def _scale_columns(limits: Array, columns: Array, unit: float) -> None:
    """Let every column be of 1 rad, or of a mean length of a segment; 0 of what cannot move, or lies off a plane."""
    n = limits.shape[0]
    for k in range(n):
        bend = 1.0 if limits[k, BEND_SCALE] > 0.0 else 0.0
        stretch = unit / n if limits[k, LENGTH_SCALE] > 0.0 else 0.0
        x, y, off = bend, 0.0, bend
        if bends_in_plane(limits, k):
            x, y, off = bend * limits[k, PLANE], bend * limits[k, PLANE + 1], 0.0
        first = _combine(columns, k, x, y, 0.0)
        second = _combine(columns, k, 0.0, off, 0.0)
        third = _combine(columns, k, 0.0, 0.0, stretch)
        put_vec(columns, k, 0, first[0])
        put_vec(columns, k, 3, first[1])
        put_vec(columns, k, 6, second[0])
        put_vec(columns, k, 9, second[1])
        put_vec(columns, k, 12, third[0])
        put_vec(columns, k, 15, third[1])


def _weigh(turn: Vec, shift: Vec, total: float, places: Vec, products: Mat) -> tuple[Vec, Vec]:
    """What the ends seen so far make of a twist: the sum of `w^2 T' T` times it."""
    spread = products[0][0] + products[1][1] + products[2][2]
    inner = sub(scale(spread, turn), mat_vec(products, turn))
    return add(cross(places, shift), inner), add_scaled(cross(turn, places), total, shift)


def _fill_system(frames: Array, columns: Array, weights: Array, by: float, system: Array) -> float:
    """Fill the normal matrix above its diagonal, and its right side; return the trace."""
    n = columns.shape[0]
    origin = frame(frames, 0)[1]
    total, places, products = 0.0, ZERO, NOTHING
    pull_turn, pull_shift = ZERO, ZERO
    trace = 0.0
    for last in range(n - 1, -1, -1):
        rotation, end = frame(frames, last + 1)
        arm, square = sub(end, origin), weights[last] * weights[last]
        total += square
        places = add_scaled(places, square, arm)
        products = add_outer(products, scale(square, arm), arm)
        back = scale(-by * square, (rotation[0][2], rotation[1][2], rotation[2][2]))
        pull_turn, pull_shift = add(pull_turn, cross(arm, back)), add(pull_shift, back)
        for d in range(3):
            turn, shift = get_vec(columns, last, 6 * d), get_vec(columns, last, 6 * d + 3)
            system[3 * last + d, 3 * n] = dot(turn, pull_turn) + dot(shift, pull_shift)
            seen_turn, seen_shift = _weigh(turn, shift, total, places, products)
            for k in range(last + 1):
                for c in range(3 if k < last else d + 1):
                    value = dot(get_vec(columns, k, 6 * c), seen_turn) + dot(get_vec(columns, k, 6 * c + 3), seen_shift)
                    system[3 * k + c, 3 * last + d] = value
            trace += system[3 * last + d, 3 * last + d]
    return trace


def _wish(own: Robot, wished: Array, unit: float, k: int, c: int) -> float:
    """What is wished of a coordinate, in its scale; 0 of what cannot move."""
    limits = own.limits
    if c == 2:
        return wished[k, 2] * limits.shape[0] / unit if limits[k, LENGTH_SCALE] > 0.0 else 0.0
    if not limits[k, BEND_SCALE] > 0.0:
        return 0.0
    if bends_in_plane(limits, k):
        along = wished[k, 0] * limits[k, PLANE] + wished[k, 1] * limits[k, PLANE + 1]
        return along if c == 0 else 0.0
    return float(wished[k, c])


def _unscale(own: Robot, system: Array, unit: float, step: Array) -> None:
    """Fill the step (n, 3) of configurations for the answer in the last column of the system."""
    n = own.limits.shape[0]
    for k in range(n):
        x, y, z = system[3 * k, 3 * n], system[3 * k + 1, 3 * n], system[3 * k + 2, 3 * n]
        if bends_in_plane(own.limits, k):
            x, y = x * own.limits[k, PLANE], x * own.limits[k, PLANE + 1]
        put_vec(step, k, 0, (x, y, z * unit / n))


@entry
def slide_back(
    robot: Array, q: Array, by: float, weights: Array, wished: Array, unit: float, workspace: Array, out: Array
) -> None:
    """Fill `out` (n, 3) with `q` (n, 3), slid back: the ends of segments go back along their tangents by so much.

    To first order, by damped least squares, within the limits of segments; each end counts by its weight (n,). What
    that leaves free changes by `wished` (n, 3). `unit`: the robot's mean length; `workspace`: see `sliding_size`.
    """
    own = read_robot(robot)
    n = q.shape[0]
    a = 12 * (n + 1)
    b = a + 18 * n
    c = b + 3 * n * (3 * n + 1)
    frames, columns = shaped(workspace[:a], (n + 1, 12)), shaped(workspace[a:b], (n, 18))
    system, step = shaped(workspace[b:c], (3 * n, 3 * n + 1)), shaped(workspace[c : c + 3 * n], (n, 3))
    rotation, position = frame(own.base, 0)
    put_frame(frames, 0, rotation, position)
    forward_with_columns(own.limits, q, frames, columns)
    _scale_columns(own.limits, columns, unit)
    damping = DAMPING * _fill_system(frames, columns, weights, by, system) / (3 * n)
    if damping > 0.0 and math.isfinite(damping):
        for k in range(n):
            for d in range(3):
                system[3 * k + d, 3 * k + d] += damping
                system[3 * k + d, 3 * n] += damping * _wish(own, wished, unit, k, d)
        solve_symmetric(system, 3 * n)
        _unscale(own, system, unit, step)
    else:
        step[:, :] = 0.0
    move(own.limits, q, step, out)
