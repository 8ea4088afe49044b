"""Damped Gauss-Newton from one start: linearise, step in two sweeps, keep what gets better."""

import math

from sinuous.kernels.body.contacts import SOFTNESS, ContactSearch, PosedBody, contacts
from sinuous.kernels.body.pieces import Scratch, backbone_of
from sinuous.kernels.body.proof import CLEAR, prove
from sinuous.kernels.body.rows import SOFT
from sinuous.kernels.body.self_contacts import PAIR_VALUE, self_contacts
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.body.self_proof import prove_self
from sinuous.kernels.chain.kinematics import forward_with_columns, frame
from sinuous.kernels.clock import SEGMENT_WORK, late, spend
from sinuous.kernels.compile import shared
from sinuous.kernels.fields import solids
from sinuous.kernels.fields.distances import Scene, coarseness, number_of
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import ZERO, Array, get_vec, put_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.step import actuation, limits, sweeps
from sinuous.kernels.step import states as s
from sinuous.kernels.step.coupling import couple
from sinuous.kernels.step.dense import JACOBIAN_WIDTH, are_few, dense_step, fill_constraint_jacobian
from sinuous.kernels.step.states import State, Work, coupling_of, pick
from sinuous.kernels.step.targets import add_rows, end_segment

MISSED = -1
"""In place of a verdict of the proof: the targets were not met."""

PROOF_SLACK, SAMPLED_PROOF_SLACK = 0.1, 0.6
"""How far below the true clearance its proved bound may be, as a share of it; among sampled obstacles more, because
less would cost exact distances everywhere."""

FINEST_PROOF = 1e-7
"""Length of backbone, in robot lengths, below which a proof gives up."""

SELF_MARGIN = 10.0
"""Self-clearance that steps aim for where they examine it, as a multiple of the margin from obstacles: which places are
closest to each other changes more in a step than which are closest to an obstacle."""

EXACT_DAMPING = 1e-10
"""Least damping, with which rows are met exactly."""

MOST_SLOW_STEPS = 12
"""Steps in a row that gain little before a start is given up."""

MOST_SLOW_WISHED_STEPS = 4
"""Steps in a row that gain little before nothing is wished for any more."""

MOST_BINDINGS = 3
"""Most times that a step is taken back because it would leave a limit, and computed anew along that limit."""


def add_targets(problem: Problem, state: State, k: int, at: int) -> tuple[int, float, float]:
    """Write the rows of all targets of the end of segment `k`, from row `at` on.

    Returns the next free row, and the largest position error (length) and angle error (rad) of these targets.
    """
    origin = frame(state.frames, 0)[1]
    off = turn = 0.0
    for i in range(problem.targets.shape[0]):
        if end_segment(problem.targets, i, state.q.shape[0]) == k:
            at, miss, angle = add_rows(
                problem.targets, i, state.frames, problem.tool, origin, problem.unit, state.rows, at
            )
            off, turn = max(off, miss), max(turn, angle)
    return at, off, turn


def finish_rows(state: State, count: int) -> None:
    """Finish a linearisation with `count` rows and no self-contact: where rows end, and the norms of their values."""
    rows = state.rows
    rows.start[state.q.shape[0]] = count
    merit = wished = 0.0
    for i in range(count):
        square = rows.value[i] * rows.value[i]  # idle rows hold 0
        if rows.kind[i] == SOFT:
            wished += square
        else:
            merit += square
    state.norms[s.MERIT] = merit
    state.norms[s.WISH] = wished / (SOFTNESS * SOFTNESS)
    state.norms[s.SELF_BOUND], state.norms[s.PAIRS] = math.inf, 0.0


