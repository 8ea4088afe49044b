"""Correction of a drive until the body under load meets the targets: Newton's method with the body in equilibrium.

Every round derives the equilibrium by the drive, and takes the least damped step that meets the targets to first order
within the limits of segments, as the step of `kernels.step.newton`; limits of actuators and of tensions that a step
would leave are rows of it. The body at the end of a step is found from the one that the derivative predicts.
"""

from collections import namedtuple

from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.chain.kinematics import frame, put_frame
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    add,
    add_scaled,
    copy,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    put_vec,
    scale,
    vec_mat,
)
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.statics import equilibrium as e
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.drive import answer_drive, fill
from sinuous.kernels.statics.ends import foretell, put_ends, see_ends
from sinuous.kernels.statics.newton import Body, Workspace, carve, workspace_size
from sinuous.kernels.step import limits
from sinuous.kernels.step.coupling import LEAST_PIVOT
from sinuous.kernels.step.dense import solve_symmetric
from sinuous.kernels.step.targets import add_rows, end_segment
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE

MOST_ROUNDS = 25
"""Corrections from one start."""

SLOW_RATIO, SLOW_ROUNDS = 0.9, 4
"""Corrections end after so many in a row that leave more than this share of what was left, squared."""

TOLERANCE_SHARE = 0.2
"""Share of the tolerances within which corrections end."""

MOST_STEPS = 6
"""Steps in which the body at the end of a correction is found from what is foretold, or the correction is too long."""

MOST_LENGTHS, SHORTER_RATIO = 5, 0.4
"""Most lengths of a correction that are tried, each this share of the one before."""

CORRECTION_DAMPING = 1e-6
"""Of a correction, relative to the squares of all derivatives."""

LARGEST = 0.7
"""Most that a bend changes in a correction, rad; and a length, in mean lengths of a segment."""

INSET, EXCESS_ROUNDING = 1e-9, 5e-12
"""How far within their limits corrections keep actuators and tensions, and excess that is rounding, in mean lengths of
the robot."""

MOST_ACTIVE_SETS = 8
"""Most times that a correction is computed anew along other limits."""

OFF, ANGLE, EXCESS, MERIT, ROUNDS, STABLE = range(6)
"""Places in the record: largest position error (length) and angle error (rad), excess over limits of actuators and
tensions (length), sum of the squares of what is left; how many rounds; 1 where a stable equilibrium was found."""

CORRECTION_WIDTH = 6

Drive = namedtuple("Drive", ["sections", "of_lines", "bounds", "pulls"])
"""The robot as `statics.drive` has it; limits of actuators (a, 3 n + 2), the derivative of a displacement by the drive,
then its least and most; and least and most stretch of lines (t, 2), infinite where there are no such limits."""

Equilibrium = namedtuple("Equilibrium", ["q", "x", "tensions", "record"])
"""A drive (n, 3), states (N, 4), tensions (t,); and the record (10,) of the search for the latter."""

Step = namedtuple("Step", "ends rows columns pulls jacobian weights values side listed system root mean bound change")
"""Frames of the base and of ends of segments (n + 1, 12) and rows of targets; derivatives of states (3 n, N, 4) and
tensions (3 n, t). Of r rows, those of targets, then limits of actuators, then of tensions: derivatives (r, 3 n), the
same in units of the metric, and least and most motion (r, 2), alike for targets; which side of it is kept, 1 the least,
2 the most, 0 none; the numbers of those that are kept; and their system (r, r + 1). What `step.limits` reads: root
(n, 9), mean (n, 3) and what is bound (n,). And the change of the drive (n, 3)."""


def correction_size(segments: int, arcs: int, lines: int, slopes: int, targets: int, actuators: int) -> int:
    """Numbers that `correct` takes from a buffer."""
    n, r, state = segments, 6 * targets + actuators + lines, 4 * arcs + lines
    step = 12 * (n + 1) + rows_size(n, 6 * targets) + 3 * n * state + r * (6 * n + 5 + r) + 16 * n
    return workspace_size(arcs, lines, slopes) + t.ARC_WIDTH * arcs + 3 * n + state + e.EQUILIBRIUM_WIDTH + step


