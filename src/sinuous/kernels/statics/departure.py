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
of u up to there. A line that follows the arcs pulls with a convex energy, where nothing twists, however taut it is. Its
length is linear in the state there, so that its tension leaves the straight way by no more than the state does.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import entry, shared
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, get_vec, norm
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.assembly import assemble
from sinuous.kernels.statics.drive import fill
from sinuous.kernels.statics.newton import Body, Workspace, carve, evaluate_state, workspace_size
from sinuous.kernels.statics.sweeps import factorise, solve, stiffness_of
from sinuous.kernels.tables import POSE_POSITION

ASIDE, TURN, OFF = range(3)
"""Columns of a departure: by how much any place of the body leaves the way, and by how much its end is turned (rad);
and the distance of states in the norm of the softest stiffness, which is what lines are stretched by, in `SIZE`s."""

DEPARTURE_WIDTH = 3

PARTS = 4
"""Parts of the way between whose ends the gradient of the energy is evaluated."""

POWER_STEPS = 8
"""Steps of the power method that foretells the least eigenvalue, where that is wanted closely; else a quarter."""

COARSE, CLOSE = 0.4, 0.005
"""How closely the least eigenvalue is found, as a share of what is foretold: for a first bound, and for a tight one."""

FIRST_CUT = 0.2
"""By how much less than foretold it is tried first, as a share of that; then by twice as much, and so on."""

PIVOT_ROUNDING = 1e-6
"""What is taken off, as pivots count as positive from a little below 0 on."""

BALLS = 4
"""Radii of the ball that are tried."""

Way = namedtuple("Way", ["q", "held", "x", "tensions"])
"""Two shapes in equilibrium: drives (2, n, 3), lengths at which lines are held (2, t), states (2, N, 4) and tensions
(2, t)."""

Departure = namedtuple("Departure", "sections carried lines bow q x tensions held states arcs bounds sizes")
"""What bounds are made of. Sections (n, 23), loads (k, 10) and lines (t, 10) as in `layout`; how far a drive on a
parabola leaves the straight line (n, 3). Scratch: a drive (n, 3), its state (N, 4), tensions (t,), lengths of lines
(t, 3 n + 1), states without load (N, 4), arcs (3, N, 9), `bounds` (N, 23), and the `SIZE` of each line (t,)."""

(
    BENT,
    RESTED,
    TWISTED,
    LONG,
    BENDING,
    RESTING,
    TWISTING,
    LENGTHENING,
    BEND_SOFT,
    TWIST_SOFT,
    STRETCH_SOFT,
    GROWTH,
    BOW_BEND,
    BOW_LENGTH,
    BOW_GROWTH,
    BEYOND,
    LIGHTER,
    LOST,
    OFFSETS,
    SHARE,
    LONG_SHARE,
    ANGLES,
    BOWED,
) = range(23)
"""Columns of `bounds`, the greatest values on the way. Sizes of the bend, of that without load, of twist and length;
by how much these change; compliances of bend, twist and stretch, 0 of what is rigid; change of the length without load,
relative to the least. How far the drive takes the arc aside: bend, length, that relative to the least length. The
weight that its directions carry, how much that changes, and is lost aside of the way; moments of what is carried beside
the backbone. The sum of angles up to there, and the change of its length, are at most so many times the size of a
change of state. Sums up to there of angles on the way, and of bends aside of it."""

BOUND_WIDTH = 23


def departure_size(segments: int, arcs: int, lines: int) -> int:
    """Numbers that `carve_departure` takes from a buffer."""
    return 3 * segments + 8 * arcs + lines * (3 * segments + 3) + (3 * t.ARC_WIDTH + BOUND_WIDTH) * arcs


