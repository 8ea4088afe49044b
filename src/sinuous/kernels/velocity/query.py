"""One tick of a control loop: steps within all bounds, then the proof of the motion.

The step is the damped one of `velocity.active_set`; towards targets there may be several, one after the other. What is
proved clear of the motion from start to end, linear in q, is taken.
"""

import math

from sinuous.kernels.between.obstacles import Aim
from sinuous.kernels.between.proof import prove_between
from sinuous.kernels.between.sweep import SEEN_WIDTH, Motion
from sinuous.kernels.body.pieces import Scratch
from sinuous.kernels.body.proof import CLEAR, prove
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.body.self_proof import prove_self
from sinuous.kernels.chain.kinematics import forward, forward_with_columns, frame
from sinuous.kernels.chain.rates import measure_rates
from sinuous.kernels.clock import allow, begin, late
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import coarseness, number_of
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
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.newton import FINEST, SAMPLED_SLACK, SLACK, add_targets
from sinuous.kernels.step.states import State
from sinuous.kernels.step.targets import NONE, X, Y, Z, end_pose, put_row
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.active_set import EXACT, GAIN, constrained_step
from sinuous.kernels.velocity.bounds import add_actuators, size_of, take
from sinuous.kernels.velocity.contacts import Look, add_contacts, add_self_contacts
from sinuous.kernels.velocity.layout import Asked, Tick, carve_tick, read_asked