@entry
def correct(
    robot: Array,
    settings: Array,
    targets: Array,
    sections: Array,
    of_lines: Array,
    bounds: Array,
    pulls: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    q: Array,
    x: Array,
    tensions: Array,
    buffer: Array,
    record: Array,
) -> None:
    """Correct the drive `q` (n, 3) in place; `x` (N, 4) and `tensions` (t,) become those of its equilibrium.

    `robot`, `settings` and `targets` (m, 15) as in `tables`; `sections` (n, 23), loads (k, 10) and lines (t, 10) as in
    `statics.layout`; `of_lines` (t, 3 n + 1) see `statics.drive.lay_out`; `bounds` (a, 3 n + 2) and `pulls` (t, 2) see
    `Drive`. Where the record (6,) says that an equilibrium was found the search begins with it, else without load.
    `buffer` has `correction_size` numbers.
    """
    problem, drive = read_problem(robot, None, settings, targets), Drive(sections, of_lines, bounds, pulls)
    n, count = q.shape[0], x.shape[0]
    space, rest = carve(buffer, count, lines.shape[0], slopes)
    rotation, position = frame(problem.base, 0)
    put_frame(space.frames, 0, rotation, position)
    arcs, rest = cut(rest, count, t.ARC_WIDTH)
    trial, step = _carve(rest, n, count, lines.shape[0], targets.shape[0], bounds.shape[0])
    body = Body(arcs, loads, lines)
    limits.move(problem.limits, q, step.mean, q)
    fill(sections, of_lines, q, arcs, lines, trial.x)
    if record[STABLE] == 0.0:
        copy(trial.x, x)
        tensions[:] = 0.0
    own = Equilibrium(q, x, tensions, trial.record)
    e.settle(x, tensions, body, True, space, own.record)
    _correct(problem, drive, own, trial, body, space, step, record)


@shared
def _correct(
    problem: Problem,
    drive: Drive,
    own: Equilibrium,
    trial: Equilibrium,
    body: Body,
    space: Workspace,
    step: Step,
    record: Array,
) -> None:
    """Correct from a body at rest.

    The compiler may not see where in the buffer everything is: it takes ten seconds to compute with that.
    """
    _evaluate(problem, drive, own, body, space, step, record)
    slow = 0
    for rounds in range(MOST_ROUNDS):
        record[ROUNDS], before = rounds, record[MERIT]
        if record[STABLE] == 0.0 or _enough(problem, record) or slow == SLOW_ROUNDS:
            return
        answer_drive(drive.sections, drive.of_lines, own.q, own.x, body, space, step.columns, step.pulls)
        _find_step(problem, own.q, step, _derive(problem, drive, own, body, space, step))
        if not _line_search(problem, drive, own, trial, body, space, step, record):
            return
        slow = slow + 1 if record[MERIT] > SLOW_RATIO * before else 0
    record[ROUNDS] = MOST_ROUNDS


def _carve(rest: Array, n: int, arcs: int, lines: int, targets: int, actuators: int) -> tuple[Equilibrium, Step]:
    """Lay out what else is needed."""
    q, rest = cut(rest, n, 3)
    x, rest = cut(rest, arcs, t.STATE_WIDTH)
    tensions, rest = rest[:lines], rest[lines:]
    found, rest = rest[: e.EQUILIBRIUM_WIDTH], rest[e.EQUILIBRIUM_WIDTH :]
    ends, rest = cut(rest, n + 1, 12)
    size, r = rows_size(n, 6 * targets), 6 * targets + actuators + lines
    rows, rest = pick_rows(carve_rows(rest[:size], 1, n, 6 * targets), 0), rest[size:]
    size = 12 * n * arcs
    columns, rest = shaped(rest[:size], (3 * n, arcs, 4)), rest[size:]
    pulls, rest = cut(rest, 3 * n, lines)
    jacobian, rest = cut(rest, r, 3 * n)
    weights, rest = cut(rest, r, 3 * n)
    values, rest = cut(rest, r, 2)
    side, rest = cut_whole(rest, r)
    listed, rest = cut_whole(rest, r)
    system, rest = cut(rest, r, r + 1)
    root, rest = cut(rest, n, 9)
    mean, rest = cut(rest, n, 3)
    bound, rest = cut_whole(rest, n)
    change, rest = cut(rest, n, 3)
    mean[:] = 0.0
    shape = Equilibrium(q, x, tensions, found)
    step = Step(ends, rows, columns, pulls, jacobian, weights, values, side, listed, system, root, mean, bound, change)
    return shape, step


def _enough(problem: Problem, record: Array) -> bool:
    """Whether targets are met, within all limits. A tolerance that is not asked for leaves no error."""
    met = (
        record[OFF] <= TOLERANCE_SHARE * problem.position_tolerance
        and record[ANGLE] <= TOLERANCE_SHARE * problem.angle_tolerance
    )
    return bool(met and record[EXCESS] <= EXCESS_ROUNDING * problem.unit)


