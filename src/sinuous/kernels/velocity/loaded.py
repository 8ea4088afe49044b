"""One control step of a body in equilibrium: where it goes, and what is proved of the way there.

The way of a control step is that of its motors, which run evenly. Bodies on it are those of arcs linear between two
shapes, but for how far equilibria leave these (`statics.departure`): so for a thicker body. Tensions are within the
straight line between both ends, but for how far stretches leave it. What is undecided is halved.

`asked` (w,) is the group of `layout`, `answer` (w,) that of `query`; `of_lines` (t, 3 n + 1) as in `statics.drive`;
`stretches` (t, 2), `carried` (k, 10) see `Tables`, `held` (2, t) see `Way`; `seen` (2, 6) and `now` (2, 6) as in
`certificate.proof`; `start` (n, 3) is a drive.
"""

import math
from collections import namedtuple

from sinuous.base.progress import WORK_UNIT
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.kernels.certificate.obstacles import Accuracy
from sinuous.kernels.certificate.proof import certify, forget
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, LEAST_SEEN, PROVED_BOUND, SEGMENT, WHEN, Motion
from sinuous.kernels.chain.kinematics import interpolate, shorten
from sinuous.kernels.clock import allow_work, begin, late, spend, work_left
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.departure import (
    CLOSE,
    COARSE,
    DEPARTURE_WIDTH,
    DEVIATION,
    OFF,
    Departure,
    Way,
    bound_departure,
    carve_departure,
    departure_size,
    fill_tables_between,
    stretch_of,
)
from sinuous.kernels.statics.drive import fill_tables
from sinuous.kernels.statics.ends import put_ends
from sinuous.kernels.statics.equilibrium import (
    EQUILIBRIUM_WIDTH,
    LOAD_FACTOR,
    equilibrate_body,
    equilibrate_near,
    is_stable,
)
from sinuous.kernels.statics.newton import Body, carve, copy_state, workspace_size
from sinuous.kernels.step.newton import FINEST_PROOF
from sinuous.kernels.tables import MAX_BEND, MAX_CURVATURE, MAX_LENGTH, MIN_LENGTH, RADIUS, SEGMENT_WIDTH, SELF_RADIUS
from sinuous.kernels.velocity import query as k
from sinuous.kernels.velocity.body import RestingBody, hold_rigid, owner_of, unroll
from sinuous.kernels.velocity.layout import (
    BEND_CHANGE,
    BOUND_WIDTH,
    LENGTH_CHANGE,
    Control,
    StepRequest,
    carve_control,
    control_size,
    most_bounds,
    most_constraints,
    read_asked,
)

NO_BODY = -1.0
"""The verdict about a start, or an end, at which no equilibrium was found."""

TENSE = -2.0
"""The verdict about a way on which a tension may leave its limits."""

HALVINGS = 6
"""How often a way is halved."""

SHRINKS = (1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 1.0)
"""By how much a step is shortened until rounding leaves it within limits and rates."""

TENSION_ROUNDING = 1e-9
"""By how much a stretch may leave its limits, in mean lengths of the robot: what rounding may do."""

Stack = namedtuple("Stack", ["shares", "x", "tensions"])
"""Shapes ahead of where a proof has come to: the shares of the way where they are (h,), states (h, N, 4) and tensions
(h, t)."""

Proof = namedtuple("Proof", ["departure", "limits", "seen"])
"""What bounds how far equilibria leave a piece of the way; limits of arcs that are so much thicker (N, 8); and what the
proof saw of it (2, 6)."""

Tables = tuple[Array, Array, Array, Array, int]
"""A robot as `statics.drive` has it, whatever its drive: sections (n, 23), least and greatest stretches of lines
(t, 2), loads (k, 10), lines (t, 10), and rows for lengths of lines in arcs."""


def loaded_size(segments: int, arcs: int, obstacles: int, targets: int, actuators: int, lines: int, slopes: int) -> int:
    """Numbers (float64) that a control step of a body in equilibrium takes from a buffer."""
    n, N, r = segments, arcs, max(6, 6 * targets)
    bounds = most_bounds(N, obstacles, 0) + actuators + lines
    drive = control_size(n, 0, targets, 0) + bounds * (3 * n + BOUND_WIDTH)
    body = control_size(N, obstacles, 0, 0)
    own = 3 * n + 16 * N + 4 * lines + 3 * n * (7 * N + lines + 6 + r) + r * (2 * r + 1) + t.ARC_WIDTH * N
    way = (
        9 * n
        + 6 * lines
        + (8 + SEGMENT_WIDTH) * N
        + 12
        + (HALVINGS + 2) * (1 + 4 * N + lines)
        + departure_size(n, N, lines)
    )
    return drive + body + own + way + workspace_size(N, lines, slopes) + EQUILIBRIUM_WIDTH