def add_self_contacts(problem: Problem, state: State, work: Work) -> None:
    """Add the self-contacts to a linearisation that `close` has finished."""
    own = coupling_of(state, work)
    shape, pairs = Shape(problem.limits, state.q, state.frames, own.spans), own.pairs
    count, low = self_contacts(shape, state.columns, SELF_MARGIN * problem.margin, problem.unit, pairs)
    for a in range(count):
        state.norms[s.MERIT] += pairs[a, PAIR_VALUE] * pairs[a, PAIR_VALUE]
    state.norms[s.SELF_BOUND], state.norms[s.PAIRS] = low, count


def linearise(problem: Problem, state: State, work: Work, depth: int, mode: int, wish: float, with_self: bool) -> None:
    """Fill frames, rows and norms of `state` for its configuration; clearance up to `wish` becomes SOFT rows.

    Contacts are searched for as deep as `depth` and as exactly as `mode` says (see `contacts.ContactSearch`),
    self-contacts only `with_self`. When the time is over, some are missing.
    """
    q, frames, rows = state.q, state.frames, state.rows
    forward_with_columns(problem.limits, q, frames, state.columns)
    off = turn = 0.0
    seen = math.inf
    mount = problem.mount
    body = PosedBody(problem.limits, q, frames, problem.unit)
    search = ContactSearch(problem.margin, wish, depth, mode)
    scratch = Scratch(work.among, work.clock)
    at = actuator = 0
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        if number_of(problem.scene) > 0:
            at, least = contacts(body, problem.scene, k, mount, search, scratch, rows, at)
            seen = min(seen, least)
            mount -= backbone_of(problem.limits, q, k)
        at, miss, angle = add_targets(problem, state, k, at)
        off, turn = max(off, miss), max(turn, angle)
    finish_rows(state, at)
    state.norms[s.POSITION], state.norms[s.ANGLE], state.norms[s.CLEARANCE_SEEN] = off, turn, seen
    if with_self:
        add_self_contacts(problem, state, work)


def step(problem: Problem, state: State, work: Work, mu: float) -> bool:
    """Fill `work.step` with the damped Newton step that keeps the limits; say whether limits bound it.

    `work.mean` holds a motion that would be welcome for other reasons, or zero.
    """
    return damped_step(problem.limits, problem.actuation, state, work, mu)


@shared
def damped_step(table: Array, actuators: Array, state: State, work: Work, mu: float) -> bool:
    """The same, of what it takes: the limits of the segments (n, c), and the actuators (a, c), see `Problem`."""
    limits.release(table, work.root, work.mean, work.bound)
    bound = False
    coupled, sums_from = actuators.shape[0] > 0, actuation.sums_from(actuators)
    if coupled:
        actuation.release(state.rows)
        actuation.bind_equalities(actuators, state.q, state.rows)
    n = state.q.shape[0]
    few = not coupled and state.norms[s.PAIRS] == 0.0 and are_few(state.rows, n)
    jacobian, _ = cut(work.rest, n, JACOBIAN_WIDTH)
    if few:
        fill_constraint_jacobian(table, state.columns, state.rows, jacobian)
    for _ in range(MOST_BINDINGS):
        if few:
            dense_step(jacobian, work.root, work.mean, state.rows, mu, work.step)
        else:
            sweeps.forward(state.columns, work.root, work.mean, state.rows, mu, sums_from)
            sweeps.backward(state.columns, work.root, work.mean, state.rows, work.step, sums_from)
        if state.norms[s.PAIRS] > 0.0:
            couple(state, work, mu, sums_from)
        count = limits.bind(table, state.q, work.step, work.root, work.mean, work.bound)
        if coupled:
            count += actuation.bind(actuators, state.q, work.step, state.rows)
        if count == 0:
            break
        bound = True
    return bound


def wish_nothing(work: Work) -> None:
    """Wish for no motion."""
    for k in range(work.mean.shape[0]):
        put_vec(work.mean, k, 0, ZERO)


def _finite(q: Array, k: int) -> bool:
    """Whether the numbers of segment `k` are finite; of NaN and infinity the difference to itself is NaN."""
    x, y, length = get_vec(q, k, 0)
    return bool((x - x) + (y - y) + (length - length) == 0.0)


