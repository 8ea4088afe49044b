"""The steps of `opti_path`: schedules of the weights, projection, metric, and the way that points are moved."""

import math

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import ZERO, Array, add, add_scaled, dot, get_vec, norm, put_vec, scale, sub
from sinuous.methods.opti_path.costs import Setting, Weights
from sinuous.methods.opti_path.path import Path

CONSTANT, LENGTH, ORIENTATION, COOLING, GATED = 0.0, 1.0, 2.0, 3.0, 4.0
IDENTITY, DIFFERENCE, ACCELERATION = 0.0, 1.0, 2.0

LEAST = 0.1
"""What is left of a weight when its schedule has taken it down."""


@kernel
def scheduled(setting: Setting, iteration: int, long: bool, turned: bool) -> Weights:
    """The weights of this iteration; `long` and `turned` say whether lengths and orientation are still off.

    With the temperature T = cooling ^ iteration: constant; length up from 0.1 to 1 and orientation down as T falls;
    the other way round; all down; or gated, where what is met already counts nothing.
    """
    length, orientation, all_of_them = 1.0, 1.0, 1.0
    warm = LEAST + (1.0 - LEAST) * setting.cooling**iteration
    cold = 1.0 + LEAST - warm
    if setting.schedule == LENGTH:
        length, orientation = cold, warm
    elif setting.schedule == ORIENTATION:
        length, orientation = warm, cold
    elif setting.schedule == COOLING:
        all_of_them = warm
    elif setting.schedule == GATED:
        length, orientation = 1.0 if long else 0.0, 1.0 if turned else 0.0
    return Weights(
        all_of_them * length * setting.length_weight,
        all_of_them * orientation * setting.orientation_weight,
        all_of_them * setting.obstacle_weight,
        all_of_them * setting.bend_weight,
    )


@kernel
def project(path: Path) -> None:
    """Take out of the update of every point for obstacles what is along the line through its two neighbours."""
    for i in range(1, path.arcs.shape[0]):
        along = sub(get_vec(path.points, i + 1, 0), get_vec(path.points, i - 1, 0))
        square = dot(along, along)
        if square > 0.0:
            force = get_vec(path.avoid, i, 0)
            put_vec(path.avoid, i, 0, add_scaled(force, -dot(force, along) / square, along))


@kernel
def solve_difference(x: Array) -> None:
    """Solve `K y = x` in place, for rows 1 to n - 1 of `x` (n + 1, 3), K = tridiag(-1, 2, -1): both ends are fixed.

    Elimination without tables: its pivots are (i + 1) / i.
    """
    last = x.shape[0] - 2
    before = ZERO
    for i in range(1, last + 1):
        before = scale(i / (i + 1.0), add(get_vec(x, i, 0), before))
        put_vec(x, i, 0, before)
    for i in range(last - 1, 0, -1):
        before = add_scaled(get_vec(x, i, 0), i / (i + 1.0), before)
        put_vec(x, i, 0, before)


@kernel
def move(setting: Setting, path: Path, unit: float) -> float:
    """Move all inner points by `-A^-1 gradient / lambda`, none by more than the largest step; how far the most moved.

    A is the identity, K (differences of neighbours), or K'K: changes of acceleration.
    """
    n = path.arcs.shape[0]
    for i in range(1, n):
        put_vec(path.update, i, 0, add(get_vec(path.update, i, 0), get_vec(path.avoid, i, 0)))
    if setting.metric >= DIFFERENCE:
        solve_difference(path.update)
    if setting.metric == ACCELERATION:
        solve_difference(path.update)
    far = 0.0
    for i in range(1, n):
        far = max(far, norm(get_vec(path.update, i, 0)))
    far /= setting.regularisation
    share = 1.0 / setting.regularisation
    most = setting.largest_step * unit
    if most > 0.0 and far > most:
        share *= most / far
    if not math.isfinite(far):
        return far
    for i in range(1, n):
        put_vec(path.points, i, 0, add_scaled(get_vec(path.points, i, 0), -share, get_vec(path.update, i, 0)))
    return far
