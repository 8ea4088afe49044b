"""What a drive makes of a body of arcs: its tables, and how the equilibrium moves with the drive.

A drive is `q` (n, 3): of every section the bend and the length that it would have without any load. The lengths that
lines are held at are linear in it, but where they run straight: those have the chords of the arcs that nothing loads.
At an equilibrium `r(x; q) = 0`, so `dx/dq = -(dr/dx)^-1 dr/dq` (implicit function theorem), a solve a coordinate.
"""

import math

from sinuous.kernels.compile import entry, shared
from sinuous.kernels.maths.vectors import Array, add, cross, dot, get_vec, mat_vec, scale
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.assembly import about_z
from sinuous.kernels.statics.newton import Body, Workspace, evaluate_state, fill_replies, find_taut, hold_taut, lay_out
from sinuous.kernels.statics.sweeps import impose_rigid_changes, solve

SMALL = 1e-3
"""Half of the bend of an arc, rad, below which series are used."""


@entry
def fill_body_tables(sections: Array, of_lines: Array, q: Array, arcs: Array, lines: Array, states: Array) -> None:
    """Fill arcs (N, 22), the values of lines (t, 10) and the states (N, 4) without load of a drive `q` (n, 3).

    A row of `of_lines` (t, 3 n + 1): the derivative by the drive of the length that a line is held at, and what that is
    for a drive of zero; both without chords.
    """
    fill_tables(sections, of_lines, q, arcs, lines, states)


def fill_tables(sections: Array, of_lines: Array, q: Array, arcs: Array, lines: Array, states: Array) -> None:
    """The same for kernels: `of_lines` (t, 3 n + 1), `states` (N, 4)."""
    k = 0
    for s in range(q.shape[0]):
        fraction = 1.0 / sections[s, t.ARC_COUNT]
        own = fraction * q[s, 2]
        for _ in range(int(sections[s, t.ARC_COUNT])):
            for j in range(3):
                stiffness = sections[s, t.BENDING + j]
                arcs[k, j] = stiffness / own if own > 0.0 and stiffness < t.RIGID else t.RIGID
                arcs[k, t.WEIGHT + j] = own * sections[s, t.HEAVY + j]
            for j in range(2):
                rest = sections[s, t.REST_BEND + j] if sections[s, t.PULLED] > 0.0 else q[s, j]
                arcs[k, t.REST_X + j], states[k, j] = fraction * rest, fraction * q[s, j]
            arcs[k, t.REST_LENGTH] = states[k, t.LENGTH] = own
            states[k, t.TORSION] = 0.0
            for j in range(t.TAIL_WIDTH):
                arcs[k, t.ARC_TAIL + j] = sections[s, t.SECTION_TAIL + j]
            k += 1
    for i in range(lines.shape[0]):
        if lines[i, t.HELD] > 0.0:
            value = of_lines[i, 3 * q.shape[0]]
            for s in range(q.shape[0]):
                for j in range(3):
                    value += of_lines[i, 3 * s + j] * q[s, j]
            lines[i, t.LINE_VALUE] = value + _chord_excess(sections, lines, i, q)


def _chord_excess(sections: Array, lines: Array, i: int, q: Array) -> float:
    """By how much straight line i is longer than one along arcs that nothing loads: negative."""
    total, k = 0.0, 0
    if lines[i, t.STRAIGHT] > 0.0:
        for s in range(q.shape[0]):
            if lines[i, t.FIRST_ARC] <= k <= lines[i, t.LAST_ARC]:
                long = q[s, 2] - lines[i, t.ARM] * q[s, 0] - lines[i, t.ARM + 1] * q[s, 1]
                total += _chord_share(sections, s, q)[0] * long
            k += int(sections[s, t.ARC_COUNT])
    return total


def _chord_share(sections: Array, s: int, q: Array) -> tuple[float, float]:
    """Share by which chords of section `s` are longer than its arcs, and its slope by a bend, divided by that bend."""
    over = 0.5 / sections[s, t.ARC_COUNT]
    half = over * math.hypot(q[s, 0], q[s, 1])
    if half < SMALL:
        return -half * half / 6.0, -over * over / 3.0
    sinc = math.sin(half) / half
    return sinc - 1.0, over * over * (math.cos(half) - sinc) / (half * half)


def _chord_slope(sections: Array, lines: Array, i: int, q: Array, s: int, c: int) -> float:
    """How the same changes with coordinate `c` of section `s`, through which the line runs."""
    shorter, steep = _chord_share(sections, s, q)
    if c == 2:
        return shorter
    long = q[s, 2] - lines[i, t.ARM] * q[s, 0] - lines[i, t.ARM + 1] * q[s, 1]
    return steep * q[s, c] * long - shorter * lines[i, t.ARM + c]


@entry
def differentiate_equilibrium(
    base: Array,
    arcs: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    x: Array,
    tensions: Array,
    sections: Array,
    of_lines: Array,
    q: Array,
    buffer: Array,
    columns: Array,
    pulls: Array,
) -> None:
    """Fill `columns` (3 n, N, 4) and `pulls` (3 n, t): how states and tensions change with the drive.

    `x` and `tensions` are an equilibrium at the drive `q`; `slopes` rows for lengths in arcs; `of_lines` (t, 3 n + 1)
    as for `fill_body_tables`. `buffer` has `newton.workspace_size` numbers.
    """
    body, space = lay_out(base, arcs, loads, lines, slopes, buffer)
    find_taut(lines, tensions, space)
    evaluate_state(x, tensions, body, 1.0, space)
    differentiate_by_drive(sections, of_lines, q, x, body, space, columns, pulls)