def _carve(
    buffer: Array, problem: Problem, arcs: Problem, tables: Tables, of_lines: Array, actuators: int
) -> tuple[Control, Array]:
    """Lay out the workspace; returns what is left of it, too. `problem` is of the robot, `arcs` of its body."""
    sections, stretches, carried, lines, slopes = tables
    n, N, m, count = sections.shape[0], arcs.limits.shape[0], number_of(problem.scene), lines.shape[0]
    targets = problem.targets.shape[0]
    r, bounds = max(6, 6 * targets), most_bounds(N, m, 0) + actuators + count
    size = control_size(N, m, 0, 0)
    of_arcs, rest = carve_control(buffer, arcs.base, (N, m, 6, most_bounds(N, m, 0), 0), None), buffer[size:]
    for i in range(N):
        for j in range(9):
            of_arcs.root[i, j] = 1.0 if j % 4 == 0 else 0.0
    space, rest = carve(rest, problem.base, N, count, slopes)
    record, rest = rest[:EQUILIBRIUM_WIDTH], rest[EQUILIBRIUM_WIDTH:]
    at, rest = cut(rest, n, 3)
    x, rest = cut(rest, N, t.STATE_WIDTH)
    trial_x, rest = cut(rest, N, t.STATE_WIDTH)
    unloaded, rest = cut(rest, N, t.STATE_WIDTH)
    tensions, rest = rest[:count], rest[count:]
    trial_tensions, rest = rest[:count], rest[count:]
    began, rest = rest[:count], rest[count:]
    table, rest = cut(rest, N, t.ARC_WIDTH)
    size = 12 * n * N
    columns, rest = shaped(rest[:size], (3 * n, N, 4)), rest[size:]
    size = 9 * n * N
    by_drive, rest = shaped(rest[:size], (3 * n, N, 3)), rest[size:]
    pulls, rest = cut(rest, 3 * n, count)
    tip, rest = cut(rest, 6, 3 * n)
    seen, rest = cut(rest, r, 3 * n)
    system, rest = cut(rest, r, r)
    scratch, rest = cut(rest, r, r + 1)
    columns[:], pulls[:], tip[:] = 0.0, 0.0, 0.0
    body = RestingBody(
        arcs,
        of_arcs,
        sections,
        of_lines,
        stretches,
        Body(table, carried, lines),
        space,
        record,
        at,
        x,
        tensions,
        trial_x,
        trial_tensions,
        unloaded,
        columns,
        pulls,
        by_drive,
        tip,
        seen,
        system,
        scratch,
        began,
    )
    control = carve_control(rest, problem.base, (n, 0, r, bounds, most_constraints(n)), body)
    return control, rest[control_size(n, 0, targets, 0) + bounds * (3 * n + BOUND_WIDTH) :]


@entry
def loaded_step(
    robot: Array,
    arcs: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    asked: Array,
    sections: Array,
    stretches: Array,
    carried: Array,
    lines: Array,
    slopes: int,
    of_lines: Array,
    start: Array,
    x: Array,
    tensions: Array,
    workspace: Array,
    tip: Array,
    answer: Array,
) -> float:
    """Go on from the drive `start` (n, 3), as `asked` says, within all bounds; nothing is proved of the way.

    As `query.control_step`; beside the group of the robot there is that of its body of `arcs`. `sections` to `slopes`
    see `Tables`, `of_lines` (t, 3 n + 1) `statics.drive.fill_body_tables`; states `x` and `tensions` are those of the
    start, NaN where they are not known, and become those where the last step but one led. `workspace`: see
    `loaded_size`. Fills `tip` (6, 3 n), how the tool turns and moves with the drive, and of `answer` how many steps
    there were, where it goes, active constraints, and of several steps errors of the targets. It ends after work that
    is worth the seconds that are asked for, and returns the work units that are left: an answer does not depend on the
    machine.
    """
    problem = read_problem(robot, scene, settings, targets)
    wanted = read_asked(asked, start.shape[0])
    tables = sections, stretches, carried, lines, slopes
    actuators = wanted.actuators.shape[0]
    body = read_problem(arcs, scene, settings, targets)
    work, _ = _carve(workspace, problem, body, tables, of_lines, actuators)
    begin(work.sweep.clock)
    allow_work(work.sweep.clock, wanted.seconds / WORK_UNIT)
    copy(start, work.q)
    copy(start, work.trial)
    work.body.record[LOAD_FACTOR] = 0.0
    if math.isnan(x[0, 0]) and not _find_body(work.body, start, x, tensions):
        answer[k.ROUNDS] = answer[k.ACTIVE] = 0.0
        answer[k.POSITION_ERROR] = answer[k.ANGLE_ERROR] = math.inf
        k.write_end(work, answer)
        return 0.0
    _begin_with(work.body, start, x, tensions)
    k.set_free(problem, work)
    answer[k.ROUNDS], count, errors = k.advance(problem, wanted, work, start)
    answer[k.POSITION_ERROR], answer[k.ANGLE_ERROR] = errors
    copy_state(work.body.x, work.body.tensions, x, tensions)
    _shrink(problem, wanted, work, start)
    k.report(work, count, answer)
    copy(work.body.tip, tip)
    k.write_end(work, answer)
    return work_left(work.sweep.clock)


