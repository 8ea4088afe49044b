"""The body that a control step moves, as its drive does: where its arcs are, how they follow, how far they may come.

Two bodies have one interface. A *rigid* one has the arcs of the configuration itself; it is `None`, so that compiled
code for it has nothing of the other. One *in equilibrium* (`RestingBody`) gives way to its loads: its arcs are those of
the equilibrium at a drive, and follow as the derivative of that says (`statics.drive`), so every row that sees arcs is
carried over to the drive. Rows of targets are dense then: the end of a segment moves with every coordinate.

`unloaded` (N, 4) are states without load.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain.kinematics import forward_with_columns, frame
from sinuous.kernels.chain.rates import measure_rates
from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    add,
    add_scaled,
    copy,
    cross,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    put_vec,
    sub,
    vec_mat,
)
from sinuous.kernels.problem import Problem
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.drive import differentiate_by_drive, fill_tables
from sinuous.kernels.statics.ends import differentiate_ends, predict_state, put_ends
from sinuous.kernels.statics.equilibrium import equilibrate_near, is_stable
from sinuous.kernels.statics.newton import copy_state, evaluate_state, find_taut
from sinuous.kernels.statics.sweeps import stiffness_of
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.actuation import NO_SUMS
from sinuous.kernels.step.coupling import apply_inverse
from sinuous.kernels.step.dense import solve_symmetric
from sinuous.kernels.step.targets import end_pose
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.bounds import ACTUATOR_INSET, normalise
from sinuous.kernels.velocity.contacts import ContactGaps, add_contacts, add_self_contacts
from sinuous.kernels.velocity.layout import Control

EXCESS_ROUNDING = 5e-12
"""Excess of a stretch over its limits that is rounding, in mean lengths of the robot."""

TENSION_INSET = 1e-3
"""How far below the greatest stretch of a line a step aims, as a share of it: room for a proof of the way there."""

RestingBody = namedtuple(
    "RestingBody",
    "problem arcs sections of_lines stretches body space record at x tensions trial_x trial_tensions unloaded columns "
    "pulls by_drive tip seen system scratch began",
)
"""A body in equilibrium.

