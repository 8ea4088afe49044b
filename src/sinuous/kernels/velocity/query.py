"""One control step: steps within all bounds, then the proof of the motion.

The step is the damped one of `velocity.active_set`; towards targets there may be several, one after the other. What is
proved clear of the motion from start to end, linear in q, is taken.

`asked` (w,) is the group of `layout`, `answer` (w,) has the columns below; `start` (n, 3) is where the step begins.
"""

import math

from sinuous.kernels.body.pieces import Scratch
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.certificate.obstacles import Accuracy
from sinuous.kernels.certificate.proof import certify
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, Motion
from sinuous.kernels.chain.kinematics import forward, forward_with_columns, frame, shorten
from sinuous.kernels.clock import begin_for, late
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Vec,
    add,
    add_scaled,
    copy,
    cross,
    get_vec,
    put_mat,
    put_vec,
    scale,
    sub,
)
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.step.limits import free_root
from sinuous.kernels.step.newton import FINEST_PROOF, add_targets, prove_among, prove_itself
from sinuous.kernels.step.states import State
from sinuous.kernels.step.targets import X, Y, Z, end_pose, put_row
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.active_set import GAIN, LEAST_DAMPING, constrained_step
from sinuous.kernels.velocity.body import (
    RestingBody,
    add_resting_contacts,
    add_tensions,
    derive_body,
    excess_of,
    measure_travel,
    move_body,
    move_freely,
)
from sinuous.kernels.velocity.bounds import add_actuators, move_within_bounds, size_of
from sinuous.kernels.velocity.contacts import ContactGaps, add_contacts, add_self_contacts
from sinuous.kernels.velocity.layout import Control, StepRequest, carve_control, read_asked

(
    PROVED,
    STEP_FRACTION,
    START,
    CLEARANCE,
    SELF_CLEARANCE,
    POSITION_ERROR,
    ANGLE_ERROR,
    MERIT,
    ROUNDS,
    ACTIVE,
    REACHED,
) = range(11)
"""Columns of an answer: 1 when the motion is proved clear all the way; which share of the step could be taken; the
verdict about the configuration that it begins with, where nothing could be proved, else CLEAR; the proved clearance and
self-clearance of the new configuration (-infinite: not proved); errors of the targets; what is left of the residual,
squared; how many steps there were; how many constraints are active; and the motion of the tip that is reached (6)."""

CLEARANCES = REACHED + 6

CONFIGURATION = CLEARANCES + 2 * CLEARANCES_WIDTH
"""Then what the proof saw (12), the configuration (3 n), and of every active constraint its multiplier, kind, segment,
and obstacle, actuator or other segment."""

ACTIVE_WIDTH = 4

CONTACT_LOOKAHEAD = 1.5
"""How far ahead of a free step contacts are searched for."""

SHY = 0.9
"""How much of what is proved is gone, where the rest is not."""

CONTACT_HALVINGS = 4
"""How often a step is halved that does not lead out of a contact."""

CONTACT_GAIN = 10.0
"""How far a place of the body may move in a step that begins in contact, as a multiple of what is asked for, without
rates; other steps: `GAIN`."""

SLOW_RATIO, SLOW_ROUNDS = 0.9, 4
"""Several steps of a body in equilibrium end after so many in a row that leave more than this share of the residual."""

DAMPING, FASTER, SLOWER = 0.01, 0.3, 10.0
"""Damping towards a target as a share of its residual, squared; how it changes after a step that was better or not."""


def set_free(problem: Problem, control: Control) -> None:
    """Let every segment move in all its coordinates, and wish for no motion."""
    for k in range(control.q.shape[0]):
        put_mat(control.root, k, 0, free_root(problem.limits, k))
        put_vec(control.none, k, 0, ZERO)


def _linearise(problem: Problem, asked: StepRequest, control: Control) -> tuple[float, float, float]:
    """Fill frames, columns and rows at `control.q`; returns the merit, and the largest errors of the targets.

    They are infinite where the body is nowhere at rest.
    """
    n, rows, at = control.q.shape[0], control.rows, 0
    if not move_body(problem.limits, control, control.body):
        return math.inf, math.inf, math.inf
    off = turn = 0.0
    if asked.kind == v.MEET_TARGETS:
        at, off, turn = list_targets(problem, control)
    else:
        for k in range(n):
            rows.start[k] = 0
        inverse = 1.0 / problem.unit
        move = scale(inverse, get_vec(asked.twist, 0, 3))
        arm = scale(inverse, sub(end_pose(control.frames, problem.tool, n - 1)[1], frame(control.frames, 0)[1]))
        at = put_row(rows, at, cross(arm, X), scale(inverse, X), move[0])
        at = put_row(rows, at, cross(arm, Y), scale(inverse, Y), move[1])
        at = put_row(rows, at, cross(arm, Z), scale(inverse, Z), move[2])
        if asked.kind == v.MOVE_POSE:
            at = put_row(rows, at, X, ZERO, asked.twist[0, 0])
            at = put_row(rows, at, Y, ZERO, asked.twist[0, 1])
            at = put_row(rows, at, Z, ZERO, asked.twist[0, 2])
    rows.start[n] = at
    merit = merit_of(control)
    if asked.rounds > 1:
        excess = excess_of(problem, control.body)
        merit += excess * excess
    return merit, off, turn