def _shrink(problem: Problem, asked: StepRequest, work: Control, start: Array) -> None:
    """Shorten a step until all limits and rates are kept exactly: they are convex, and hold for no motion."""
    copy(work.trial, work.step)
    for i in range(len(SHRINKS)):
        if _keeps(problem, asked, work.trial, start):
            return
        copy(work.step, work.trial)
        shorten(start, work.trial, 1.0 - SHRINKS[i])
    copy(start, work.trial)


def _keeps(problem: Problem, asked: StepRequest, q: Array, start: Array) -> bool:
    """Whether all limits and rates of segments are kept; what is exceeded at the start, no more than there."""
    for s in range(q.shape[0]):
        limits, rates, curvature = problem.limits[s], asked.rates[s], problem.limits[s, MAX_CURVATURE]
        bend, bent = math.hypot(q[s, 0], q[s, 1]), math.hypot(start[s, 0], start[s, 1])
        if bend > max(limits[MAX_BEND], bent):
            return False
        if curvature < math.inf and bend > max(curvature * q[s, 2], bent - curvature * (start[s, 2] - q[s, 2])):
            return False
        if not min(limits[MIN_LENGTH], start[s, 2]) <= q[s, 2] <= max(limits[MAX_LENGTH], start[s, 2]):
            return False
        turned, longer = math.hypot(q[s, 0] - start[s, 0], q[s, 1] - start[s, 1]), abs(q[s, 2] - start[s, 2])
        if turned > rates[BEND_CHANGE] or longer > rates[LENGTH_CHANGE]:
            return False
    return True


def _begin_with(own: RestingBody, start: Array, x: Array, tensions: Array) -> None:
    """Let a body be at rest at the drive `start` (n, 3)."""
    copy(start, own.at)
    copy_state(x, tensions, own.x, own.tensions)
    for i in range(tensions.shape[0]):
        own.began[i] = own.body.lines[i, t.COMPLIANCE] * tensions[i]


@entry
def certify_step(
    robot: Array,
    arcs: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    sections: Array,
    stretches: Array,
    carried: Array,
    lines: Array,
    slopes: int,
    of_lines: Array,
    q: Array,
    held: Array,
    x: Array,
    tensions: Array,
    moves: bool,
    units: float,
    workspace: Array,
    answer: Array,
) -> float:
    """Find the equilibrium at the end of a way, and prove the way there as far as it is within all limits and clear.

    Unless it `moves`, only what is at the end is proved, and clearances that are not proved are those that were seen.

    Of the `Way` its first shape is known. `of_lines` (t, 3 n + 1) are those of the end, the rest as for `loaded_step`.
    Fills the end of the way, and of `answer` the verdict (`query.START`: CLEAR, NO_BODY, TENSE, or what the proof came
    to), until when that is proved (`query.STEP_FRACTION`), the proved clearances of the end, what the proof saw, and
    errors of targets. It ends after so many work `units`, and returns those that are left.
    """
    problem = read_problem(robot, scene, settings, targets)
    tables = sections, stretches, carried, lines, slopes
    body = read_problem(arcs, scene, settings, targets)
    work, rest = _carve(workspace, problem, body, tables, of_lines, 0)
    own, way = work.body, Way(q, held, x, tensions)
    begin(work.sweep.clock)
    allow_work(work.sweep.clock, units)
    _begin_with(own, q[0], x[0], tensions[0])
    seen = shaped(answer[k.CLEARANCES : k.CONFIGURATION], (2, CLEARANCES_WIDTH))
    forget(seen)
    answer[k.STEP_FRACTION] = 0.0
    answer[k.CLEARANCE] = answer[k.SELF_CLEARANCE] = -math.inf
    answer[k.MERIT] = answer[k.POSITION_ERROR] = answer[k.ANGLE_ERROR] = math.inf
    if not _find_end(own, way):
        answer[k.START] = NO_BODY
        return work_left(work.sweep.clock)
    answer[k.START] = verdict = _evaluate_end(problem, work, own, way, answer)
    if moves:
        if verdict != CLEAR:
            answer[k.CLEARANCE] = answer[k.SELF_CLEARANCE] = -math.inf
        answer[k.START], answer[k.STEP_FRACTION] = _certify_way(problem, own, way, seen, rest)
    return work_left(work.sweep.clock)