def carve_departure(
    buffer: Array, sections: Array, carried: Array, lines: Array, bow: Array, arcs: int
) -> tuple[Departure, Array]:
    """Lay out scratch in a buffer; returns what is left of it, too."""
    n, count = sections.shape[0], lines.shape[0]
    q, rest = cut(buffer, n, 3)
    x, rest = cut(rest, arcs, t.STATE_WIDTH)
    tensions, rest = rest[:count], rest[count:]
    held, rest = cut(rest, count, 3 * n + 1)
    held[:] = 0.0
    states, rest = cut(rest, arcs, t.STATE_WIDTH)
    tables, rest = cut(rest, 3 * arcs, t.ARC_WIDTH)
    bounds, rest = cut(rest, arcs, BOUND_WIDTH)
    sizes, rest = rest[:count], rest[count:]
    return Departure(sections, carried, lines, bow, q, x, tensions, held, states, tables, bounds, sizes), rest


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
    bow: Array,
    buffer: Array,
    answer: Array,
    stretches: Array,
) -> None:
    """Fill `answer` (3,), infinite where nothing is bounded, and by how much `stretches` (t,) leave the way.

    `base` (1, 12); `sections` (n, 23), loads (k, 10) and lines (t, 10) as in `layout`; the rest see `Way`; `bow`
    (n, 3). `buffer` has `measure_size` numbers.
    """
    space, rest = carve(buffer, x.shape[1], lines.shape[0], slopes)
    for j in range(12):
        space.frames[0, j] = base[0, j]
    own, _ = carve_departure(rest, sections, carried, lines, bow, x.shape[1])
    depart(own, Way(q, held, x, tensions), space, CLOSE, answer)
    for i in range(lines.shape[0]):
        stretches[i] = answer[OFF] * own.sizes[i]


def measure_size(segments: int, arcs: int, lines: int, slopes: int) -> int:
    """Numbers of the buffer of `measure_departure`."""
    return workspace_size(arcs, lines, slopes) + departure_size(segments, arcs, lines)


def lay_between(own: Departure, way: Way, share: float, arcs: Array) -> None:
    """Fill arcs (N, 22), lines, and the state and tensions that are linear between both shapes, at a share of it."""
    less = 1.0 - share
    for s in range(own.q.shape[0]):
        for j in range(3):
            own.q[s, j] = less * way.q[0, s, j] + share * way.q[1, s, j]
    for i in range(own.lines.shape[0]):
        own.held[i, 3 * own.q.shape[0]] = less * way.held[0, i] + share * way.held[1, i]
        own.tensions[i] = less * way.tensions[0, i] + share * way.tensions[1, i]
    fill(own.sections, own.held, own.q, arcs, own.lines, own.states)
    for k in range(own.x.shape[0]):
        for j in range(4):
            own.x[k, j] = less * way.x[0, k, j] + share * way.x[1, k, j]


@shared
def depart(own: Departure, way: Way, space: Workspace, accuracy: float, answer: Array) -> None:
    """Fill `answer` (3,) and `own.sizes`; see `measure_departure`. `accuracy`: see `COARSE`."""
    N = own.x.shape[0]
    answer[ASIDE] = answer[TURN] = answer[OFF] = math.inf
    lay_between(own, way, 1.0, own.arcs[N : 2 * N])
    lay_between(own, way, 0.0, own.arcs[:N])
    _measure_ends(own, way)
    _measure_weights(own)
    seen = 0.0
    for i in range(1, PARTS):
        if 2 * i != PARTS:
            lay_between(own, way, i / PARTS, own.arcs[2 * N :])
            evaluate_state(own.x, own.tensions, _body(own), 1.0, space)
            seen = max(seen, _residual(own, space))
    lay_between(own, way, 0.5, own.arcs[2 * N :])
    evaluate_state(own.x, own.tensions, _body(own), 1.0, space)
    seen = max(seen, _residual(own, space))
    left = seen + (_elastic(own) + _pull(own)) / (8.0 * PARTS * PARTS) + _slackening(own, way) + _aside(own)
    least = _least_eigenvalue(own, space, accuracy)
    for i in range(BALLS if least > 0.0 else 0):
        growth = 1.25 if i == 0 else 1.6 if i == 1 else 2.5 if i == 2 else 4.0
        radius = growth * left / least
        sure = _sure(own, least, radius)
        if left <= sure * radius:
            _answer(own, left / sure, answer)
            return


def _body(own: Departure) -> Body:
    return Body(own.arcs[2 * own.x.shape[0] :], own.carried, own.lines)