def list_targets(problem: Problem, control: Control) -> tuple[int, float, float]:
    """Fill the rows of targets; returns how many there are, and the largest errors: length unit, and rad."""
    n, at, off, turn = control.q.shape[0], 0, 0.0, 0.0
    state = State(control.q, control.frames, control.columns, control.rows, control.none[0])
    for k in range(n):
        control.rows.start[k] = at
        at, miss, angle = add_targets(problem, state, k, at)
        off, turn = max(off, miss), max(turn, angle)
    control.rows.start[n] = at
    return at, off, turn


def merit_of(control: Control) -> float:
    """Sum of the squares of what rows ask for."""
    merit = 0.0
    for i in range(control.rows.start[control.q.shape[0]]):
        merit += control.rows.value[i] * control.rows.value[i]
    return merit


def _estimate_travel(problem: Problem, asked: StepRequest, control: Control, mu: float) -> float:
    """How far anything may move in this step, about: what a free step does, but no more than rates allow."""
    free = control.working.free
    move_freely(control, control.body, mu)
    for k in range(control.q.shape[0]):
        bend, stretch = math.hypot(free[k, 0], free[k, 1]), asked.rates[k, v.LENGTH_CHANGE]
        fraction = min(1.0, asked.rates[k, v.BEND_CHANGE] / bend) if bend > 0.0 else 1.0
        control.trial[k, 0], control.trial[k, 1] = (
            control.q[k, 0] + fraction * free[k, 0],
            control.q[k, 1] + fraction * free[k, 1],
        )
        control.trial[k, 2] = control.q[k, 2] + min(max(free[k, 2], -stretch), stretch)
    return min(CONTACT_LOOKAHEAD * measure_travel(problem.limits, control, control.body), problem.unit)


def _may_touch(problem: Problem, asked: StepRequest) -> bool:
    """Whether there is anything that the body must not touch."""
    return bool(asked.wish >= 0.0 and (number_of(problem.scene) > 0 or problem.avoids_itself))


def _put_bounds(problem: Problem, asked: StepRequest, control: Control, start: Array, mu: float) -> tuple[int, float]:
    """Write all bounds but those of single segments; returns their number, and the largest lack of a gap."""
    keep = problem.margin
    wish = max(asked.wish, keep)
    ahead = _estimate_travel(problem, asked, control, mu) if _may_touch(problem, asked) else 0.0
    own, gaps = ContactGaps(keep, keep, keep + ahead), ContactGaps(keep, wish, wish + ahead)
    count, lack = _list_bounds(problem, asked, control, control.body, start, own, gaps)
    return count, max(0.0, lack)


def _list_bounds(
    problem: Problem,
    asked: StepRequest,
    control: Control,
    resting: RestingBody | None,
    start: Array,
    own: ContactGaps,
    gaps: ContactGaps,
) -> tuple[int, float]:
    """Write these bounds, and find that lack, for a body of either kind."""
    if resting is not None:
        first = add_actuators(asked, control, start, 0)
        first = add_tensions(problem, control, resting, first, asked.actuators.shape[0])
        if not _may_touch(problem, asked):
            return first, 0.0
        return add_resting_contacts(problem, control, resting, own, gaps, first)
    count, least = add_self_contacts(problem, control, own)
    count = add_actuators(asked, control, start, count)
    lack = gaps.keep - least
    if number_of(problem.scene) > 0:
        most = control.bounds.shape[0]
        count, seen = add_contacts(problem, control, gaps, count, most)
        lack = max(lack, gaps.wish - seen)
    return count, lack


def _is_rated(problem: Problem, asked: StepRequest) -> bool:
    """Whether rates limit all that can move."""
    for k in range(problem.limits.shape[0]):
        rates = asked.rates[k]
        bend = min(rates[v.BEND_CHANGE], rates[v.BEND_SECOND])
        stretch = min(rates[v.LENGTH_CHANGE], rates[v.LENGTH_SECOND])
        if problem.limits[k, BEND_SCALE] > 0.0 and bend == math.inf:
            return False
        if problem.limits[k, LENGTH_SCALE] > 0.0 and stretch == math.inf:
            return False
    return True