def _find_end(own: RestingBody, way: Way) -> bool:
    """Find the end of a way from the body without load, as whoever asks for its shape does; say whether there is one.

    So an answer does not depend on what was asked before.
    """
    found = _find_body(own, way.q[1], way.x[1], way.tensions[1])
    for i in range(way.held.shape[1]):
        way.held[1, i] = own.body.lines[i, t.LINE_VALUE]
    return found


def _find_body(own: RestingBody, q: Array, x: Array, tensions: Array) -> bool:
    """Fill states (N, 4) and tensions (t,) at a drive (n, 3), found from the body without load."""
    fill_tables(own.sections, own.of_lines, q, own.body.arcs, own.body.lines, x)
    tensions[:] = 0.0
    equilibrate_body(x, tensions, own.body, True, own.space, own.record)
    return is_stable(own.record)


def _evaluate_end(problem: Problem, work: Control, own: RestingBody, way: Way, answer: Array) -> int:
    """Fill clearances of the body where it was just found at rest, the end of a way, and errors of targets.

    Returns the verdict about it.
    """
    put_ends(own.sections, own.space.frames, work.frames)
    _, answer[k.POSITION_ERROR], answer[k.ANGLE_ERROR] = k.list_targets(problem, work)
    answer[k.MERIT] = k.merit_of(work)
    unroll(way.x[1], own.arcs.trial)
    verdict, answer[k.CLEARANCE], answer[k.SELF_CLEARANCE] = k.prove_shape(own.problem, own.arcs, own.arcs.trial)
    return verdict


@shared
def _certify_way(problem: Problem, own: RestingBody, way: Way, seen: Array, buffer: Array) -> tuple[float, float]:
    """Verdict about a way between two shapes, and until when everything is proved; fills `seen` (2, 6)."""
    n, N, count = way.q.shape[1], way.x.shape[1], way.tensions.shape[1]
    piece, stack, proof = _carve_way(buffer, own, n, N, count)
    copy_state(way.x[0], way.tensions[0], piece.x[0], piece.tensions[0])
    copy_state(way.x[1], way.tensions[1], stack.x[0], stack.tensions[0])
    stack.shares[0] = 1.0
    height, share, clock = 1, 0.0, own.arcs.sweep.clock
    while height > 0:
        end = stack.shares[height - 1]
        copy_state(stack.x[height - 1], stack.tensions[height - 1], piece.x[1], piece.tensions[1])
        _put_drive(way, share, piece, 0)
        _put_drive(way, end, piece, 1)
        verdict, until = _certify_piece(problem, own, piece, proof, (share, end), seen)
        if verdict == CLEAR:
            share, height = end, height - 1
            copy_state(piece.x[1], piece.tensions[1], piece.x[0], piece.tensions[0])
        elif end - share > 0.5**HALVINGS and not late(clock) and _find_middle(own, piece, proof.departure):
            stack.shares[height] = 0.5 * (share + end)
            copy_state(own.trial_x, own.trial_tensions, stack.x[height], stack.tensions[height])
            height += 1
        else:
            return verdict, share + until * (end - share)
    return float(CLEAR), 1.0


def _carve_way(buffer: Array, own: RestingBody, n: int, N: int, count: int) -> tuple[Way, Stack, Proof]:
    high = HALVINGS + 2
    q, rest = shaped(buffer[: 6 * n], (2, n, 3)), buffer[6 * n :]
    held, rest = cut(rest, 2, count)
    x, rest = shaped(rest[: 8 * N], (2, N, 4)), rest[8 * N :]
    tensions, rest = cut(rest, 2, count)
    shares, rest = rest[:high], rest[high:]
    states, rest = shaped(rest[: 4 * high * N], (high, N, 4)), rest[4 * high * N :]
    pulls, rest = cut(rest, high, count)
    still, rest = cut(rest, n, 3)
    still[:] = 0.0
    limits, rest = cut(rest, N, SEGMENT_WIDTH)
    seen, rest = cut(rest, 2, CLEARANCES_WIDTH)
    departure = carve_departure(rest, own.sections, own.body.loads, own.body.lines, still, N)
    return Way(q, held, x, tensions), Stack(shares, states, pulls), Proof(departure, limits, seen)