def _answer(own: Departure, off: float, answer: Array) -> None:
    """Fill what follows from the distance of states."""
    bounds, aside, last, rolled, turn = own.bounds, 0.0, own.x.shape[0] - 1, 0.0, 0.0
    for k in range(own.x.shape[0]):
        turn += 0.125 * (bounds[k, BENT] * rolled * rolled + 2.0 * bounds[k, BENDING] * rolled)
        rolled += bounds[k, TWISTING]
        far = (bounds[k, LONG] + bounds[k, LONG_SHARE] * off) * bounds[k, SHARE] + bounds[k, LONG_SHARE]
        aside += off * far + bounds[k, LONG] * (turn + bounds[k, BOWED]) + bounds[k, BOW_LENGTH]
    answer[ASIDE], answer[TURN], answer[OFF] = aside, off * bounds[last, SHARE] + turn + bounds[last, BOWED], off


def _soft(one: float, other: float) -> float:
    """The greater compliance of two stiffnesses."""
    least = min(one, other)
    return 0.0 if least == t.RIGID else 1.0 / least


def _measure_ends(own: Departure, way: Way) -> None:
    """Fill the bounds of both ends, as far aside as the drive comes; the arcs of both are there."""
    k, N, bounds = 0, own.x.shape[0], own.bounds
    for s in range(own.q.shape[0]):
        count = own.sections[s, t.ARC_COUNT]
        bend, length = math.hypot(own.bow[s, 0], own.bow[s, 1]) / count, abs(own.bow[s, 2]) / count
        least = min(way.q[0, s, 2], way.q[1, s, 2]) / count - length
        growth = length / max(least, 1e-300) if length > 0.0 else 0.0
        for _ in range(int(count)):
            one, other, row = own.arcs[k], own.arcs[N + k], bounds[k]
            row[BOW_BEND], row[BOW_LENGTH], row[BOW_GROWTH] = bend, length, growth
            for j in range(3):
                row[BEND_SOFT + j] = _soft(one[j], other[j])
            gives = row[BEND_SOFT] > 0.0 or row[TWIST_SOFT] > 0.0 or row[STRETCH_SOFT] > 0.0
            _measure_changes(own, way, k)
            shorter = min(one[t.REST_LENGTH], other[t.REST_LENGTH])
            more = abs(other[t.REST_LENGTH] - one[t.REST_LENGTH]) / max(shorter, 1e-300) if gives else 0.0
            wider = growth if gives else 0.0
            row[GROWTH] = more + 2.0 * wider * (1.0 + more)
            for j in range(3):
                row[BEND_SOFT + j] *= 1.0 + wider
            k += 1


def _measure_changes(own: Departure, way: Way, k: int) -> None:
    """Fill sizes and changes of arc k."""
    row, one, other = own.bounds[k], way.x[0, k], way.x[1, k]
    a, b = own.arcs[k], own.arcs[own.x.shape[0] + k]
    bend, length = row[BOW_BEND], row[BOW_LENGTH]
    row[BENT] = max(math.hypot(one[0], one[1]), math.hypot(other[0], other[1])) + bend
    rest = max(math.hypot(a[t.REST_X], a[t.REST_X + 1]), math.hypot(b[t.REST_X], b[t.REST_X + 1]))
    row[RESTED] = rest + bend
    row[TWISTED] = max(abs(one[t.TWIST]), abs(other[t.TWIST]))
    row[LONG] = max(abs(one[t.LENGTH]), abs(other[t.LENGTH])) + length
    row[LONG] += norm(get_vec(own.arcs, k, t.ARC_TAIL + 1 + POSE_POSITION))
    row[BENDING] = math.hypot(other[0] - one[0], other[1] - one[1]) + 2.0 * bend
    rested = math.hypot(b[t.REST_X] - a[t.REST_X], b[t.REST_X + 1] - a[t.REST_X + 1])
    row[RESTING] = rested + 2.0 * bend
    row[TWISTING] = abs(other[t.TWIST] - one[t.TWIST])
    row[LENGTHENING] = abs(other[t.LENGTH] - one[t.LENGTH]) + 2.0 * length


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
        lost, lost_too = lost + a * row[BOW_GROWTH], lost_too + b * row[BOW_GROWTH]
        row[LOST], row[OFFSETS] = max(lost, lost_too), offsets
        row[BEYOND], row[LIGHTER] = max(one, other) + row[LOST], abs(other - one) + 2.0 * row[LOST]
    soft = angles = bowed = 0.0
    for k in range(N):
        row = bounds[k]
        soft += row[BEND_SOFT] + row[TWIST_SOFT]
        angles += row[BENDING] + row[TWISTING]
        bowed += row[BOW_BEND]
        row[SHARE], row[LONG_SHARE] = math.sqrt(soft), math.sqrt(row[STRETCH_SOFT])
        row[ANGLES], row[BOWED] = angles, bowed
    for i in range(own.lines.shape[0]):
        line, total = own.lines[i], 0.0
        square = line[t.ARM] ** 2 + line[t.ARM + 1] ** 2
        for k in range(int(line[t.FIRST_ARC]), int(line[t.LAST_ARC]) + 1):
            total += square * bounds[k, BEND_SOFT] + bounds[k, STRETCH_SOFT]
        own.sizes[i] = math.sqrt(total)