def move(problem: Problem, state: State, work: Work, trial: State) -> None:
    """Take the step, within all limits; a segment whose step has no number stays where it is."""
    limits.move(problem.limits, state.q, work.step, trial.q)
    actuation.approach_held_values(problem.limits, problem.actuation, trial.q)
    actuation.hold_back(problem.actuation, state.q, trial.q)
    for k in range(trial.q.shape[0]):
        if not _finite(trial.q, k):
            put_vec(trial.q, k, 0, get_vec(state.q, k, 0))


def project_to_limits(problem: Problem, state: State, work: Work) -> None:
    """Bring the configuration of `state` within all limits; a segment without numbers is straight, of middle length."""
    q = state.q
    for k in range(q.shape[0]):
        if not _finite(q, k):
            put_vec(q, k, 0, (0.0, 0.0, limits.middle_length(problem.limits, k)))
        put_vec(q, k, 0, limits.project_segment(problem.limits, k, q[k, 0], q[k, 1], q[k, 2]))
    actuation.straighten(problem.limits, problem.actuation, q, work.step)


def met(problem: Problem, state: State, loose: float) -> bool:
    """Targets within tolerance, and no overlap seen that is more than `loose`, none at all of the body with itself.

    Where anything is NaN the merit is: the largest of errors, and the least of clearances, pass over it.
    """
    norms = state.norms
    return bool(
        norms[s.MERIT] < math.inf
        and norms[s.POSITION] <= problem.position_tolerance
        and norms[s.ANGLE] <= problem.angle_tolerance
        and norms[s.CLEARANCE_SEEN] >= -loose
        and norms[s.SELF_BOUND] >= 0.0
    )


def met_by(state: State, loose: float) -> bool:
    """Targets and obstacles within what samples may be wrong by: they may be what keeps the targets from being met."""
    return bool(state.norms[s.POSITION] <= loose and state.norms[s.CLEARANCE_SEEN] >= -loose)


def proof(problem: Problem, state: State, work: Work) -> tuple[int, float]:
    """Verdict and clearance of the whole body at `state`; see `proof.prove`."""
    return prove_among(problem.scene, problem, state.q, state.frames, Scratch(work.among, work.clock))


def prove_among(scene: Scene | None, problem: Problem, q: Array, frames: Array, scratch: Scratch) -> tuple[int, float]:
    """The same of a configuration (n, 3) with its frames (n + 1, 12); `scene`: that of the problem."""
    if scene is None:
        return CLEAR, math.inf
    if scene.table.shape[0] == 0:
        return CLEAR, math.inf
    slack = SAMPLED_PROOF_SLACK if coarseness(scene) > 0.0 else PROOF_SLACK
    finest = FINEST_PROOF * problem.unit
    verdict, clearance, _, _, _ = prove(problem.limits, q, frames, scene, problem.mount, slack, finest, scratch)
    return verdict, clearance


def self_proof(problem: Problem, state: State, work: Work) -> tuple[int, float]:
    """Verdict and self-clearance of the body at `state`; see `self_proof.prove_self`."""
    return prove_itself(
        problem, Shape(problem.limits, state.q, state.frames, coupling_of(state, work).spans), work.clock
    )


def prove_itself(problem: Problem, shape: Shape, clock: Array) -> tuple[int, float]:
    """The same of a shape."""
    if not problem.avoids_itself:
        return CLEAR, math.inf
    verdict, clearance, _ = prove_self(shape, FINEST_PROOF * problem.unit, clock)
    return verdict, clearance


def _progress(found: float, merit: float, slow: int, damping_scale: float) -> tuple[int, float]:
    """Count steps in a row that gain little, and adapt how much the damping is eased; `merit` is the best so far."""
    if found >= merit:
        return slow + 1, 10.0 * damping_scale
    if merit == math.inf:
        return slow, damping_scale
    return slow + 1 if found > 0.8 * merit else 0, max(1e-6, 0.3 * damping_scale)


