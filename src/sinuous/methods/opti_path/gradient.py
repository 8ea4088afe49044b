"""What `opti_path` minimises over the points of a path, arc by arc, and what every cost pulls at.

Arc j = 1 .. n leads from point j - 1 to point j and costs

    F_j = w_length (l_j - l_0)^2 + w_obstacles beta (l_j / S) sum_s c(y_j(u_s)) + w_bends l_0^2 (bend beyond its cap)^2

and, the last one, w_orientation l_0^2 |t_n - t*|^2 (or without the square). All have the unit of a squared length.
Points themselves cost `w_obstacles v_i c(p_i)`, where v_i, the mean length of their two arcs, is held fixed.

The update of point i sums `alpha^k dF_j / dp_i` over the arcs j from i on, where k is j - i in the
paper, or what is here called adjacent: max(0, j - i - 1), so that both arcs that meet in the point count in full.
"""

import math
from collections import namedtuple
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from sinuous.kernels.clock import SEGMENT_WORK, spend
from sinuous.kernels.fields.distances import work_of_all
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, add_scaled, dot, get_vec, norm, put_vec, scale, sub
from sinuous.methods.opti_path.path import (
    Aim,
    Arc,
    Path,
    Potential,
    arc_between,
    end_tangent,
    get_arc,
    offset,
    potential_at,
    pull_length,
    pull_point,
    pull_tangent,
    pull_weight,
)

Gradient = Literal["adjoint", "differences"]
Exponent = Literal["adjacent", "literal"]
OrientationCost = Literal["squared", "norm"]
Schedule = Literal["constant", "length", "orientation", "cooling", "gated"]
Metric = Literal["identity", "difference", "acceleration"]
PotentialKind = Literal["grid", "exact"]


class OptiPathArguments(TypedDict, total=False):
    """Options of the method `opti_path` as keyword arguments, as type checkers see them; see `OptiPath`."""

    gradient: Gradient
    disturbance: float
    attenuation: float
    exponent: Exponent
    orientation: OrientationCost
    length_weight: float
    orientation_weight: float
    obstacle_weight: float
    schedule: Schedule
    cooling: float
    metric: Metric
    regularisation: float
    largest_step: float
    slope: float
    influence: float
    arcs_weight: float
    samples: int
    project: bool
    potential: PotentialKind
    spacing: float
    iterations: int
    blend: float
    dead_band: float
    bend_weight: float
    bow: float
    other_guess: bool
    restarts: bool
    settle: int


if TYPE_CHECKING:
    Setting = Any
else:
    Setting = namedtuple("Setting", OptiPathArguments.__annotations__)
    """The options of the method, in the order of its class, as numbers."""

ADJOINT, DIFFERENCES = 0.0, 1.0
ADJACENT, LITERAL = 0.0, 1.0
SQUARED, NORM = 0.0, 1.0

Weights = namedtuple("Weights", ["length", "orientation", "obstacles", "bends"])
"""The weights of one iteration."""


def beyond(value: float, low: float, high: float) -> float:
    """By how much a value is above (positive) or below (negative) a range."""
    return value - high if value > high else min(0.0, value - low)


def turn_cost(setting: Setting, weights: Weights, aim: Aim, t: Vec) -> tuple[float, Vec]:
    """Cost of the last tangent `t` and its gradient."""
    scaled = weights.orientation * aim.unit * aim.unit
    miss = sub(t, aim.direction)
    if setting.orientation == SQUARED:
        return scaled * dot(miss, miss), scale(2.0 * scaled, miss)
    far = norm(miss)
    return scaled * far, scale(scaled / far, miss) if far > 0.0 else ZERO


def shape_cost(setting: Setting, weights: Weights, aim: Aim, path: Path, k: int, arc: Arc) -> float:
    """Cost of an arc apart from obstacles."""
    miss = beyond(arc.length, path.wanted[k, 0], path.wanted[k, 1])
    over = max(0.0, 2.0 * arc.x - path.wanted[k, 2])
    cost = weights.length * miss * miss + weights.bends * aim.unit * aim.unit * over * over
    if aim.directed and k == path.arcs.shape[0] - 1:
        cost += turn_cost(setting, weights, aim, end_tangent(arc))[0]
    return cost


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


def in_the_open(path: Path, k: int, length: float, u: float) -> bool:
    """Whether the place `u` of arc `k` is outside the mount."""
    return u * length >= path.wanted[k, 3]


def body_cost(potential: Potential, setting: Setting, weights: Weights, path: Path, k: int, a: Vec, arc: Arc) -> float:
    """Cost of the obstacles near an arc that begins at `a`."""
    count = int(setting.samples)
    total = 0.0
    for s in range(count):
        u = (s + 1.0) / (count + 1.0)
        if in_the_open(path, k, arc.length, u):
            total += potential_at(potential, add(a, offset(arc, u)))[0]
    return weights.obstacles * setting.arcs_weight * arc.length * total / count if count > 0 else 0.0


def body_pull(
    potential: Potential, setting: Setting, weights: Weights, path: Path, k: int, a: Vec, arc: Arc
) -> tuple[Vec, Vec, Vec]:
    """Gradient of `body_cost` in the beginning, the chord and the first tangent of the arc."""
    count = int(setting.samples)
    on_place = on_chord = on_tangent = ZERO
    total = 0.0
    for s in range(count):
        u = (s + 1.0) / (count + 1.0)
        if in_the_open(path, k, arc.length, u):
            r = offset(arc, u)
            c, force = potential_at(potential, add(a, r))
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
    return (scale(share, on_place), add_scaled(more[0], share, on_chord), add_scaled(more[1], share, on_tangent))


def speed(path: Path, i: int) -> float:
    """What the paper calls the velocity of point `i`: the mean length of its two arcs."""
    return 0.5 * (path.arcs[i - 1, 14] + path.arcs[i, 14])


def attenuated(setting: Setting) -> tuple[float, float, float]:
    """Weights of the arc after a point, of what later arcs do to its end before that arc, and after it."""
    alpha = setting.attenuation
    if setting.exponent == LITERAL:
        return alpha, alpha, alpha * alpha
    return 1.0, 1.0, alpha


def _collect(out: Array, k: int, own: Vec, place: Vec, turned: Vec, factors: tuple[float, float, float]) -> None:
    """Add what pulls the chord of arc `k`, also through its end tangent, to its two points in `out` (n + 1, 3)."""
    next_own, before, after = factors
    put_vec(out, k + 1, 0, add(get_vec(out, k + 1, 0), add_scaled(own, before, turned)))
    start = add_scaled(scale(next_own, sub(place, own)), -after, turned)
    put_vec(out, k, 0, add(get_vec(out, k, 0), start))


def arc_price(potential: Potential, setting: Setting, obstacles: bool) -> int:
    """Looks that the costs of an arc cost, see `kernels.clock`."""
    return SEGMENT_WORK + (int(setting.samples) * work_of_all(potential.scene) if obstacles else 0)


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