def _residual(own: Departure, space: Workspace) -> float:
    """Size of the gradient of the energy that was evaluated, in the dual norm."""
    total = 0.0
    for k in range(own.x.shape[0]):
        for j in range(4):
            total += own.bounds[k, BEND_SOFT + max(0, j - 1)] * space.stages[k, t.RESIDUAL + j] ** 2
    return math.sqrt(total)


def _stiffness(row: Array, i: int) -> float:
    """Stiffness of bend, twist or stretch, the greatest on the way; 0 of what is rigid."""
    soft = row[BEND_SOFT + i]
    return float((1.0 + row[GROWTH]) / soft) if soft > 0.0 else 0.0


def _second(growth: float, value: float, once: float, twice: float) -> float:
    """Second derivative of a stiffness that goes with 1 / length, times something; in units of that stiffness.

    `growth`: of the length; `value`, `once` and `twice` bound the other factor and its derivatives.
    """
    return twice + 2.0 * growth * once + 2.0 * growth * growth * value


def _elastic(own: Departure) -> float:
    """Second derivative by s of the moments and forces of the arcs themselves, in the dual norm."""
    total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        v, c, dv, dc, g = row[BENT], row[RESTED], row[BENDING], row[RESTING], row[GROWTH]
        twists = row[TWIST_SOFT] > 0.0
        tau, dtau = (row[TWISTED], row[TWISTING]) if twists else (0.0, 0.0)
        twice = 0.25 * c * dtau * dtau + dc * dtau
        bend = _stiffness(row, 0) * _second(g, v + c, dv + dc + 0.5 * c * dtau, twice)
        once = 0.5 * (dv * c + v * dc + 0.5 * v * c * dtau)
        twice = 0.5 * (2.0 * dv * dc + (dv * c + v * dc) * dtau + 0.25 * v * c * dtau * dtau)
        turn = _stiffness(row, 0) * _second(g, 0.5 * v * c, once, twice) if twists else 0.0
        turn += _stiffness(row, 1) * _second(g, tau, dtau, 0.0)
        pull = _stiffness(row, 2) * _second(g, row[LONG], 2.0 * row[LENGTHENING], 0.0)
        total += row[BEND_SOFT] * bend * bend + row[TWIST_SOFT] * turn * turn + row[STRETCH_SOFT] * pull * pull
    return math.sqrt(total)


def _pull(own: Departure) -> float:
    """The same of weights and payloads."""
    total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        A, share, long, longer = row[ANGLES], row[SHARE], row[LONG_SHARE], row[LENGTHENING]
        once = row[LONG] * A * share + longer * share + A * long
        twice = row[LONG] * A * A * share + 2.0 * longer * A * share + A * A * long
        total += row[BEYOND] * twice + 2.0 * row[LIGHTER] * once + row[OFFSETS] * A * A * share
    return total


