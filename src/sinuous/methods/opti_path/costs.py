"""What `opti_path` minimises over the points of a path, and its gradient: by differences, or by one sweep backwards.

Arc j = 1 .. n leads from point j - 1 to point j and costs

    F_j = w_length (l_j - l_0)^2 + w_obstacles beta (l_j / S) sum_s c(y_j(u_s)) + w_bends l_0^2 (bend beyond its cap)^2

and, the last one, w_orientation l_0^2 |t_n - t*|^2 (or without the square). All have the unit of a squared length. The
update of point i sums `alpha^k dF_j / dp_i` over the arcs from i on, where k is j - i in the paper, or what is here
called adjacent: max(0, j - i - 1), so that both arcs that meet in the point count in full. Points themselves cost
`w_obstacles v_i c(p_i)`, where v_i, the mean length of their two arcs, is held fixed.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, add_scaled, dot, get_vec, norm, put_vec, scale, sub
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH
from sinuous.methods.opti_path.bezier import (
    Arc,
    arc_between,
    end_tangent,
    offset,
    pull_length,
    pull_point,
    pull_tangent,
    pull_weight,
)
from sinuous.methods.opti_path.potential import Potential, potential_at

Setting = namedtuple(
    "Setting",
    [
        "gradient",
        "disturbance",
        "attenuation",
        "exponent",
        "orientation",
        "length_weight",
        "orientation_weight",
        "obstacle_weight",
        "schedule",
        "cooling",
        "metric",
        "regularisation",
        "largest_step",
        "slope",
        "influence",
        "arcs_weight",
        "samples",
        "project",
        "potential",
        "spacing",
        "iterations",
        "blend",
        "dead_band",
        "bend_weight",
        "bow",
        "other_guess",
        "restarts",
        "settle",
    ],
)
"""The options of the method, in the order of its class, as numbers."""

ADJOINT, DIFFERENCES = 0.0, 1.0
ADJACENT, LITERAL = 0.0, 1.0
SQUARED, NORM = 0.0, 1.0

Weights = namedtuple("Weights", ["length", "orientation", "obstacles", "bends"])
"""The weights of one iteration."""

Aim = namedtuple("Aim", ["position", "direction", "directed", "unit"])
"""The target: where the last point is, the tangent there if one is asked for, and the mean length of a segment."""

Path = namedtuple("Path", ["points", "kept", "tangents", "arcs", "update", "avoid", "wanted"])
"""A path: points (n + 1, 3), the best ones so far, tangents (n + 1, 3), arcs (n, 15), the gradient (n + 1, 3) without
and of the obstacles, and for every arc (n, 4) the lengths that cost nothing, the cap of its bend, and its body's part
that is in the mount."""


@kernel
def want(limits: Array, band: float, mount: float, path: Path) -> None:
    """Fill what every arc wants: its mean length or, with a dead band, any in that share of the range about it."""
    for k in range(limits.shape[0]):
        low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
        inset = 0.5 * (1.0 - band)
        path.wanted[k, 0], path.wanted[k, 1] = low + inset * (high - low), high - inset * (high - low)
        path.wanted[k, 2] = bend_cap(limits, k, 0.5 * (low + high))
        path.wanted[k, 3] = mount
        mount = max(0.0, mount - 0.5 * (low + high))


@kernel
def put_arc(arcs: Array, k: int, arc: Arc) -> None:
    put_vec(arcs, k, 0, arc.t)
    put_vec(arcs, k, 3, arc.d)
    put_vec(arcs, k, 6, arc.e)
    arcs[k, 9], arcs[k, 10], arcs[k, 11] = arc.chord, arc.w, arc.x
    arcs[k, 12], arcs[k, 13], arcs[k, 14] = arc.g, arc.q, arc.length


@kernel
def get_arc(arcs: Array, k: int) -> Arc:
    return Arc(
        get_vec(arcs, k, 0),
        get_vec(arcs, k, 3),
        get_vec(arcs, k, 6),
        arcs[k, 9],
        arcs[k, 10],
        arcs[k, 11],
        arcs[k, 12],
        arcs[k, 13],
        arcs[k, 14],
    )


@kernel
def trace(path: Path) -> None:
    """Fill arcs and tangents from the points and the first tangent."""
    t = get_vec(path.tangents, 0, 0)
    for k in range(path.arcs.shape[0]):
        arc = arc_between(get_vec(path.points, k, 0), get_vec(path.points, k + 1, 0), t)
        t = end_tangent(arc)
        put_arc(path.arcs, k, arc)
        put_vec(path.tangents, k + 1, 0, t)


@kernel
def beyond(value: float, low: float, high: float) -> float:
    """By how much a value is above (positive) or below (negative) a range."""
    return value - high if value > high else min(0.0, value - low)


@kernel
def turn_cost(setting: Setting, weights: Weights, aim: Aim, t: Vec) -> tuple[float, Vec]:
    """Cost of the last tangent and its gradient."""
    scaled = weights.orientation * aim.unit * aim.unit
    miss = sub(t, aim.direction)
    if setting.orientation == SQUARED:
        return scaled * dot(miss, miss), scale(2.0 * scaled, miss)
    far = norm(miss)
    return scaled * far, scale(scaled / far, miss) if far > 0.0 else ZERO


@kernel
def shape_cost(setting: Setting, weights: Weights, aim: Aim, path: Path, k: int, arc: Arc) -> float:
    """Cost of an arc apart from obstacles."""
    miss = beyond(arc.length, path.wanted[k, 0], path.wanted[k, 1])
    over = max(0.0, 2.0 * arc.x - path.wanted[k, 2])
    cost = weights.length * miss * miss + weights.bends * aim.unit * aim.unit * over * over
    if aim.directed and k == path.arcs.shape[0] - 1:
        cost += turn_cost(setting, weights, aim, end_tangent(arc))[0]
    return cost


@kernel
def shape_pull(setting: Setting, weights: Weights, aim: Aim, path: Path, k: int, arc: Arc) -> tuple[Vec, Vec]:
    """Gradient of `shape_cost` in the chord and in the first tangent of the arc."""
    miss = beyond(arc.length, path.wanted[k, 0], path.wanted[k, 1])
    on_chord, on_tangent = pull_length(arc, 2.0 * weights.length * miss)
    over = 2.0 * arc.x - path.wanted[k, 2]
    if over > 0.0 and weights.bends > 0.0:
        force = -4.0 * weights.bends * aim.unit * aim.unit * over / max(math.sin(arc.x), 1e-3)
        more = pull_weight(arc, force)
        on_chord, on_tangent = add(on_chord, more[0]), add(on_tangent, more[1])
    if aim.directed and k == path.arcs.shape[0] - 1:
        more = pull_tangent(arc, turn_cost(setting, weights, aim, end_tangent(arc))[1])
        on_chord, on_tangent = add(on_chord, more[0]), add(on_tangent, more[1])
    return on_chord, on_tangent


@kernel
def _free(path: Path, k: int, length: float, u: float) -> bool:
    """Whether the place `u` of arc `k` is outside the mount."""
    return u * length >= path.wanted[k, 3]


@kernel
def body_cost(
    scene: Scene, potential: Potential, setting: Setting, weights: Weights, path: Path, k: int, a: Vec, arc: Arc
) -> float:
    """Cost of the obstacles near an arc that begins at `a`."""
    count = int(setting.samples)
    total = 0.0
    for s in range(count):
        u = (s + 1.0) / (count + 1.0)
        if _free(path, k, arc.length, u):
            total += potential_at(scene, potential, add(a, offset(arc, u)))[0]
    return weights.obstacles * setting.arcs_weight * arc.length * total / count if count > 0 else 0.0


@kernel
def body_pull(
    scene: Scene, potential: Potential, setting: Setting, weights: Weights, path: Path, k: int, a: Vec, arc: Arc
) -> tuple[Vec, Vec, Vec]:
    """Gradient of `body_cost` in the beginning, the chord and the first tangent of the arc."""
    count = int(setting.samples)
    on_place = on_chord = on_tangent = ZERO
    total = 0.0
    for s in range(count):
        u = (s + 1.0) / (count + 1.0)
        if _free(path, k, arc.length, u):
            r = offset(arc, u)
            c, force = potential_at(scene, potential, add(a, r))
            if c > 0.0:
                total += c
                more = pull_point(arc, u, r, force)
                on_place = add(on_place, force)
                on_chord, on_tangent = add(on_chord, more[0]), add(on_tangent, more[1])
    if total == 0.0:
        return ZERO, ZERO, ZERO
    share = weights.obstacles * setting.arcs_weight / count
    more = pull_length(arc, share * total)
    share *= arc.length
    return (
        scale(share, on_place),
        add_scaled(more[0], share, on_chord),
        add_scaled(more[1], share, on_tangent),
    )


@kernel
def speed(path: Path, i: int) -> float:
    """The 'velocity' of point `i`: the mean length of its two arcs."""
    return 0.5 * (path.arcs[i - 1, 14] + path.arcs[i, 14])


@kernel
def attenuated(setting: Setting) -> tuple[float, float, float]:
    """Weights of the arc after a point, of what later arcs do to its end before that arc, and after it."""
    alpha = setting.attenuation
    if setting.exponent == LITERAL:
        return alpha, alpha, alpha * alpha
    return 1.0, 1.0, alpha


@kernel
def _collect(out: Array, k: int, own: Vec, place: Vec, turned: Vec, factors: tuple[float, float, float]) -> None:
    """Give what pulls the chord of arc `k`, itself and through its end tangent, to its two points."""
    next_own, before, after = factors
    put_vec(out, k + 1, 0, add(get_vec(out, k + 1, 0), add_scaled(own, before, turned)))
    start = add_scaled(scale(next_own, sub(place, own)), -after, turned)
    put_vec(out, k, 0, add(get_vec(out, k, 0), start))


@kernel
def gradient_backwards(
    scene: Scene, potential: Potential, setting: Setting, weights: Weights, aim: Aim, path: Path, obstacles: bool
) -> None:
    """Fill `update` and `avoid` in one sweep from the last arc to the first: exact, and linear in their number.

    The attenuated sums are as easy as the true gradient: what later arcs pull at a tangent is multiplied by alpha
    once for each arc that it is carried back over.
    """
    n = path.arcs.shape[0]
    factors = attenuated(setting)
    for k in range(n + 1):
        put_vec(path.update, k, 0, ZERO)
        put_vec(path.avoid, k, 0, ZERO)
    later = later_avoid = ZERO
    for k in range(n - 1, -1, -1):
        arc = get_arc(path.arcs, k)
        own, on_tangent = shape_pull(setting, weights, aim, path, k, arc)
        turned, carried = pull_tangent(arc, later)
        _collect(path.update, k, own, ZERO, turned, factors)
        later = add_scaled(on_tangent, setting.attenuation, carried)
        if obstacles:
            a = get_vec(path.points, k, 0)
            place, own, on_tangent = body_pull(scene, potential, setting, weights, path, k, a, arc)
            turned, carried = pull_tangent(arc, later_avoid)
            _collect(path.avoid, k, own, place, turned, factors)
            later_avoid = add_scaled(on_tangent, setting.attenuation, carried)
            if k > 0 and _free(path, k, arc.length, 0.0):
                force = scale(weights.obstacles * speed(path, k), potential_at(scene, potential, a)[1])
                put_vec(path.avoid, k, 0, add(get_vec(path.avoid, k, 0), force))


@kernel
def _costs_from(
    scene: Scene,
    potential: Potential,
    setting: Setting,
    weights: Weights,
    aim: Aim,
    path: Path,
    obstacles: bool,
    i: int,
    moved: Vec,
) -> tuple[float, float]:
    """Attenuated costs, without and of the obstacles, of what follows when point `i` is at `moved`."""
    t = get_vec(path.tangents, i - 1, 0)
    factor, alpha = 1.0, setting.attenuation
    shape = body = 0.0
    for k in range(i - 1, path.arcs.shape[0]):
        a = moved if k == i else get_vec(path.points, k, 0)
        b = moved if k == i - 1 else get_vec(path.points, k + 1, 0)
        if k >= i and (setting.exponent == LITERAL or k > i):
            factor *= alpha
        arc = arc_between(a, b, t)
        t = end_tangent(arc)
        shape += factor * shape_cost(setting, weights, aim, path, k, arc)
        if obstacles:
            body += factor * body_cost(scene, potential, setting, weights, path, k, a, arc)
    if obstacles and _free(path, i, 1.0, 0.0):
        body += weights.obstacles * speed(path, i) * potential_at(scene, potential, moved)[0]
    return shape, body


@kernel
def gradient_by_differences(
    scene: Scene, potential: Potential, setting: Setting, weights: Weights, aim: Aim, path: Path, obstacles: bool
) -> None:
    """Fill `update` and `avoid` by central differences: every coordinate of every point, both ways, all later arcs."""
    step = setting.disturbance * aim.unit
    for i in range(1, path.arcs.shape[0]):
        p = get_vec(path.points, i, 0)
        for c in range(3):
            shift = (step if c == 0 else 0.0, step if c == 1 else 0.0, step if c == 2 else 0.0)
            more = _costs_from(scene, potential, setting, weights, aim, path, obstacles, i, add(p, shift))
            less = _costs_from(scene, potential, setting, weights, aim, path, obstacles, i, sub(p, shift))
            path.update[i, c] = 0.5 * (more[0] - less[0]) / step
            path.avoid[i, c] = 0.5 * (more[1] - less[1]) / step