def descend(
    problem: Problem, states: State, at: int, work: Work, most: int, wish: float, brief: bool
) -> tuple[int, int, int, float, float, bool]:
    """Iterate from state `at` until solved and proved, stuck, or out of time; states 0 and 1 take turns.

    Where it is `brief`, the first step that gains little is the last one, as is the first proof, and no overlap is
    taken for one that samples see alone.

    Steps also wish for the clearance `wish`: a robot that goes on from where it had it keeps it for nothing. Where they
    gain little, they do without: a wish moves the targets' rows by a hundred-millionth of what it is short of.

    Distances are interpolated at first where there are samples. When a proof fails they are exact from then on, and
    when it fails again, contacts are searched for more closely. Self-contacts are searched for from the first failed
    proof that the body does not run through itself on: most shapes never come near themselves.

    Returns which is the best, the verdict of the proofs (MISSED: the targets were not met), the number of iterations,
    the clearances from obstacles and from itself that were seen, and whether limits bound the last step. Of a state
    that was never linearised whole, for lack of time, the merit is infinite.
    """
    project_to_limits(problem, pick(states, at), work)
    depth, tried, merit, damping_scale = problem.step_depth, at, math.inf, 1.0
    # Samples may see an overlap where there is none; then the proof decides.
    coarse = coarseness(problem.scene)
    mode, loose = solids.INTERPOLATED if coarse > 0.0 else solids.EXACT, 0.0 if brief else coarse
    slow = iteration = 0
    bound = with_self = False
    while True:
        trial = pick(states, tried)
        linearise(problem, trial, work, depth, mode, wish, with_self)
        if late(work.clock):
            if merit == math.inf:
                at, trial.norms[s.MERIT] = tried, math.inf
            state = pick(states, at)
            return at, MISSED, iteration, state.norms[s.CLEARANCE_SEEN], state.norms[s.SELF_BOUND], bound
        found = trial.norms[s.MERIT]
        slow, damping_scale = _progress(found, merit, slow, damping_scale)
        if found < merit:
            at, merit = tried, found
        state = pick(states, at)
        if met(problem, state, loose):
            verdict, self_clearance = self_proof(problem, state, work)
            if verdict != CLEAR:
                if with_self or brief:
                    return at, verdict, iteration, state.norms[s.CLEARANCE_SEEN], self_clearance, bound
                with_self, tried, merit, slow, damping_scale = True, at, math.inf, 0, 1.0
                continue
            verdict, clearance = proof(problem, state, work)
            if verdict == CLEAR or brief or depth >= problem.step_depth + 6 or late(work.clock):
                return at, verdict, iteration, clearance, self_clearance, bound
            if mode == solids.INTERPOLATED:
                mode, loose = solids.EXACT, 0.0
            else:
                depth += 2
            tried, merit = at, math.inf
            continue
        sampled = slow >= MOST_SLOW_STEPS and loose > 0.0 and met_by(state, loose)
        if sampled or (wish > 0.0 and slow >= MOST_SLOW_WISHED_STEPS):
            mode, loose = (solids.EXACT, 0.0) if sampled else (mode, loose)
            wish, tried, merit, slow, damping_scale = 0.0, at, math.inf, 0, 1.0
            continue
        if (
            iteration >= most
            or slow >= (1 if brief else MOST_SLOW_STEPS)
            or spend(work.clock, SEGMENT_WORK * state.q.shape[0])
        ):
            return at, MISSED, iteration, state.norms[s.CLEARANCE_SEEN], state.norms[s.SELF_BOUND], bound
        iteration += 1
        wish_nothing(work)
        bound = step(problem, state, work, max(EXACT_DAMPING, 0.01 * damping_scale * merit))
        tried = 1 - at
        move(problem, state, work, pick(states, tried))
