"""How far a loaded body leaves the straight way between two of its shapes, while its motors run evenly: a proof.

From state `x0` at one drive to `x1` at another, let `x(s)` be linear. The equilibrium at `s` is the root of the
gradient `r(y; s)` of the energy. In the norm `|u|^2 = sum m_j u_j^2`, m the stiffness of every coordinate:

- `r(x(s); s)` is evaluated at places of s; between two it is at most 1/8 of its largest second derivative more: R;
- where `u' H u >= c |u|^2` for the second derivative H of the energy all around, y of `|y - x(s)| <= rho`, and
  `R <= c rho`, there is exactly one root in that ball at every s (Kantorovich; monotone operators), and it is within
  `R / c`. As the roots go on steadily, they are the equilibria that the body passes through.

A drive on a parabola leaves the straight line, and takes the state without load with it: `x(s)` and `q(s)` are moved
aside together, and R and c hold as far aside as they come.

c is the least eigenvalue half-way, less what third derivatives can change. That no eigenvalue is less than c is known
by the signs of the pivots of `H - c M` (Sylvester's law of inertia). All third derivatives are bounded by one rule: a
tangent of the body is a product of rotations, whose m-th derivative along `u` is at most `A^m`, A the sum of the angles
of u up to there. A line that follows the arcs pulls with a convex energy, without torsion, however taut it is. Its
length is linear in the state there, so that its tension leaves the straight way by no more than the state does.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain.kinematics import interpolate
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, get_vec, norm
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.assembly import assemble
from sinuous.kernels.statics.drive import fill_tables
from sinuous.kernels.statics.newton import Body, Workspace, carve, evaluate_state, workspace_size
from sinuous.kernels.statics.sweeps import factorise, solve, stiffness_of
from sinuous.kernels.tables import POSE_POSITION

DEVIATION, TURN, OFF = range(3)
"""Columns of a departure: by how much any place of the body leaves the way, and by how much its end is turned (rad);
and the distance of states in the norm of the softest stiffness, which is what lines are stretched by, in `SIZE`s."""

DEPARTURE_WIDTH = 3

PARTS = 4
"""Parts of the way between whose ends the gradient of the energy is evaluated."""

POWER_STEPS = 8
"""Steps of the power method that estimates the least eigenvalue, where that is wanted closely; else a quarter."""

COARSE, CLOSE = 0.4, 0.005
"""How closely the least eigenvalue is found, as a share of its estimate: for a first bound and for a tight one."""

FIRST_CUT = 0.2
"""By how much less than its estimate it is tried first, as a share of that; then by twice as much, and so on."""

PIVOT_ROUNDING = 1e-6
"""What is taken off, as pivots count as positive from a little below 0 on."""

BALLS = 4
"""Radii of the ball that are tried."""

Way = namedtuple("Way", ["q", "held", "x", "tensions"])
"""Two shapes in equilibrium: drives (2, n, 3), lengths at which lines are held (2, t), states (2, N, 4) and tensions
(2, t)."""

Departure = namedtuple("Departure", "sections carried lines sagitta q x tensions held states arcs bounds sizes")
"""What bounds are made of. Sections (n, 23), loads (k, 10) and lines (t, 10) as in `layout`; how far a drive on a
parabola leaves the straight line (n, 3). Scratch: a drive (n, 3), its state (N, 4), tensions (t,), lengths of lines
(t, 3 n + 1), states without load (N, 4), arcs (3, N, 9), `bounds` (N, 23), and the `SIZE` of each line (t,)."""

(
    BEND_SIZE,
    REST_SIZE,
    TORSION,
    LENGTH_SIZE,
    BEND_CHANGE,
    REST_CHANGE,
    TORSION_CHANGE,
    LENGTH_CHANGE,
    BEND_COMPLIANCE,
    TORSION_COMPLIANCE,
    STRETCH_COMPLIANCE,
    GROWTH,
    SAGITTA_BEND,
    SAGITTA_LENGTH,
    SAGITTA_GROWTH,
    WEIGHT_BEYOND,
    WEIGHT_CHANGE,
    WEIGHT_LOST,
    OFFSET_MOMENTS,
    ANGLE_FACTOR,
    LENGTH_FACTOR,
    ANGLES,
    SAGITTA_SUM,
) = range(23)
"""Columns of `bounds`, the greatest values on the way. Sizes of the bend, of that without load, of torsion and length;
by how much these change; compliances of bend, torsion and stretch, 0 of what is rigid; change of the length without
load, relative to the least. How far a drive on a parabola is off the straight one: bend, length, that relative to the
least length. The weight that directions of the arc carry, how much that changes, and is lost off the straight way;
moments of what is carried beside the backbone. The sum of angles up to there, and the change of its length, are at most
so many times the size of a change of state. Sums up to there of changes of angles, and of bends off the straight
way."""

BOUND_WIDTH = 23


def departure_size(segments: int, arcs: int, lines: int) -> int:
    """Numbers that `carve_departure` takes from a buffer."""
    return 3 * segments + 8 * arcs + lines * (3 * segments + 3) + (3 * t.ARC_WIDTH + BOUND_WIDTH) * arcs


def carve_departure(
    buffer: Array, sections: Array, carried: Array, lines: Array, sagitta: Array, arcs: int
) -> Departure:
    """Lay out scratch in a buffer. `carried` (k, 10): loads; `sagitta` (n, 3)."""
    n, count = sections.shape[0], lines.shape[0]
    q, rest = cut(buffer, n, 3)
    x, rest = cut(rest, arcs, t.STATE_WIDTH)
    tensions, rest = rest[:count], rest[count:]
    held, rest = cut(rest, count, 3 * n + 1)
    held[:] = 0.0
    states, rest = cut(rest, arcs, t.STATE_WIDTH)
    tables, rest = cut(rest, 3 * arcs, t.ARC_WIDTH)
    bounds, rest = cut(rest, arcs, BOUND_WIDTH)
    return Departure(sections, carried, lines, sagitta, q, x, tensions, held, states, tables, bounds, rest[:count])


@entry
def measure_departure(
    base: Array,
    sections: Array,
    carried: Array,
    lines: Array,
    slopes: int,
    q: Array,
    held: Array,
    x: Array,
    tensions: Array,
    sagitta: Array,
    buffer: Array,
    answer: Array,
    stretches: Array,
) -> None:
    """Fill `answer` (3,), infinite where nothing is bounded, and by how much `stretches` (t,) leave the way.

    `carried` (k, 10) are loads; `q` (2, n, 3), `held` (2, t), `x` (2, N, 4) and `tensions` (2, t) as in `Way`;
    `sagitta` (n, 3) in `Departure`, `slopes` as for `equilibrium.equilibrate`. `buffer` has `measure_size` numbers.
    """
    space, rest = carve(buffer, base, x.shape[1], lines.shape[0], slopes)
    own = carve_departure(rest, sections, carried, lines, sagitta, x.shape[1])
    bound_departure(own, Way(q, held, x, tensions), space, CLOSE, answer)
    for i in range(lines.shape[0]):
        stretches[i] = answer[OFF] * own.sizes[i]


def measure_size(segments: int, arcs: int, lines: int, slopes: int) -> int:
    """Numbers of the buffer of `measure_departure`."""
    return workspace_size(arcs, lines, slopes) + departure_size(segments, arcs, lines)


def fill_tables_between(own: Departure, way: Way, share: float, arcs: Array) -> None:
    """Fill arcs (N, 22), lines, and the state and tensions that are linear between both shapes, at a share of it."""
    less = 1.0 - share
    interpolate(way.q[0], way.q[1], share, own.q)
    for i in range(own.lines.shape[0]):
        own.held[i, 3 * own.q.shape[0]] = less * way.held[0, i] + share * way.held[1, i]
        own.tensions[i] = less * way.tensions[0, i] + share * way.tensions[1, i]
    fill_tables(own.sections, own.held, own.q, arcs, own.lines, own.states)
    interpolate(way.x[0], way.x[1], share, own.x)


@shared
def bound_departure(own: Departure, way: Way, space: Workspace, accuracy: float, answer: Array) -> None:
    """Bound how far equilibria leave the way: fill `answer` (3,) and `own.sizes`; see `measure_departure`.

    `accuracy`: see `COARSE`.
    """
    N = own.x.shape[0]
    answer[DEVIATION] = answer[TURN] = answer[OFF] = math.inf
    fill_tables_between(own, way, 1.0, own.arcs[N : 2 * N])
    fill_tables_between(own, way, 0.0, own.arcs[:N])
    _measure_ends(own, way)
    _measure_weights(own)
    seen = 0.0
    for i in range(1, PARTS):
        if 2 * i != PARTS:
            fill_tables_between(own, way, i / PARTS, own.arcs[2 * N :])
            evaluate_state(own.x, own.tensions, _body(own), 1.0, space)
            seen = max(seen, _residual(own, space))
    fill_tables_between(own, way, 0.5, own.arcs[2 * N :])
    evaluate_state(own.x, own.tensions, _body(own), 1.0, space)
    seen = max(seen, _residual(own, space))
    curved = (_bound_elastic(own) + _bound_loads(own)) / (8.0 * PARTS * PARTS)
    left = seen + curved + _bound_slackening(own, way) + _bound_gradient_change(own)
    least = _least_eigenvalue(own, space, accuracy)
    for i in range(BALLS if least > 0.0 else 0):
        growth = 1.25 if i == 0 else 1.6 if i == 1 else 2.5 if i == 2 else 4.0
        radius = growth * left / least
        sure = _bound_eigenvalues(own, least, radius)
        if left <= sure * radius:
            _fill_departure(own, left / sure, answer)
            return


def _body(own: Departure) -> Body:
    return Body(own.arcs[2 * own.x.shape[0] :], own.carried, own.lines)


def _fill_departure(own: Departure, off: float, answer: Array) -> None:
    """Fill `answer` (3,) from how far `off` states are at most."""
    bounds, deviation, last, rolled, turn = own.bounds, 0.0, own.x.shape[0] - 1, 0.0, 0.0
    for k in range(own.x.shape[0]):
        turn += 0.125 * (bounds[k, BEND_SIZE] * rolled * rolled + 2.0 * bounds[k, BEND_CHANGE] * rolled)
        rolled += bounds[k, TORSION_CHANGE]
        size, factor = bounds[k, LENGTH_SIZE], bounds[k, LENGTH_FACTOR]
        far = (size + factor * off) * bounds[k, ANGLE_FACTOR] + factor
        deviation += off * far + size * (turn + bounds[k, SAGITTA_SUM]) + bounds[k, SAGITTA_LENGTH]
    answer[DEVIATION], answer[OFF] = deviation, off
    answer[TURN] = off * bounds[last, ANGLE_FACTOR] + turn + bounds[last, SAGITTA_SUM]


def _greater_compliance(one: float, other: float) -> float:
    """The greater compliance of two stiffnesses."""
    least = min(one, other)
    return 0.0 if least == t.RIGID else 1.0 / least


def _measure_ends(own: Departure, way: Way) -> None:
    """Fill the bounds of both ends, as far aside as the drive comes; the arcs of both are there."""
    k, N, bounds = 0, own.x.shape[0], own.bounds
    for s in range(own.q.shape[0]):
        count = own.sections[s, t.ARC_COUNT]
        bend, length = math.hypot(own.sagitta[s, 0], own.sagitta[s, 1]) / count, abs(own.sagitta[s, 2]) / count
        least = min(way.q[0, s, 2], way.q[1, s, 2]) / count - length
        growth = length / max(least, 1e-300) if length > 0.0 else 0.0
        for _ in range(int(count)):
            one, other, row = own.arcs[k], own.arcs[N + k], bounds[k]
            row[SAGITTA_BEND], row[SAGITTA_LENGTH], row[SAGITTA_GROWTH] = bend, length, growth
            for j in range(3):
                row[BEND_COMPLIANCE + j] = _greater_compliance(one[j], other[j])
            gives = row[BEND_COMPLIANCE] > 0.0 or row[TORSION_COMPLIANCE] > 0.0 or row[STRETCH_COMPLIANCE] > 0.0
            _measure_changes(own, way, k)
            shorter = min(one[t.REST_LENGTH], other[t.REST_LENGTH])
            more = abs(other[t.REST_LENGTH] - one[t.REST_LENGTH]) / max(shorter, 1e-300) if gives else 0.0
            wider = growth if gives else 0.0
            row[GROWTH] = more + 2.0 * wider * (1.0 + more)
            for j in range(3):
                row[BEND_COMPLIANCE + j] *= 1.0 + wider
            k += 1


def _measure_changes(own: Departure, way: Way, k: int) -> None:
    """Fill sizes and changes of arc k."""
    row, one, other = own.bounds[k], way.x[0, k], way.x[1, k]
    a, b = own.arcs[k], own.arcs[own.x.shape[0] + k]
    bend, length = row[SAGITTA_BEND], row[SAGITTA_LENGTH]
    row[BEND_SIZE] = max(math.hypot(one[0], one[1]), math.hypot(other[0], other[1])) + bend
    rest = max(math.hypot(a[t.REST_X], a[t.REST_X + 1]), math.hypot(b[t.REST_X], b[t.REST_X + 1]))
    row[REST_SIZE] = rest + bend
    row[TORSION] = max(abs(one[t.TORSION]), abs(other[t.TORSION]))
    row[LENGTH_SIZE] = max(abs(one[t.LENGTH]), abs(other[t.LENGTH])) + length
    row[LENGTH_SIZE] += norm(get_vec(own.arcs, k, t.ARC_TAIL + 1 + POSE_POSITION))
    row[BEND_CHANGE] = math.hypot(other[0] - one[0], other[1] - one[1]) + 2.0 * bend
    rested = math.hypot(b[t.REST_X] - a[t.REST_X], b[t.REST_X + 1] - a[t.REST_X + 1])
    row[REST_CHANGE] = rested + 2.0 * bend
    row[TORSION_CHANGE] = abs(other[t.TORSION] - one[t.TORSION])
    row[LENGTH_CHANGE] = abs(other[t.LENGTH] - one[t.LENGTH]) + 2.0 * length


def _measure_weights(own: Departure) -> None:
    """Fill the weights that directions of arcs carry, and sums along the body."""
    bounds, N = own.bounds, own.x.shape[0]
    one = other = lost = lost_too = 0.0
    last = own.carried.shape[0] - 1
    for k in range(N - 1, -1, -1):
        row, offsets = bounds[k], 0.0
        while last >= 0 and own.carried[last, t.LOAD_ARC] >= k:
            pull = norm(get_vec(own.carried, last, t.FORCE))
            one, other = one + pull, other + pull
            offsets += pull * norm(get_vec(own.carried, last, t.LOAD_OFFSET))
            last -= 1
        a, b = norm(get_vec(own.arcs, k, t.WEIGHT)), norm(get_vec(own.arcs, N + k, t.WEIGHT))
        one, other = one + a, other + b
        lost, lost_too = lost + a * row[SAGITTA_GROWTH], lost_too + b * row[SAGITTA_GROWTH]
        row[WEIGHT_LOST], row[OFFSET_MOMENTS] = max(lost, lost_too), offsets
        row[WEIGHT_BEYOND], row[WEIGHT_CHANGE] = (
            max(one, other) + row[WEIGHT_LOST],
            abs(other - one) + 2.0 * row[WEIGHT_LOST],
        )
    soft = angles = sagittas = 0.0
    for k in range(N):
        row = bounds[k]
        soft += row[BEND_COMPLIANCE] + row[TORSION_COMPLIANCE]
        angles += row[BEND_CHANGE] + row[TORSION_CHANGE]
        sagittas += row[SAGITTA_BEND]
        row[ANGLE_FACTOR], row[LENGTH_FACTOR] = math.sqrt(soft), math.sqrt(row[STRETCH_COMPLIANCE])
        row[ANGLES], row[SAGITTA_SUM] = angles, sagittas
    for i in range(own.lines.shape[0]):
        line, total = own.lines[i], 0.0
        square = line[t.ARM] ** 2 + line[t.ARM + 1] ** 2
        for k in range(int(line[t.FIRST_ARC]), int(line[t.LAST_ARC]) + 1):
            total += square * bounds[k, BEND_COMPLIANCE] + bounds[k, STRETCH_COMPLIANCE]
        own.sizes[i] = math.sqrt(total)


def _residual(own: Departure, space: Workspace) -> float:
    """Size of the gradient of the energy that was evaluated, in the dual norm."""
    total = 0.0
    for k in range(own.x.shape[0]):
        for j in range(4):
            total += own.bounds[k, BEND_COMPLIANCE + max(0, j - 1)] * space.stages[k, t.RESIDUAL + j] ** 2
    return math.sqrt(total)


def _stiffness(row: Array, i: int) -> float:
    """The greatest stiffness of bend, torsion or stretch on the way, of a `row` (23,) of bounds; 0 of what is rigid."""
    soft = row[BEND_COMPLIANCE + i]
    return float((1.0 + row[GROWTH]) / soft) if soft > 0.0 else 0.0


def _dual_square(row: Array, bend: float, turn: float, pull: float) -> float:
    """Square, in the dual norm, of what acts on bend, torsion and length of the arc of a `row` (23,) of bounds."""
    soft, twisting, stretching = row[BEND_COMPLIANCE], row[TORSION_COMPLIANCE], row[STRETCH_COMPLIANCE]
    return float(soft * bend * bend + twisting * turn * turn + stretching * pull * pull)


def _second(growth: float, value: float, once: float, twice: float) -> float:
    """Second derivative of a stiffness that goes with 1 / length, times something; in units of that stiffness.

    `growth`: of the length; `value`, `once` and `twice` bound the other factor and its derivatives.
    """
    return twice + 2.0 * growth * once + 2.0 * growth * growth * value


def _bound_elastic(own: Departure) -> float:
    """Second derivative by s of the moments and forces of the arcs themselves, in the dual norm."""
    total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        v, c, dv, dc, g = row[BEND_SIZE], row[REST_SIZE], row[BEND_CHANGE], row[REST_CHANGE], row[GROWTH]
        twists = row[TORSION_COMPLIANCE] > 0.0
        tau, dtau = (row[TORSION], row[TORSION_CHANGE]) if twists else (0.0, 0.0)
        twice = 0.25 * c * dtau * dtau + dc * dtau
        bend = _stiffness(row, 0) * _second(g, v + c, dv + dc + 0.5 * c * dtau, twice)
        once = 0.5 * (dv * c + v * dc + 0.5 * v * c * dtau)
        twice = 0.5 * (2.0 * dv * dc + (dv * c + v * dc) * dtau + 0.25 * v * c * dtau * dtau)
        turn = _stiffness(row, 0) * _second(g, 0.5 * v * c, once, twice) if twists else 0.0
        turn += _stiffness(row, 1) * _second(g, tau, dtau, 0.0)
        pull = _stiffness(row, 2) * _second(g, row[LENGTH_SIZE], 2.0 * row[LENGTH_CHANGE], 0.0)
        total += _dual_square(row, bend, turn, pull)
    return math.sqrt(total)


def _bound_loads(own: Departure) -> float:
    """The same of weights and payloads."""
    total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        A, share, long, longer = row[ANGLES], row[ANGLE_FACTOR], row[LENGTH_FACTOR], row[LENGTH_CHANGE]
        once = row[LENGTH_SIZE] * A * share + longer * share + A * long
        twice = row[LENGTH_SIZE] * A * A * share + 2.0 * longer * A * share + A * A * long
        total += row[WEIGHT_BEYOND] * twice + 2.0 * row[WEIGHT_CHANGE] * once + row[OFFSET_MOMENTS] * A * A * share
    return total


def _bound_gradient_change(own: Departure) -> float:
    """By how much the gradient of the energy changes aside of the straight way, in the dual norm."""
    square = total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        b, g, v, c = row[SAGITTA_BEND], row[SAGITTA_GROWTH], row[BEND_SIZE], row[REST_SIZE]
        share, long, sagittas = row[ANGLE_FACTOR], row[LENGTH_FACTOR], row[SAGITTA_SUM]
        stiff = _stiffness(row, 0)
        bend = stiff * (2.0 * b + g * (v + c))
        turn = 0.5 * stiff * (b * (v + c) + g * v * c) if row[TORSION_COMPLIANCE] > 0.0 else 0.0
        turn += _stiffness(row, 1) * g * row[TORSION]
        pull = _stiffness(row, 2) * g * row[LENGTH_SIZE]
        square += _dual_square(row, bend, turn, pull)
        moved = row[LENGTH_SIZE] * sagittas * share + row[SAGITTA_LENGTH] * share + sagittas * long
        lost = row[WEIGHT_LOST] * (row[LENGTH_SIZE] * share + long)
        total += row[WEIGHT_BEYOND] * moved + lost + row[OFFSET_MOMENTS] * sagittas * share
    return math.sqrt(square) + total


def stretch_of(lines: Array, i: int, held: float, tension: float, x: Array) -> float:
    """By how much line i is stretched, in a state where its tension is known; negative: by how much it is slack.

    It follows arcs that have no torsion.
    """
    if tension > 0.0 or lines[i, t.PUSHES] > 0.0 or lines[i, t.STRAIGHT] > 0.0:
        return float(tension * lines[i, t.COMPLIANCE])
    long = 0.0
    for k in range(int(lines[i, t.FIRST_ARC]), int(lines[i, t.LAST_ARC]) + 1):
        long += x[k, t.LENGTH] - x[k, 0] * lines[i, t.ARM] - x[k, 1] * lines[i, t.ARM + 1]
    return min(0.0, long - held)


def _bound_slackening(own: Departure, way: Way) -> float:
    """By how much tensions leave the straight line where lines become slack or taut on the way, in the dual norm."""
    total = 0.0
    for i in range(own.lines.shape[0]):
        if own.lines[i, t.PUSHES] == 0.0 and own.lines[i, t.HELD] > 0.0:
            one = stretch_of(own.lines, i, way.held[0, i], way.tensions[0, i], way.x[0])
            other = stretch_of(own.lines, i, way.held[1, i], way.tensions[1, i], way.x[1])
            most, least = max(one, other), min(one, other)
            if most > 0.0 > least:
                total += own.sizes[i] * most * -least / ((most - least) * own.lines[i, t.COMPLIANCE])
    return total


def _least_eigenvalue(own: Departure, space: Workspace, accuracy: float) -> float:
    """A number that no eigenvalue of the second derivative half-way is below, relative to the stiffness of the arcs.

    At most 1, and 0 where none is known. The state was just evaluated.
    """
    steps = POWER_STEPS if accuracy == CLOSE else POWER_STEPS // 4
    estimated = min(1.0, _estimate_eigenvalue(own.arcs[2 * own.x.shape[0] :], steps, space))
    assemble(own.x, _body(own).arcs, own.lines, own.tensions, 1.0, space.frames, space.stages, space.slopes)
    bad, good, taken = 0.0, 1.0, 0.0
    less = FIRST_CUT * accuracy if accuracy == CLOSE else accuracy
    while good - bad > accuracy and less < 1.0:
        sure = _is_stiffer(own, (1.0 - less) * estimated - taken, space)
        taken = (1.0 - less) * estimated
        bad, good = (bad, less) if sure else (less, good)
        less = 2.0 * less if good == 1.0 else 0.5 * (bad + good)
    return (1.0 - good) * estimated - PIVOT_ROUNDING


def _is_stiffer(own: Departure, more: float, space: Workspace) -> bool:
    """Take so much more of the stiffness of arcs off the second derivative; whether it is still positive definite."""
    arcs = _body(own).arcs
    for k in range(own.x.shape[0]):
        for j in range(4):
            stiffness = stiffness_of(arcs, k, j)
            if stiffness < t.RIGID:
                space.stages[k, t.HESSIAN + 5 * j] -= more * stiffness
    scratch = space.scratch[space.scratch.shape[0] - 11 :]
    negative, _, _ = factorise(own.x, space.frames, arcs, own.carried, 1.0, 0.0, space.stages, scratch)
    return bool(negative == 0)


def _estimate_eigenvalue(arcs: Array, steps: int, space: Workspace) -> float:
    """The least eigenvalue, about: the power method with the inverse of what was just factorised."""
    u, size, found = space.step, 0.0, 1.0
    for k in range(u.shape[0]):
        for j in range(4):
            u[k, j] = 1.0 if j < 2 else 0.3
    for step in range(steps + 1):
        total = 0.0
        for k in range(u.shape[0]):
            for j in range(4):
                stiffness = stiffness_of(arcs, k, j)
                if stiffness < t.RIGID:
                    total += stiffness * u[k, j] * u[k, j]
        size = math.sqrt(total)
        if not size > 0.0:
            return 1.0
        found = found if step == 0 else 1.0 / size
        if step == steps:
            break
        for k in range(u.shape[0]):
            for j in range(4):
                stiffness = stiffness_of(arcs, k, j)
                u[k, j] = stiffness * u[k, j] / size if stiffness < t.RIGID else 0.0
        solve(u, space.none, space.stages, u)
    return found


def _bound_eigenvalues(own: Departure, least: float, radius: float) -> float:
    """Lower bound of the eigenvalues anywhere in the ball, at any time, in the norm of the softest stiffness.

    Half-way they are at `least`, and nothing is farther from there than half of the changes.
    """
    total = most = worst = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        share, long, g, c = row[ANGLE_FACTOR], row[LENGTH_FACTOR], 0.5 * row[GROWTH], row[REST_SIZE]
        angles = 0.5 * row[ANGLES] + share * radius
        stretch, length = 0.5 * row[LENGTH_CHANGE] + long * radius, row[LENGTH_SIZE] + long * radius
        turned = row[WEIGHT_BEYOND] * (length * angles * share**2 + stretch * share**2 + 2.0 * long * angles * share)
        lighter = 0.5 * row[WEIGHT_CHANGE] * (length * share**2 + 2.0 * long * share)
        total += turned + lighter + row[OFFSET_MOMENTS] * angles * share**2
        bend, twist = math.sqrt(row[BEND_COMPLIANCE]), math.sqrt(row[TORSION_COMPLIANCE])
        twisted, bent = 0.5 * row[TORSION_CHANGE] + twist * radius, row[BEND_SIZE] + bend * radius
        rested, bending = 0.5 * row[REST_CHANGE], 0.5 * row[BEND_CHANGE] + bend * radius
        mixed = 0.5 * (rested + 0.5 * c * twisted + g * c)
        even = 0.25 * (bending * c + bent * rested + 0.5 * bent * c * twisted + g * bent * c)
        coupled = _stiffness(row, 0) * (mixed * bend * twist + even * row[TORSION_COMPLIANCE])
        most, worst = max(most, g), max(worst, coupled)
    return 1.0 + (least - 1.0) * (1.0 + most) - total - worst