def _limit_travel(problem: Problem, asked: StepRequest, control: Control, wanted: float, lack: float) -> None:
    """Shorten a step that moves a place of the body farther than is asked for, or lacking of a gap, times a factor."""
    if _is_rated(problem, asked):
        return
    touches = lack >= max(asked.wish, problem.margin) - FINEST_PROOF * problem.unit
    most, travel = (CONTACT_GAIN if touches else GAIN) * wanted, measure_travel(problem.limits, control, control.body)
    if travel > most:
        shorten(control.q, control.trial, most / travel)


def advance(
    problem: Problem, asked: StepRequest, control: Control, start: Array
) -> tuple[int, int, tuple[float, float]]:
    """Go on from `control.q`, step by step; `control.trial` is where it ends.

    Returns how many steps there were, how many constraints are in the working set, and of several steps the largest
    errors of the targets, infinite where the body is nowhere at rest.
    """
    merit, off, turn = _linearise(problem, asked, control)
    easing, count, rounds, slow = 1.0, 0, 0, 0
    if merit == math.inf:
        copy(control.q, control.trial)
        return 0, 0, (off, turn)
    while rounds < asked.rounds and not late(control.sweep.clock):
        derive_body(problem, control, control.body, asked.rounds == 1 or _may_touch(problem, asked))
        mu = LEAST_DAMPING
        if asked.kind == v.MEET_TARGETS:
            mu = max(LEAST_DAMPING, DAMPING * easing * merit)
        bounds, lack = _put_bounds(problem, asked, control, start, mu)
        most = GAIN * (math.sqrt(merit) + lack / problem.unit) + size_of(
            control.root, asked.rates[:, v.CHANGE_BEFORE :]
        )
        count = constrained_step(problem, asked, control, start, bounds, mu, most)
        move_within_bounds(problem, asked, control, start)
        rounds += 1
        if asked.rounds == 1:
            _limit_travel(problem, asked, control, problem.unit * math.sqrt(merit) + lack, lack)
            break
        # The step is kept where it lowers the residual; else it is tried again with more damping.
        for k in range(control.q.shape[0]):
            put_vec(control.step, k, 0, sub(get_vec(control.trial, k, 0), get_vec(control.q, k, 0)))
        moved = size_of(problem.limits, control.step)
        copy(control.q, control.working.pull)
        copy(control.trial, control.q)
        found, off, turn = _linearise(problem, asked, control)
        slow = slow + 1 if found > SLOW_RATIO * merit else 0
        if found < merit or (lack > 0.0 and found < math.inf):
            gained = merit - found
            merit, easing = found, max(1e-6, FASTER * easing)
            met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
            met = met and excess_of(problem, control.body) == 0.0
            if (met and lack == 0.0) or moved < 1e-9 or gained < 1e-9 * found:
                break
        else:
            copy(control.working.pull, control.q)
            _, off, turn = _linearise(problem, asked, control)
            easing *= SLOWER
            if moved < 1e-9 or easing > 1e6:
                break
        if slow == SLOW_ROUNDS and control.body is not None:
            break
    if asked.rounds > 1:
        copy(control.q, control.trial)
    return rounds, count, (off, turn)


def _reached(problem: Problem, control: Control, start: Array) -> tuple[Vec, Vec]:
    """Rotation and displacement of the tip, to first order, from `start`, where columns are, to `trial`."""
    turn, move = ZERO, ZERO
    for k in range(start.shape[0]):
        for i in range(3):
            change = control.trial[k, i] - start[k, i]
            turn = add_scaled(turn, change, get_vec(control.columns, k, 6 * i))
            move = add_scaled(move, change, get_vec(control.columns, k, 6 * i + 3))
    arm = sub(end_pose(control.frames, problem.tool, start.shape[0] - 1)[1], frame(control.frames, 0)[1])
    return turn, add(move, cross(turn, arm))


def _least_gap(problem: Problem, control: Control, q: Array, ahead: float) -> float:
    """Least gap of a configuration to obstacles and itself, where it is less than `ahead`."""
    copy(q, control.q)
    forward_with_columns(problem.limits, control.q, control.frames, control.columns)
    gaps = ContactGaps(0.0, 0.0, ahead)
    count, least = add_self_contacts(problem, control, gaps)
    if number_of(problem.scene) > 0:
        _, seen = add_contacts(problem, control, gaps, count, control.bounds.shape[0])
        least = min(least, seen)
    return least


def prove_shape(problem: Problem, control: Control, q: Array) -> tuple[int, float, float]:
    """Verdict about a configuration, and its clearance and self-clearance."""
    copy(q, control.q)
    forward(problem.limits, control.q, control.frames)
    scratch, self_clearance = Scratch(control.near, control.sweep.clock), math.inf
    verdict, clearance = prove_among(problem.scene, problem, control.q, control.frames, scratch)
    if verdict == CLEAR:
        shape = Shape(problem.limits, control.q, control.frames, control.spans)
        verdict, self_clearance = prove_itself(problem, shape, control.sweep.clock)
    return verdict, clearance, self_clearance