def _aside(own: Departure) -> float:
    """By how much the gradient of the energy changes aside of the straight way, in the dual norm."""
    square = total = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        b, g, v, c = row[BOW_BEND], row[BOW_GROWTH], row[BENT], row[RESTED]
        share, long, bowed = row[SHARE], row[LONG_SHARE], row[BOWED]
        stiff = _stiffness(row, 0)
        bend = stiff * (2.0 * b + g * (v + c))
        turn = 0.5 * stiff * (b * (v + c) + g * v * c) if row[TWIST_SOFT] > 0.0 else 0.0
        turn += _stiffness(row, 1) * g * row[TWISTED]
        pull = _stiffness(row, 2) * g * row[LONG]
        square += row[BEND_SOFT] * bend * bend + row[TWIST_SOFT] * turn * turn + row[STRETCH_SOFT] * pull * pull
        moved = row[LONG] * bowed * share + row[BOW_LENGTH] * share + bowed * long
        total += row[BEYOND] * moved + row[LOST] * (row[LONG] * share + long) + row[OFFSETS] * bowed * share
    return math.sqrt(square) + total


def stretch_of(lines: Array, i: int, held: float, tension: float, x: Array) -> float:
    """By how much line i is stretched, in a state where its tension is known; negative: by how much it is slack.

    It follows arcs that do not twist.
    """
    if tension > 0.0 or lines[i, t.PUSHES] > 0.0 or lines[i, t.STRAIGHT] > 0.0:
        return float(tension * lines[i, t.COMPLIANCE])
    long = 0.0
    for k in range(int(lines[i, t.FIRST_ARC]), int(lines[i, t.LAST_ARC]) + 1):
        long += x[k, t.LENGTH] - x[k, 0] * lines[i, t.ARM] - x[k, 1] * lines[i, t.ARM + 1]
    return min(0.0, long - held)


def _slackening(own: Departure, way: Way) -> float:
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
    foretold = min(1.0, _power(own.arcs[2 * own.x.shape[0] :], steps, space))
    assemble(own.x, _body(own).arcs, own.lines, own.tensions, 1.0, space.frames, space.stages, space.slopes)
    bad, good, taken = 0.0, 1.0, 0.0
    less = FIRST_CUT * accuracy if accuracy == CLOSE else accuracy
    while good - bad > accuracy and less < 1.0:
        sure = _is_stiffer(own, (1.0 - less) * foretold - taken, space)
        taken = (1.0 - less) * foretold
        bad, good = (bad, less) if sure else (less, good)
        less = 2.0 * less if good == 1.0 else 0.5 * (bad + good)
    return (1.0 - good) * foretold - PIVOT_ROUNDING


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


def _power(arcs: Array, steps: int, space: Workspace) -> float:
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


def _sure(own: Departure, least: float, radius: float) -> float:
    """Lower bound of the eigenvalues anywhere in the ball, at any time, in the norm of the softest stiffness.

    Half-way they are at `least`, and nothing is farther from there than half of the changes.
    """
    total = most = worst = 0.0
    for k in range(own.x.shape[0]):
        row = own.bounds[k]
        share, long, g, c = row[SHARE], row[LONG_SHARE], 0.5 * row[GROWTH], row[RESTED]
        angles = 0.5 * row[ANGLES] + share * radius
        stretch, length = 0.5 * row[LENGTHENING] + long * radius, row[LONG] + long * radius
        turned = row[BEYOND] * (length * angles * share**2 + stretch * share**2 + 2.0 * long * angles * share)
        lighter = 0.5 * row[LIGHTER] * (length * share**2 + 2.0 * long * share)
        total += turned + lighter + row[OFFSETS] * angles * share**2
        bend, twist = math.sqrt(row[BEND_SOFT]), math.sqrt(row[TWIST_SOFT])
        twisted, bent = 0.5 * row[TWISTING] + twist * radius, row[BENT] + bend * radius
        rested, bending = 0.5 * row[RESTING], 0.5 * row[BENDING] + bend * radius
        mixed = 0.5 * (rested + 0.5 * c * twisted + g * c)
        even = 0.25 * (bending * c + bent * rested + 0.5 * bent * c * twisted + g * bent * c)
        coupled = _stiffness(row, 0) * (mixed * bend * twist + even * row[TWIST_SOFT])
        most, worst = max(most, g), max(worst, coupled)
    return 1.0 + (least - 1.0) * (1.0 + most) - total - worst