@shared
def differentiate_by_drive(
    sections: Array, of_lines: Array, q: Array, x: Array, body: Body, space: Workspace, columns: Array, pulls: Array
) -> None:
    """Fill `columns` (3 n, N, 4) and `pulls` (3 n, t), see `differentiate_equilibrium`.

    `x` is an equilibrium that was just evaluated; `of_lines` (t, 3 n + 1).
    """
    lines, first = body.lines, 0
    fill_replies(lines, x.shape[0], space)
    for s in range(q.shape[0]):
        for c in range(3):
            at = 3 * s + c
            own = columns[at]
            _fill_right_side(sections, x, body.arcs, first, s, c, space.stages, own, space.trial)
            solve(own, space.trial, space.stages, own)
            for i in range(lines.shape[0]):
                pulls[at, i] = -of_lines[i, at]
                if lines[i, t.STRAIGHT] > 0.0 and lines[i, t.FIRST_ARC] <= first <= lines[i, t.LAST_ARC]:
                    pulls[at, i] -= _chord_slope(sections, lines, i, q, s, c)
            hold_taut(lines, space, own, pulls[at])
        first += int(sections[s, t.ARC_COUNT])


def _fill_right_side(
    sections: Array, x: Array, arcs: Array, first: int, s: int, c: int, stages: Array, wanted: Array, given: Array
) -> None:
    """Fill the change of residuals by coordinate `c` of section `s`, `wanted` (N, 4), and that of rigid states `given`.

    The first arc of the section is `first`; `given` (N, 4) is 0 for states that are not rigid.
    """
    count, fraction = int(sections[s, t.ARC_COUNT]), 1.0 / sections[s, t.ARC_COUNT]
    weight = scale(fraction, get_vec(sections, s, t.HEAVY))
    wanted[:], given[:] = 0.0, 0.0
    moment, force = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(first + count - 1, -1, -1):
        if c == 2:
            for i in range(4):
                omega, v = get_vec(stages, k, t.TWIST_COLUMNS + 6 * i), get_vec(stages, k, t.TWIST_COLUMNS + 6 * i + 3)
                wanted[k, i] += dot(omega, moment) + dot(v, force)
        if k >= first and c == 2:
            _add_length(x, arcs, k, fraction, wanted, given)
            for i in range(3):
                wanted[k, i if i < 2 else t.LENGTH] += dot(weight, get_vec(stages, k, t.CENTER_COLUMNS + 3 * i))
            moment, force = add(moment, cross(get_vec(stages, k, t.ARC_CENTER), weight)), add(force, weight)
        elif k >= first:
            _add_bend(x, arcs, k, c, fraction, sections[s, t.PULLED] > 0.0, wanted, given)
    impose_rigid_changes(given, stages, wanted)


def _add_length(x: Array, arcs: Array, k: int, fraction: float, wanted: Array, given: Array) -> None:
    """Add what a longer section does to arc k, to `wanted` (N, 4) and `given` (N, 4): longer arcs are softer."""
    over = fraction / arcs[k, t.REST_LENGTH] if arcs[k, t.REST_LENGTH] > 0.0 else 0.0
    bend, torsion, stretch = arcs[k, t.BEND_STIFFNESS], arcs[k, t.TORSION_STIFFNESS], arcs[k, t.STRETCH_STIFFNESS]
    if bend < t.RIGID:
        vx, vy = x[k, t.BEND_X], x[k, t.BEND_Y]
        rx, ry, _ = mat_vec(about_z(0.5 * x[k, t.TORSION]), (arcs[k, t.REST_X], arcs[k, t.REST_Y], 0.0))
        wanted[k, t.BEND_X] += over * bend * (vx - rx)
        wanted[k, t.BEND_Y] += over * bend * (vy - ry)
        wanted[k, t.TORSION] += over * 0.5 * bend * (vx * ry - vy * rx)
    if torsion < t.RIGID:
        wanted[k, t.TORSION] += over * torsion * x[k, t.TORSION]
    if stretch < t.RIGID:
        wanted[k, t.LENGTH] += over * stretch * x[k, t.LENGTH]
    else:
        given[k, t.LENGTH] = fraction


def _add_bend(x: Array, arcs: Array, k: int, c: int, share: float, pulled: bool, wanted: Array, given: Array) -> None:
    """Add what more bend does to arc k, to `wanted` (N, 4) and `given` (N, 4): nothing where lines bend the section."""
    bend = arcs[k, t.BEND_STIFFNESS]
    if bend >= t.RIGID:
        given[k, c] = share
    elif not pulled:
        more = (share, 0.0, 0.0) if c == 0 else (0.0, share, 0.0)
        rx, ry, _ = mat_vec(about_z(0.5 * x[k, t.TORSION]), more)
        wanted[k, t.BEND_X] += bend * rx
        wanted[k, t.BEND_Y] += bend * ry
        wanted[k, t.TORSION] -= 0.5 * bend * (x[k, t.BEND_X] * ry - x[k, t.BEND_Y] * rx)