def _leave_contact(problem: Problem, control: Control, start: Array) -> float:
    """Go on from a start where nothing is proved as far as that makes no gap smaller; returns the share of the step."""
    fraction, ahead = 1.0, problem.unit
    gap = _least_gap(problem, control, start, ahead)
    for _ in range(CONTACT_HALVINGS):
        copy(control.trial, control.working.pull)
        if _least_gap(problem, control, control.working.pull, ahead) >= gap:
            return fraction
        shorten(start, control.trial, 0.5)
        fraction *= 0.5
    copy(start, control.trial)
    return 0.0


def _prove(problem: Problem, control: Control, start: Array, answer: Array) -> None:
    """Prove the motion from `start` to `control.trial`, which is shortened to what is proved."""
    aim = Accuracy(1.0, FINEST_PROOF * problem.unit, 0.0, problem.mount, True)
    motion = Motion(problem.limits, start, control.trial, problem.scene, problem.avoids_itself, control.sweep.still)
    verdict, until = certify(
        motion, control.sweep, aim, shaped(answer[CLEARANCES:CONFIGURATION], (2, CLEARANCES_WIDTH))
    )
    answer[PROVED], answer[STEP_FRACTION], answer[START] = 1.0, 1.0, CLEAR
    if verdict == CLEAR:
        return
    if until > 0.0:
        shorten(start, control.trial, SHY * until)
        answer[STEP_FRACTION] = SHY * until
        return
    answer[START], _, _ = prove_shape(problem, control, start)
    if answer[START] == CLEAR:  # it stays where it is
        copy(start, control.trial)
        answer[STEP_FRACTION] = 0.0
    else:
        answer[PROVED], answer[STEP_FRACTION] = 0.0, _leave_contact(problem, control, start)


def report(control: Control, count: int, answer: Array) -> None:
    """Write the active constraints."""
    at, working, active = CONFIGURATION + 3 * control.q.shape[0], control.working, 0
    for a in range(count):
        if working.active[a] != 0 and working.about[a, v.MULTIPLIER] > 0.0:
            answer[at], answer[at + 1] = working.about[a, v.MULTIPLIER], working.about[a, v.CONSTRAINT_KIND]
            answer[at + 2], answer[at + 3] = (
                working.about[a, v.CONSTRAINT_SEGMENT],
                working.about[a, v.CONSTRAINT_OTHER],
            )
            at += ACTIVE_WIDTH
            active += 1
    answer[ACTIVE] = active


def write_end(control: Control, answer: Array) -> None:
    """Write where a step ends."""
    for k in range(control.trial.shape[0]):
        for i in range(3):
            answer[CONFIGURATION + 3 * k + i] = control.trial[k, i]


@entry
def control_step(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    asked: Array,
    start: Array,
    workspace: Array,
    answer: Array,
) -> None:
    """Go on from the configuration `start` (n, 3), as `asked` says, within all bounds, as far as that is proved clear.

    `robot`, `scene` and `settings` are groups, laid out as `sinuous.kernels.tables` says, `asked` as `layout` says;
    targets (t, 15). `workspace`: see `layout.control_size`. Fills `answer`.
    """
    problem = read_problem(robot, scene, settings, targets)
    n, m = problem.limits.shape[0], number_of(problem.scene)
    wanted = read_asked(asked, n)
    capacity = max(6, 6 * targets.shape[0])
    work = carve_control(workspace, problem.base, (n, m, capacity, wanted.capacity[0], wanted.capacity[1]), None)
    begin_for(work.sweep.clock, wanted.seconds)
    copy(start, work.q)
    set_free(problem, work)
    answer[ROUNDS], count, _ = advance(problem, wanted, work, start)
    report(work, count, answer)
    _prove(problem, work, start, answer)
    copy(start, work.q)
    if wanted.kind != v.MEET_TARGETS:
        _linearise(problem, wanted, work)
        turn, move = _reached(problem, work, start)
        for i in range(3):
            answer[REACHED + i], answer[REACHED + 3 + i] = turn[i], move[i]
    copy(work.trial, work.q)
    answer[MERIT], answer[POSITION_ERROR], answer[ANGLE_ERROR] = _linearise(problem, wanted, work)
    verdict, clearance, own = prove_shape(problem, work, work.trial)
    answer[CLEARANCE] = clearance if verdict == CLEAR else -math.inf
    answer[SELF_CLEARANCE] = own if verdict == CLEAR else -math.inf
    write_end(work, answer)