def _evaluate(
    problem: Problem, drive: Drive, shape: Equilibrium, body: Body, space: Workspace, step: Step, record: Array
) -> None:
    """Examine a body at rest at its drive; fill the record and the rows of targets."""
    record[STABLE] = 1.0 if shape.record[e.LOAD_FACTOR] >= 1.0 and shape.record[e.UNSTABLE] == 0.0 else 0.0
    if record[STABLE] == 0.0:
        return
    n, at, origin = shape.q.shape[0], 0, frame(space.frames, 0)[1]
    off = turn = excess = merit = 0.0
    put_ends(drive.sections, space.frames, step.ends)
    for s in range(n):
        step.rows.start[s] = at
        for i in range(problem.targets.shape[0]):
            if end_segment(problem.targets, i, n) == s:
                at, miss, angle = add_rows(
                    problem.targets, i, step.ends, problem.tool, origin, problem.unit, step.rows, at
                )
                off, turn = max(off, miss), max(turn, angle)
    step.rows.start[n] = at
    for i in range(at):
        merit += step.rows.value[i] * step.rows.value[i]
    for i in range(drive.bounds.shape[0]):
        value, low, high = _actuator(drive, i, shape.q)
        excess = max(excess, low - value, value - high)
    for i in range(drive.pulls.shape[0]):
        value = body.lines[i, t.COMPLIANCE] * shape.tensions[i]
        excess = max(excess, drive.pulls[i, 0] - value, value - drive.pulls[i, 1])
    record[OFF], record[ANGLE], record[EXCESS] = off, turn, excess
    record[MERIT] = merit + (excess / problem.unit) ** 2


def _actuator(drive: Drive, i: int, q: Array) -> tuple[float, float, float]:
    """Displacement of actuator i, and its limits."""
    value, size = 0.0, 3 * q.shape[0]
    for s in range(q.shape[0]):
        value += dot(get_vec(drive.bounds, i, 3 * s), get_vec(q, s, 0))
    return value, drive.bounds[i, size], drive.bounds[i, size + 1]


def _derive(problem: Problem, drive: Drive, shape: Equilibrium, body: Body, space: Workspace, step: Step) -> int:
    """Fill the rows of the step: derivatives, and what motion is asked for or allowed; returns how many there are."""
    n, rows, J = shape.q.shape[0], step.rows, step.jacobian
    at = rows.start[n]
    for j in range(3 * n):
        see_ends(drive.sections, step.columns[j], space.stages, rows, j, J)
    for i in range(at):
        step.values[i, 0] = step.values[i, 1] = rows.value[i]
        step.side[i] = 1
    over = 1.0 / problem.unit
    for i in range(drive.bounds.shape[0]):
        for j in range(3 * n):
            J[at, j] = over * drive.bounds[i, j]
        value, low, high = _actuator(drive, i, shape.q)
        _allow(step, at, over * (low - value), over * (high - value))
        at += 1
    for i in range(drive.pulls.shape[0]):
        stretch = over * body.lines[i, t.COMPLIANCE]
        for j in range(3 * n):
            J[at, j] = stretch * step.pulls[j, i]
        value = stretch * shape.tensions[i]
        _allow(step, at, over * drive.pulls[i, 0] - value, over * drive.pulls[i, 1] - value)
        at += 1
    return at


def _allow(step: Step, i: int, low: float, high: float) -> None:
    """Let row i move between these, and a little less."""
    less = min(INSET, 0.5 * (high - low))
    step.values[i, 0], step.values[i, 1] = low + less, high - less
    step.side[i] = 1 if low == high else 0


def _find_step(problem: Problem, q: Array, step: Step, rows: int) -> None:
    """Fill the change of the drive: the least that keeps all limits, and makes of targets what is then possible."""
    targets = step.rows.start[q.shape[0]]
    step.mean[:] = 0.0
    limits.release(problem.limits, step.root, step.mean, step.bound)
    for _ in range(MOST_ACTIVE_SETS):
        count = _least(step, targets, rows)
        new = limits.bind(problem.limits, q, step.change, step.root, step.mean, step.bound)
        if new + _keep(step, targets, rows) == 0 and _let_go(step, targets, count) == 0:
            break