`problem`, `arcs`: of its N arcs as a robot, `Problem` and `Control`. `sections` (n, 23), `of_lines` (t, 3 n + 1) as in
`statics.drive`; least and greatest `stretches` (t, 2). `body`, `space`, `record` (10,): of `statics.newton`. The drive
`at` (n, 3) which the states `x` (N, 4) and tensions (t,) are those of; the same that are tried; and states without load
(N, 4). Derivatives by the drive: `columns` (3 n, N, 4) of states, `pulls` (3 n, t) of tensions, `by_drive` (3 n, N, 3)
of arcs, `tip` (6, 3 n) of rotation and place of the tool, `seen` (r, 3 n) of rows. Their `system` (r, r), `scratch`
(r, r + 1). The stretches with which the step `began` (t,)."""


def move_body(limits: Array, control: Control, resting: RestingBody | None) -> bool:
    """Put the body where its drive `control.q` takes it: frames of ends of segments; say whether it is at rest there.

    Of a rigid one also `columns`. `limits` (n, 35): rows of its segments.
    """
    if resting is None:
        forward_with_columns(limits, control.q, control.frames, control.columns)
        return True
    return _rest_at(control, resting)


def _rest_at(control: Control, own: RestingBody) -> bool:
    fill_tables(own.sections, own.of_lines, control.q, own.body.arcs, own.body.lines, own.unloaded)
    if _is_at(own, control.q):
        if not is_stable(own.record):  # of the last search, which ended elsewhere
            find_taut(own.body.lines, own.tensions, own.space)
            evaluate_state(own.x, own.tensions, own.body, 1.0, own.space)
    elif not _find_near(own, control.q):
        return False
    put_ends(own.sections, own.space.frames, control.frames)
    spend(control.sweep.clock, t.ARC_WORK * own.x.shape[0])
    return True


def _is_at(own: RestingBody, q: Array) -> bool:
    """Whether the body is at rest at a drive (n, 3) already."""
    for s in range(q.shape[0]):
        for j in range(3):
            if own.at[s, j] != q[s, j]:
                return False
    return True


def _find_near(own: RestingBody, q: Array) -> bool:
    """Bring the body to rest at a drive `q` (n, 3), whose arcs are there, from the state that is predicted."""
    predict_state((own.at, own.x, own.tensions), (own.columns, own.pulls), q, own.trial_x, own.trial_tensions)
    hold_rigid(own.body.arcs, own.unloaded, own.trial_x)
    equilibrate_near(own.trial_x, own.trial_tensions, own.body, own.space, own.record)
    found = is_stable(own.record)
    if found:
        copy(q, own.at)
        copy_state(own.trial_x, own.trial_tensions, own.x, own.tensions)
    return found


def hold_rigid(arcs: Array, unloaded: Array, x: Array) -> None:
    """Give coordinates that are rigid their values without load."""
    for k in range(x.shape[0]):
        for j in range(4):
            if stiffness_of(arcs, k, j) == t.RIGID:
                x[k, j] = unloaded[k, j]


def unroll(x: Array, arcs: Array) -> None:
    """Fill arcs (N, 3) of a body in states (N, 4): bends turned so that none is twisted."""
    turn = 0.0
    for k in range(x.shape[0]):
        cosine, sine = math.cos(turn), math.sin(turn)
        arcs[k, 0] = cosine * x[k, 0] - sine * x[k, 1]
        arcs[k, 1] = sine * x[k, 0] + cosine * x[k, 1]
        arcs[k, 2] = x[k, t.LENGTH]
        turn += x[k, t.TORSION]


def _derive_arcs(own: RestingBody) -> None:
    """Fill how those arcs follow the drive."""
    for j in range(own.columns.shape[0]):
        turn, rolled = 0.0, 0.0
        for k in range(own.x.shape[0]):
            cosine, sine, column = math.cos(turn), math.sin(turn), own.columns[j, k]
            own.by_drive[j, k, 0] = cosine * column[0] - sine * column[1] - rolled * own.arcs.q[k, 1]
            own.by_drive[j, k, 1] = sine * column[0] + cosine * column[1] + rolled * own.arcs.q[k, 0]
            own.by_drive[j, k, 2] = column[t.LENGTH]
            turn, rolled = turn + own.x[k, t.TORSION], rolled + column[t.TORSION]


def excess_of(problem: Problem, resting: RestingBody | None) -> float:
    """By how much lines are stretched beyond their limits, at most, in mean lengths of the robot; 0 for rounding."""
    worst = 0.0
    if resting is not None:
        for i in range(resting.tensions.shape[0]):
            stretch = resting.body.lines[i, t.COMPLIANCE] * resting.tensions[i]
            worst = max(worst, resting.stretches[i, 0] - stretch, stretch - resting.stretches[i, 1])
    return worst / problem.unit if worst > EXCESS_ROUNDING * problem.unit else 0.0


def derive_body(problem: Problem, control: Control, resting: RestingBody | None, arcs: bool) -> None:
    """Fill all derivatives of a body in equilibrium, where it was just moved; those of a rigid one are there.

    Those of arcs only where they are asked for: contacts and travels see them.
    """
    if resting is not None:
        differentiate_by_drive(
            resting.sections,
            resting.of_lines,
            control.q,
            resting.x,
            resting.body,
            resting.space,
            resting.columns,
            resting.pulls,
        )
        if arcs:
            unroll(resting.x, resting.arcs.q)
            _derive_arcs(resting)
            forward_with_columns(resting.problem.limits, resting.arcs.q, resting.arcs.frames, resting.arcs.columns)
        _differentiate_rows(problem, control, resting)


def _differentiate_rows(problem: Problem, control: Control, own: RestingBody) -> None:
    n, stages = control.q.shape[0], own.space.stages
    arm = sub(end_pose(control.frames, problem.tool, n - 1)[1], frame(control.frames, 0)[1])
    for j in range(3 * n):
        omega, velocity = differentiate_ends(own.sections, own.columns[j], stages, control.rows, j, own.seen)
        velocity = add(velocity, cross(omega, arm))
        for i in range(3):
            own.tip[i, j], own.tip[3 + i, j] = omega[i], velocity[i]


def move_freely(control: Control, resting: RestingBody | None, mu: float) -> None:
    """Fill `control.working.free` with the step of damping `mu` without any constraint."""
    if resting is None:
        sweeps.forward(control.columns, control.root, control.none, control.rows, mu, NO_SUMS)
        sweeps.backward(control.columns, control.root, control.none, control.rows, control.working.free, NO_SUMS)
    else:
        _solve_freely(control, resting, mu)


def _solve_freely(control: Control, own: RestingBody, mu: float) -> None:
    count, n = int(control.rows.start[control.q.shape[0]]), control.q.shape[0]
    for i in range(count):
        for b in range(count):
            own.system[i, b] = mu if i == b else 0.0
            for k in range(n):
                root = get_mat(control.root, k, 0)
                one, other = vec_mat(get_vec(own.seen, i, 3 * k), root), vec_mat(get_vec(own.seen, b, 3 * k), root)
                own.system[i, b] += dot(one, other)
    for k in range(n):
        put_vec(control.working.free, k, 0, ZERO)
    _spread(control, own, count, True, control.working.free)


def _spread(control: Control, own: RestingBody, count: int, values: bool, out: Array) -> None:
    """Add to `out` (n, 3) what brings rows to their `values`, else what takes away what they see of `out`."""
    for i in range(count):
        for b in range(count):
            own.scratch[i, b] = own.system[i, b]
        total = control.rows.value[i] if values else 0.0
        for j in range(own.seen.shape[1]):
            total -= own.seen[i, j] * out[j // 3, j % 3]
        own.scratch[i, count] = total
    solve_symmetric(own.scratch, count)
    for k in range(out.shape[0]):
        root, pull = get_mat(control.root, k, 0), ZERO
        for i in range(count):
            pull = add_scaled(pull, own.scratch[i, count], get_vec(own.seen, i, 3 * k))
        put_vec(out, k, 0, add(get_vec(out, k, 0), mat_vec(root, vec_mat(pull, root))))


def answer_weights(control: Control, resting: RestingBody | None, a: int, moved: Array) -> None:
    """Fill `moved` (n, 3) with `H^-1 c` for the weights c of constraint `a`; see `active_set`."""
    weights = control.working.weights
    if resting is None:
        apply_inverse(control.columns, control.root, weights, a, 0, control.rows, control.working.pull, moved, NO_SUMS)
    else:
        for k in range(moved.shape[0]):
            root = get_mat(control.root, k, 0)
            put_vec(moved, k, 0, mat_vec(root, vec_mat(get_vec(weights, a, 3 * k), root)))
        _spread(control, resting, int(control.rows.start[moved.shape[0]]), False, moved)


def measure_travel(limits: Array, control: Control, resting: RestingBody | None) -> float:
    """How far any place of the body travels to where `control.trial` leads, at most; under load to first order."""
    if resting is None:
        return float(measure_rates(limits, control.q, control.trial, control.sweep.rates))
    arcs = resting.arcs
    copy(arcs.q, arcs.trial)
    for j in range(resting.by_drive.shape[0]):
        moved = control.trial[j // 3, j % 3] - control.q[j // 3, j % 3]
        for k in range(arcs.q.shape[0]):
            for i in range(3):
                arcs.trial[k, i] += moved * resting.by_drive[j, k, i]
    return float(measure_rates(resting.problem.limits, arcs.q, arcs.trial, arcs.sweep.rates))


def add_resting_contacts(
    problem: Problem, control: Control, own: RestingBody, itself: ContactGaps, gaps: ContactGaps, first: int
) -> tuple[int, float]:
    """Write the bounds of contacts of a body in equilibrium, from row `first` on, see `contacts.add_contacts`.

    `itself`: the same gaps from the body itself. Returns the next free row, and the largest lack of a gap.
    """
    arcs, at = own.arcs, first
    count, least = add_self_contacts(own.problem, arcs, itself)
    lack = gaps.keep - least
    if number_of(problem.scene) > 0:
        count, seen = add_contacts(own.problem, arcs, gaps, count, arcs.bounds.shape[0])
        lack = max(lack, gaps.wish - seen)
    for a in range(count):
        at += _carry(control, own, a, at)
    return at, lack


def _carry(control: Control, own: RestingBody, a: int, at: int) -> int:
    """Write bound `a` of the arcs as one of the drive; returns 1, or 0 where nothing can move it."""
    row, source, width = control.bounds[at], own.arcs.bounds[a], 3 * control.q.shape[0]
    beyond = 3 * own.arcs.q.shape[0]
    for j in range(width):
        row[j] = 0.0
        for k in range(own.arcs.q.shape[0]):
            row[j] += dot(get_vec(own.by_drive[j], k, 0), get_vec(own.arcs.bounds, a, 3 * k))
    size = normalise(control, at)
    for i in range(v.BOUND_WIDTH):
        row[width + i] = source[beyond + i]
    if size == 0.0:
        return 0
    for i in range(v.LOW, v.GAP):
        row[width + i] /= size
    row[width + v.BOUND_SEGMENT] = owner_of(own, source[beyond + v.BOUND_SEGMENT])
    if source[beyond + v.KIND_LOW] == v.SELF_CLEARANCE_LIMIT:
        row[width + v.BOUND_OTHER] = owner_of(own, source[beyond + v.BOUND_OTHER])
    return 1


def owner_of(own: RestingBody, arc: float) -> float:
    """The segment of an arc."""
    last = -1.0
    for s in range(own.sections.shape[0]):
        last += own.sections[s, t.ARC_COUNT]
        if arc <= last:
            return float(s)
    return -1.0


def add_tensions(problem: Problem, control: Control, own: RestingBody, first: int, actuators: int) -> int:
    """Write the bounds of tensions, from row `first` on, and return the next free row.

    Numbers of lines come after those of the `actuators` that have a row.
    """
    at = first
    for i in range(own.tensions.shape[0]):
        at += _add_tension(problem, control, own, i, at, actuators)
    return at


def _add_tension(problem: Problem, control: Control, own: RestingBody, i: int, at: int, actuators: int) -> int:
    """Write the bound of the tension of line i; returns 1, or 0 where it has none."""
    row, width, compliance = control.bounds[at], 3 * control.q.shape[0], own.body.lines[i, t.COMPLIANCE]
    if own.stretches[i, 0] == -math.inf and own.stretches[i, 1] == math.inf:
        return 0
    for j in range(width):
        row[j] = compliance * own.pulls[j, i]
    size = normalise(control, at)
    if size < 1e-9 * problem.unit:
        return 0
    value = compliance * own.tensions[i]
    least = min(own.stretches[i, 0] * (1.0 + TENSION_INSET), own.began[i])
    most = max(own.stretches[i, 1] * (1.0 - TENSION_INSET), own.began[i])
    row[width + v.LOW], row[width + v.HIGH] = (least - value) / size + ACTUATOR_INSET, (most - value) / size
    wished = own.stretches[i, 1] * (1.0 - TENSION_INSET)  # no proof begins nearer to a limit
    row[width + v.WISHED_LOW], row[width + v.WISHED_HIGH] = -math.inf, (wished - value) / size
    row[width + v.KIND_LOW] = row[width + v.KIND_HIGH] = v.ACTUATOR_LIMIT
    row[width + v.GAP], row[width + v.BOUND_SEGMENT], row[width + v.BOUND_OTHER] = math.inf, -1.0, actuators + i
    return 1