(
    PROVED,
    SHARE,
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

SEEN = REACHED + 6

SHAPE = SEEN + 2 * SEEN_WIDTH
"""Then what the proof saw (12), the configuration (3 n), and of every active constraint its multiplier, kind, segment,
and obstacle, actuator or other segment."""

ACTIVE_WIDTH = 4

AHEAD = 1.5
"""How far ahead of a free step contacts are looked for."""

SHY = 0.9
"""How much of what is proved is gone, where the rest is not."""

HALVINGS = 4
"""How often a step is halved that does not lead out of a contact."""

DAMPING, FASTER, SLOWER = 0.01, 0.3, 10.0
"""Damping towards a target as a share of its residual, squared; how it changes after a step that was better or not."""


def _set_free(problem: Problem, tick: Tick) -> None:
    """Let every segment move in all its coordinates, and wish for no motion."""
    for k in range(tick.q.shape[0]):
        bend, stretch = problem.limits[k, BEND_SCALE], problem.limits[k, LENGTH_SCALE]
        put_mat(tick.root, k, 0, ((bend, 0.0, 0.0), (0.0, bend, 0.0), (0.0, 0.0, stretch)))
        put_vec(tick.none, k, 0, ZERO)


def _linearise(problem: Problem, asked: Asked, tick: Tick) -> tuple[float, float, float]:
    """Fill frames, columns and rows at `tick.q`; returns the merit, and the largest errors of the targets."""
    n, rows, at = tick.q.shape[0], tick.rows, 0
    forward_with_columns(tick.q, tick.frames, tick.columns)
    off = turn = merit = 0.0
    state = State(tick.q, tick.frames, tick.columns, rows, tick.none[0])
    for k in range(n):
        rows.start[k] = at
        if asked.kind == v.TARGETS:
            at, miss, angle = add_targets(problem, state, k, at)
            off, turn = max(off, miss), max(turn, angle)
    if asked.kind != v.TARGETS:
        inverse = 1.0 / problem.unit
        move = scale(inverse, get_vec(asked.twist, 0, 3))
        arm = scale(inverse, sub(end_pose(tick.frames, problem.tool, n - 1)[1], frame(tick.frames, 0)[1]))
        at = put_row(rows, at, cross(arm, X), scale(inverse, X), move[0])
        at = put_row(rows, at, cross(arm, Y), scale(inverse, Y), move[1])
        at = put_row(rows, at, cross(arm, Z), scale(inverse, Z), move[2])
        if asked.kind == v.POSE:
            at = put_row(rows, at, X, NONE, asked.twist[0, 0])
            at = put_row(rows, at, Y, NONE, asked.twist[0, 1])
            at = put_row(rows, at, Z, NONE, asked.twist[0, 2])
    rows.start[n] = at
    for i in range(at):
        merit += rows.value[i] * rows.value[i]
    return merit, off, turn


def _farthest(problem: Problem, asked: Asked, tick: Tick, mu: float) -> float:
    """How far anything may move in this tick, about: what a free step does, but no more than rates allow."""
    free = tick.working.free
    sweeps.forward(tick.columns, tick.root, tick.none, tick.rows, mu, False)
    sweeps.backward(tick.columns, tick.root, tick.none, tick.rows, free, False)
    for k in range(tick.q.shape[0]):
        bend, stretch = math.hypot(free[k, 0], free[k, 1]), asked.rates[k, v.LENGTH_CHANGE]
        share = min(1.0, asked.rates[k, v.BEND_CHANGE] / bend) if bend > 0.0 else 1.0
        tick.trial[k, 0], tick.trial[k, 1] = tick.q[k, 0] + share * free[k, 0], tick.q[k, 1] + share * free[k, 1]
        tick.trial[k, 2] = tick.q[k, 2] + min(max(free[k, 2], -stretch), stretch)
    return min(AHEAD * measure_rates(tick.q, tick.trial, tick.sweep.rates), problem.unit)


def _put_bounds(problem: Problem, asked: Asked, tick: Tick, start: Array, mu: float) -> tuple[int, float]:
    """Write all bounds but those of single segments; returns their number, and the largest lack of a gap."""
    keep = problem.margin
    wish = max(asked.wish, keep)
    ahead = _farthest(problem, asked, tick, mu)
    count, least = add_self_contacts(problem, tick, Look(keep, keep, keep + ahead), 0)
    count = add_actuators(asked, tick, start, count)
    lack = keep - least
    if number_of(problem.scene) > 0:
        look, most = Look(keep, wish, wish + ahead), tick.bounds.shape[0]
        count, seen = add_contacts(problem, tick, look, count, most)
        lack = max(lack, wish - seen)
    return count, max(0.0, lack)


def _advance(problem: Problem, asked: Asked, tick: Tick, start: Array) -> tuple[int, int]:
    """Go on from `tick.q`, step by step; `tick.trial` is where it ends.

    Returns how many steps there were, and how many constraints are in the working set.
    """
    merit, off, turn = _linearise(problem, asked, tick)
    easing, count, rounds = 1.0, 0, 0
    while rounds < asked.rounds and not late(tick.sweep.clock):
        mu = EXACT
        if asked.kind == v.TARGETS:
            mu = max(EXACT, DAMPING * easing * merit)
        bounds, lack = _put_bounds(problem, asked, tick, start, mu)
        most = GAIN * (math.sqrt(merit) + lack / problem.unit) + size_of(tick.root, asked.rates[:, v.BEFORE :])
        count = constrained_step(problem, asked, tick, start, bounds, mu, most)
        take(problem, asked, tick, start)
        rounds += 1
        if asked.rounds == 1:
            break
        # The step is kept where it lowers the residual; else it is tried again with more damping.
        for k in range(tick.q.shape[0]):
            put_vec(tick.step, k, 0, sub(get_vec(tick.trial, k, 0), get_vec(tick.q, k, 0)))
        moved = size_of(tick.root, tick.step)
        copy(tick.q, tick.working.pull)
        copy(tick.trial, tick.q)
        found, off, turn = _linearise(problem, asked, tick)
        if found < merit or lack > 0.0:
            gained = merit - found
            merit, easing = found, max(1e-6, FASTER * easing)
            met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
            if (met and lack == 0.0) or moved < 1e-9 or gained < 1e-9 * found:
                break
        else:
            copy(tick.working.pull, tick.q)
            _linearise(problem, asked, tick)
            easing *= SLOWER
            if moved < 1e-9 or easing > 1e6:
                break
    if asked.rounds > 1:
        copy(tick.q, tick.trial)
    return rounds, count


def _reached(problem: Problem, tick: Tick, start: Array) -> tuple[Vec, Vec]:
    """Rotation and displacement of the tip, to first order, from `start`, where columns are, to `trial`."""
    turn, move = ZERO, ZERO
    for k in range(start.shape[0]):
        for i in range(3):
            change = tick.trial[k, i] - start[k, i]
            turn = add_scaled(turn, change, get_vec(tick.columns, k, 6 * i))
            move = add_scaled(move, change, get_vec(tick.columns, k, 6 * i + 3))
    arm = sub(end_pose(tick.frames, problem.tool, start.shape[0] - 1)[1], frame(tick.frames, 0)[1])
    return turn, add(move, cross(turn, arm))


def _shorten(tick: Tick, start: Array, share: float) -> None:
    for k in range(start.shape[0]):
        for i in range(3):
            tick.trial[k, i] = start[k, i] + share * (tick.trial[k, i] - start[k, i])


def _least_gap(problem: Problem, tick: Tick, q: Array, ahead: float) -> float:
    """Least gap of a configuration to obstacles and itself, where it is less than `ahead`."""
    copy(q, tick.q)
    forward_with_columns(tick.q, tick.frames, tick.columns)
    look = Look(0.0, 0.0, ahead)
    count, least = add_self_contacts(problem, tick, look, 0)
    if number_of(problem.scene) > 0:
        _, seen = add_contacts(problem, tick, look, count, tick.bounds.shape[0])
        least = min(least, seen)
    return least


def _look_at(problem: Problem, tick: Tick, q: Array) -> tuple[int, float, float]:
    """Verdict about a configuration, and its clearance and self-clearance."""
    copy(q, tick.q)
    forward(tick.q, tick.frames)
    verdict, clearance, own = CLEAR, math.inf, math.inf
    finest = FINEST * problem.unit
    if number_of(problem.scene) > 0:
        slack = SAMPLED_SLACK if coarseness(problem.scene) > 0.0 else SLACK
        scratch = Scratch(tick.near, tick.sweep.clock)
        verdict, clearance, _, _, _ = prove(
            problem.limits, tick.q, tick.frames, problem.scene, problem.mount, slack, finest, scratch
        )
    if problem.avoids_itself and verdict == CLEAR:
        verdict, own, _ = prove_self(Shape(problem.limits, tick.q, tick.frames, tick.spans), finest, tick.sweep.clock)
    return verdict, clearance, own


def _leave_contact(problem: Problem, tick: Tick, start: Array) -> float:
    """Go on from a start where nothing is proved as far as that makes no gap smaller; returns the share of the step."""
    share, ahead = 1.0, problem.unit
    gap = _least_gap(problem, tick, start, ahead)
    for _ in range(HALVINGS):
        copy(tick.trial, tick.working.pull)
        if _least_gap(problem, tick, tick.working.pull, ahead) >= gap:
            return share
        _shorten(tick, start, 0.5)
        share *= 0.5
    copy(start, tick.trial)
    return 0.0


def _prove(problem: Problem, tick: Tick, start: Array, answer: Array) -> None:
    """Prove the motion from `start` to `tick.trial`, which is shortened to what is proved."""
    aim = Aim(1.0, FINEST * problem.unit, 0.0, problem.mount, True)
    motion = Motion(problem.limits, start, tick.trial, problem.scene, problem.avoids_itself, tick.sweep.still)
    verdict, until = prove_between(motion, tick.sweep, aim, shaped(answer[SEEN:SHAPE], (2, SEEN_WIDTH)))
    answer[PROVED], answer[SHARE], answer[START] = 1.0, 1.0, CLEAR
    if verdict == CLEAR:
        return
    if until > 0.0:
        _shorten(tick, start, SHY * until)
        answer[SHARE] = SHY * until
        return
    answer[START], _, _ = _look_at(problem, tick, start)
    if answer[START] == CLEAR:  # it stays where it is
        copy(start, tick.trial)
        answer[SHARE] = 0.0
    else:
        answer[PROVED], answer[SHARE] = 0.0, _leave_contact(problem, tick, start)


def _report(tick: Tick, count: int, answer: Array) -> None:
    """Write the active constraints."""
    at, working, active = SHAPE + 3 * tick.q.shape[0], tick.working, 0
    for a in range(count):
        if working.active[a] != 0 and working.about[a, v.MULTIPLIER] > 0.0:
            answer[at], answer[at + 1] = working.about[a, v.MULTIPLIER], working.about[a, v.WHAT]
            answer[at + 2], answer[at + 3] = working.about[a, v.WHERE], working.about[a, v.WHICH]
            at += ACTIVE_WIDTH
            active += 1
    answer[ACTIVE] = active


@entry
def tick(
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
    targets (t, 15). `workspace`: see `layout.tick_size`. Fills `answer`.
    """
    problem = read_problem(robot, scene, settings, targets)
    n, m = problem.limits.shape[0], number_of(problem.scene)
    wanted = read_asked(asked, n)
    capacity = max(6, 6 * targets.shape[0])
    work = carve_tick(workspace, problem.base, (n, m, capacity, wanted.room[0], wanted.room[1]))
    begin(work.sweep.clock)
    allow(work.sweep.clock, wanted.seconds)
    copy(start, work.q)
    _set_free(problem, work)
    answer[ROUNDS], count = _advance(problem, wanted, work, start)
    _report(work, count, answer)
    _prove(problem, work, start, answer)
    copy(start, work.q)
    if wanted.kind != v.TARGETS:
        _linearise(problem, wanted, work)
        turn, move = _reached(problem, work, start)
        for i in range(3):
            answer[REACHED + i], answer[REACHED + 3 + i] = turn[i], move[i]
    copy(work.trial, work.q)
    answer[MERIT], answer[POSITION_ERROR], answer[ANGLE_ERROR] = _linearise(problem, wanted, work)
    verdict, clearance, own = _look_at(problem, work, work.trial)
    answer[CLEARANCE] = clearance if verdict == CLEAR else -math.inf
    answer[SELF_CLEARANCE] = own if verdict == CLEAR else -math.inf
    for k in range(n):
        for i in range(3):
            answer[SHAPE + 3 * k + i] = work.trial[k, i]