def _least(step: Step, targets: int, rows: int) -> int:
    """Fill the least change that meets the rows, those of targets damped; returns how many are met."""
    n, count, total, system = step.change.shape[0], 0, 0.0, step.system
    for i in range(rows):
        if step.side[i] != 0:
            step.listed[count] = i
            count += 1
            for s in range(n):
                put_vec(step.weights, i, 3 * s, vec_mat(get_vec(step.jacobian, i, 3 * s), get_mat(step.root, s, 0)))
    for a in range(count):
        i = step.listed[a]
        for b in range(a, count):
            system[a, b] = _product(step.weights, i, step.weights, step.listed[b])
        value = step.values[i, step.side[i] - 1]
        for s in range(n):
            value -= dot(get_vec(step.jacobian, i, 3 * s), get_vec(step.mean, s, 0))
        system[a, count] = value
        total += system[a, a]
    for a in range(count):
        system[a, a] += (CORRECTION_DAMPING if step.listed[a] < targets else LEAST_PIVOT) * max(LEAST_PIVOT, total)
    solve_symmetric(system, count)
    for s in range(n):
        pull = ZERO
        for a in range(count):
            pull = add_scaled(pull, system[a, count], get_vec(step.weights, step.listed[a], 3 * s))
        put_vec(step.change, s, 0, add(get_vec(step.mean, s, 0), mat_vec(get_mat(step.root, s, 0), pull)))
    return count


def _product(one: Array, i: int, other: Array, j: int) -> float:
    total = 0.0
    for c in range(one.shape[1]):
        total += one[i, c] * other[j, c]
    return total


def _keep(step: Step, targets: int, rows: int) -> int:
    """Make rows of the limits of actuators and tensions that the change would leave; returns how many are new."""
    count = 0
    for i in range(targets, rows):
        if step.side[i] == 0:
            ahead = 0.0
            for s in range(step.change.shape[0]):
                ahead += dot(get_vec(step.jacobian, i, 3 * s), get_vec(step.change, s, 0))
            low, high = ahead < step.values[i, 0] - 0.5 * INSET, ahead > step.values[i, 1] + 0.5 * INSET
            if low or high:
                step.side[i] = 1 if low else 2
                count += 1
    return count


def _let_go(step: Step, targets: int, count: int) -> int:
    """Leave out the limits that hold the change back on the wrong side; returns how many."""
    gone = 0
    for a in range(count):
        i, multiplier = step.listed[a], step.system[a, count]
        held = step.values[i, 0] == step.values[i, 1]
        if i >= targets and not held and (multiplier < 0.0 if step.side[i] == 1 else multiplier > 0.0):
            step.side[i] = 0
            gone += 1
    return gone


def _line_search(
    problem: Problem,
    drive: Drive,
    own: Equilibrium,
    trial: Equilibrium,
    body: Body,
    space: Workspace,
    step: Step,
    record: Array,
) -> bool:
    """Go along the change as far as what is left shrinks; say whether it does. Else the record is that before."""
    largest, before = 0.0, (record[OFF], record[ANGLE], record[EXCESS], record[MERIT])
    for s in range(own.q.shape[0]):
        bend, long = problem.limits[s, BEND_SCALE], problem.limits[s, LENGTH_SCALE]
        x, y, z = get_vec(step.change, s, 0)
        largest = max(largest, max(abs(x), abs(y)) / bend if bend > 0.0 else 0.0)
        largest = max(largest, abs(z) / long if long > 0.0 else 0.0)
    step_length = LARGEST / largest if largest > LARGEST else 1.0
    for _ in range(MOST_LENGTHS):
        for s in range(own.q.shape[0]):
            put_vec(step.change, s, 0, scale(step_length, get_vec(step.change, s, 0)))
        limits.move(problem.limits, own.q, step.change, trial.q)
        fill(drive.sections, drive.of_lines, trial.q, body.arcs, body.lines, space.step)
        foretell((own.q, own.x, own.tensions), (step.columns, step.pulls), trial.q, trial.x, trial.tensions)
        e.follow(trial.x, trial.tensions, body, MOST_STEPS, space, trial.record)
        _evaluate(problem, drive, trial, body, space, step, record)
        if record[STABLE] != 0.0 and record[MERIT] < before[3]:
            copy(trial.q, own.q)
            copy(trial.x, own.x)
            for i in range(own.tensions.shape[0]):
                own.tensions[i] = trial.tensions[i]
            return True
        step_length = SHORTER_RATIO
    record[OFF], record[ANGLE], record[EXCESS], record[MERIT] = before
    record[STABLE] = 1.0
    return False