def _put_drive(way: Way, share: float, piece: Way, end: int) -> None:
    """Put the drive at a share of the way to one end of a piece of it."""
    interpolate(way.q[0], way.q[1], share, piece.q[end])
    for i in range(way.held.shape[1]):
        piece.held[end, i] = (1.0 - share) * way.held[0, i] + share * way.held[1, i]


def _find_middle(own: RestingBody, piece: Way, departure: Departure) -> bool:
    """Find the equilibrium half-way, into the state that is tried."""
    fill_tables_between(departure, piece, 0.5, own.body.arcs)
    copy_state(departure.x, departure.tensions, own.trial_x, own.trial_tensions)
    hold_rigid(own.body.arcs, departure.states, own.trial_x)
    equilibrate_near(own.trial_x, own.trial_tensions, own.body, own.space, own.record)
    return is_stable(own.record)


def _certify_piece(
    problem: Problem, own: RestingBody, piece: Way, scratch: Proof, shares: tuple[float, float], seen: Array
) -> tuple[float, float]:
    """Verdict about a piece of a way, and until when of it everything is proved; adds to what was `seen`.

    By a bound that is quickly found, and by a tight one where that does not suffice.
    """
    verdict, until = float(UNDECIDED), 0.0
    for accuracy in (COARSE, CLOSE):
        bound_departure(scratch.departure, piece, own.space, accuracy, own.record[:DEPARTURE_WIDTH])
        spend(own.arcs.sweep.clock, t.ARC_WORK * own.x.shape[0])
        deviation, off = own.record[DEVIATION], own.record[OFF]
        if deviation < math.inf:
            verdict, until = TENSE, 0.0
            if _keeps_tensions(problem, own, piece, scratch.departure, off):
                verdict, until = _certify_thicker(problem, own, piece, scratch, deviation)
                if verdict == CLEAR or accuracy == CLOSE:
                    _join_seen(own, scratch.seen, shares, seen)
        if verdict == CLEAR:
            break
    return verdict, until


def _keeps_tensions(problem: Problem, own: RestingBody, piece: Way, departure: Departure, off: float) -> bool:
    """Whether all tensions are within their limits on a piece of the way, no more beyond them than at the beginning."""
    rounding = TENSION_ROUNDING * problem.unit
    for i in range(own.tensions.shape[0]):
        more = off * departure.sizes[i] - rounding
        least, most = min(own.stretches[i, 0], own.began[i]), max(own.stretches[i, 1], own.began[i])
        for end in range(2):
            stretch = stretch_of(own.body.lines, i, piece.held[end, i], piece.tensions[end, i], piece.x[end])
            if stretch - more < least or stretch + more > most:
                return False
    return True


def _certify_thicker(
    problem: Problem, own: RestingBody, piece: Way, scratch: Proof, deviation: float
) -> tuple[float, float]:
    """Verdict about the way linear in arcs, for a body that is thicker by so much, and until when it is clear."""
    limits, arcs = scratch.limits, own.arcs
    unroll(piece.x[0], arcs.q)
    unroll(piece.x[1], arcs.trial)
    copy(own.problem.limits, limits)
    for j in range(limits.shape[0]):
        limits[j, MAX_LENGTH] = max(limits[j, MAX_LENGTH], arcs.q[j, 2], arcs.trial[j, 2])
        limits[j, RADIUS], limits[j, SELF_RADIUS] = limits[j, RADIUS] + deviation, limits[j, SELF_RADIUS] + deviation
    aim = Accuracy(1.0, FINEST_PROOF * problem.unit, 0.0, problem.mount, True)
    motion = Motion(limits, arcs.q, arcs.trial, problem.scene, own.problem.avoids_itself, arcs.sweep.still)
    verdict, until = certify(motion, arcs.sweep, aim, scratch.seen)
    return float(verdict), until


def _join_seen(own: RestingBody, now: Array, shares: tuple[float, float], seen: Array) -> None:
    """Add what was seen of a piece of the way to what was `seen` (2, 6) of all."""
    for row in range(2):
        lowest = min(seen[row, PROVED_BOUND], now[row, PROVED_BOUND])
        if now[row, LEAST_SEEN] < seen[row, LEAST_SEEN]:
            for i in range(CLEARANCES_WIDTH):
                seen[row, i] = now[row, i]
            seen[row, WHEN] = shares[0] + (shares[1] - shares[0]) * now[row, WHEN]
            seen[row, SEGMENT] = owner_of(own, now[row, SEGMENT])
        seen[row, PROVED_BOUND] = lowest
