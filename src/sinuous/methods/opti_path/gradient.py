"""The update of the points of a path: attenuated gradients of the costs, by differences or by one sweep backwards.

The update of point i sums `alpha^k dF_j / dp_i` over the arcs j from i on (see `costs` for F_j), where k is j - i in
the paper, or what is here called adjacent: max(0, j - i - 1), so that both arcs that meet in the point count in full.
"""

from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import price
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, add_scaled, get_vec, put_vec, scale, sub
from sinuous.methods.opti_path.bezier import arc_between, end_tangent, pull_tangent
from sinuous.methods.opti_path.costs import (
    LITERAL,
    Setting,
    Weights,
    body_cost,
    body_pull,
    in_the_open,
    shape_cost,
    shape_pull,
    speed,
)
from sinuous.methods.opti_path.path import Aim, Path, get_arc
from sinuous.methods.opti_path.potential import Potential, potential_at


@kernel
def attenuated(setting: Setting) -> tuple[float, float, float]:
    """Weights of the arc after a point, of what later arcs do to its end before that arc, and after it."""
    alpha = setting.attenuation
    if setting.exponent == LITERAL:
        return alpha, alpha, alpha * alpha
    return 1.0, 1.0, alpha


@kernel
def _collect(out: Array, k: int, own: Vec, place: Vec, turned: Vec, factors: tuple[float, float, float]) -> None:
    """Add what pulls the chord of arc `k`, also through its end tangent, to its two points in `out` (n + 1, 3)."""
    next_own, before, after = factors
    put_vec(out, k + 1, 0, add(get_vec(out, k + 1, 0), add_scaled(own, before, turned)))
    start = add_scaled(scale(next_own, sub(place, own)), -after, turned)
    put_vec(out, k, 0, add(get_vec(out, k, 0), start))


@kernel
def arc_price(potential: Potential, setting: Setting, obstacles: bool) -> int:
    """Looks that the costs of an arc cost, see `kernels.clock`."""
    return SEGMENT_LOOKS + (int(setting.samples) * price(potential.scene) if obstacles else 0)


@kernel
def gradient_backwards(
    potential: Potential, setting: Setting, weights: Weights, aim: Aim, path: Path, obstacles: bool, clock: Array
) -> None:
    """Fill `update` and `avoid` in one sweep from the last arc to the first, or till the time of the clock is over.

    The sweep is exact, and linear in the number of arcs.

    The attenuated sums are as easy as the true gradient: what later arcs pull at a tangent is multiplied by alpha
    once for each arc that it is carried back over.
    """
    n = path.arcs.shape[0]
    factors = attenuated(setting)
    for k in range(n + 1):
        put_vec(path.update, k, 0, ZERO)
        put_vec(path.avoid, k, 0, ZERO)
    later = later_avoid = ZERO
    looks = arc_price(potential, setting, obstacles)
    for k in range(n - 1, -1, -1):
        if spend(clock, looks):
            break
        arc = get_arc(path.arcs, k)
        own, on_tangent = shape_pull(setting, weights, aim, path, k, arc)
        turned, carried = pull_tangent(arc, later)
        _collect(path.update, k, own, ZERO, turned, factors)
        later = add_scaled(on_tangent, setting.attenuation, carried)
        if obstacles:
            a = get_vec(path.points, k, 0)
            place, own, on_tangent = body_pull(potential, setting, weights, path, k, a, arc)
            turned, carried = pull_tangent(arc, later_avoid)
            _collect(path.avoid, k, own, place, turned, factors)
            later_avoid = add_scaled(on_tangent, setting.attenuation, carried)
            if k > 0 and in_the_open(path, k, arc.length, 0.0):
                force = scale(weights.obstacles * speed(path, k), potential_at(potential, a)[1])
                put_vec(path.avoid, k, 0, add(get_vec(path.avoid, k, 0), force))


@kernel
def _costs_from(
    potential: Potential,
    setting: Setting,
    weights: Weights,
    aim: Aim,
    path: Path,
    obstacles: bool,
    moved: tuple[int, Vec],
) -> tuple[float, float]:
    """Attenuated costs, without and of the obstacles, of what follows when one point is `moved`: its number, where."""
    i, place = moved
    t = get_vec(path.tangents, i - 1, 0)
    factor, alpha = 1.0, setting.attenuation
    shape = body = 0.0
    for k in range(i - 1, path.arcs.shape[0]):
        a = place if k == i else get_vec(path.points, k, 0)
        b = place if k == i - 1 else get_vec(path.points, k + 1, 0)
        if k >= i and (setting.exponent == LITERAL or k > i):
            factor *= alpha
        arc = arc_between(a, b, t)
        t = end_tangent(arc)
        shape += factor * shape_cost(setting, weights, aim, path, k, arc)
        if obstacles:
            body += factor * body_cost(potential, setting, weights, path, k, a, arc)
    if obstacles and in_the_open(path, i, 1.0, 0.0):
        body += weights.obstacles * speed(path, i) * potential_at(potential, place)[0]
    return shape, body


@kernel
def gradient_by_differences(
    potential: Potential, setting: Setting, weights: Weights, aim: Aim, path: Path, obstacles: bool, clock: Array
) -> None:
    """Fill `update` and `avoid` by central differences: every coordinate of every point, both ways, all later arcs.

    It ends when the time of the clock is over.
    """
    step = setting.disturbance * aim.unit
    looks = 2 * arc_price(potential, setting, obstacles)
    for i in range(1, path.arcs.shape[0]):
        p = get_vec(path.points, i, 0)
        for c in range(3):
            if spend(clock, looks * (path.arcs.shape[0] - i + 1)):
                return
            shift = (step if c == 0 else 0.0, step if c == 1 else 0.0, step if c == 2 else 0.0)
            more = _costs_from(potential, setting, weights, aim, path, obstacles, (i, add(p, shift)))
            less = _costs_from(potential, setting, weights, aim, path, obstacles, (i, sub(p, shift)))
            path.update[i, c] = 0.5 * (more[0] - less[0]) / step
            path.avoid[i, c] = 0.5 * (more[1] - less[1]) / step
