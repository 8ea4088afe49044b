"""Among all solutions, a better one: preferences are minimised within what feasibility leaves.

The cost is `initial |q - reference|^2 + bends |u|^2 + 100 |clearance missing up to the wish|^2`, bends in rad, lengths
relative to the mean of their segment, clearance relative to the robot's length. Its Newton step is the mean motion of
the sweeps; rows of the targets and contacts, met exactly, take out of it what feasibility forbids. Motion is measured
by the Hessian of the cost meanwhile: in another metric what is taken out would end beside the minimum.

`best` (n, 3) is the best configuration so far.
"""

import math
from collections import namedtuple

from sinuous.kernels import tables as t
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.clock import allow, begin, late, now, over
from sinuous.kernels.compile import entry
from sinuous.kernels.fields import solids
from sinuous.kernels.maths.vectors import Array, copy, get_vec, put_vec, scale
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.step.newton import EXACT_DAMPING, linearise, met, move, proof, self_proof, step, wish_nothing
from sinuous.kernels.step.states import ANGLE, POSITION, WISH, State, Work, carve, pick

Wishes = namedtuple("Wishes", ["initial", "bends", "clearance", "reference"])
"""Weights of staying at `reference` (n, 3) and of small bends; clearance wished for."""

IMPROVING = 0.8
"""Share of the time for what is better; the rest is for its proof."""

LEAST_GAIN = 1e-6
"""Share of the cost that a step has to gain to be followed by another."""

MISSING = 0.01
"""Share of the wished clearance that may be missing where nothing else is wished for: steps would come ever closer to
it, and never end."""

CLOSE = 100.0
"""Weight of the clearance that is missing."""

LOOSEST = 3.0
"""How much farther than bends lengths move at most: small bends alone leave them free."""

LEAST_STEP = 1e-2
"""Share of a step that is tried at least: near limits of several lengths only short ones lower the cost."""

DEEPEST = 6
"""How much deeper contacts are searched for at most than other steps do."""

CORRECTIONS = 3
"""Most Newton steps back to the targets after a step towards what is preferred."""


def measure_cost(problem: Problem, state: State, wishes: Wishes) -> float:
    """What is disliked about a state."""
    total = CLOSE * state.norms[WISH]
    for k in range(state.q.shape[0]):
        ux, uy, length = state.q[k, 0], state.q[k, 1], state.q[k, 2]
        stretch = problem.limits[k, t.LENGTH_SCALE]
        total += wishes.bends * (ux * ux + uy * uy)
        away = (ux - wishes.reference[k, 0]) ** 2 + (uy - wishes.reference[k, 1]) ** 2
        if stretch > 0.0:
            away += ((length - wishes.reference[k, 2]) / stretch) ** 2
        total += wishes.initial * away
    return total


def _looseness(wishes: Wishes) -> float:
    """How many times farther than in the metric of other steps lengths move beside bends in that of the cost."""
    weight = wishes.initial + wishes.bends
    if weight == 0.0:
        return 1.0
    if weight >= LOOSEST * LOOSEST * wishes.initial:
        return LOOSEST
    return math.sqrt(weight / wishes.initial)


def _wish_for_less(state: State, work: Work, wishes: Wishes, step_length: float) -> None:
    """Wish for `step_length` of the motion to where the cost of start and bends is least."""
    weight, loose = wishes.initial + wishes.bends, _looseness(wishes)
    for k in range(state.q.shape[0]):
        x = y = z = 0.0
        if weight > 0.0:
            x = wishes.initial / weight * wishes.reference[k, 0] - state.q[k, 0]
            y = wishes.initial / weight * wishes.reference[k, 1] - state.q[k, 1]
        if wishes.initial > 0.0:
            z = loose * loose * wishes.initial / weight * (wishes.reference[k, 2] - state.q[k, 2])
        put_vec(work.mean, k, 0, (step_length * x, step_length * y, step_length * z))


def _measure_motion(problem: Problem, measured: Problem, q: Array, loose: float, holds: bool) -> None:
    """Measure motion by the cost. What `holds` lets lengths that a step has led to a limit stay there.

    Otherwise corrections lead them away from it again, step after step, and none of these gains what it promises.
    """
    for k in range(q.shape[0]):
        moves = not holds or problem.limits[k, t.MIN_LENGTH] < q[k, 2] < problem.limits[k, t.MAX_LENGTH]
        measured.limits[k, t.LENGTH_SCALE] = loose * problem.limits[k, t.LENGTH_SCALE] if moves else 0.0


def _return_to_targets(
    problem: Problem,
    measured: Problem,
    states: State,
    at: int,
    spare: int,
    work: Work,
    depth: int,
    wish: float,
    with_self: bool,
) -> int:
    """Bring a state that left its targets a little back to them; returns where it is then, `at` or `spare`."""
    for _ in range(CORRECTIONS):
        state, trial = pick(states, at), pick(states, spare)
        if met(problem, state, 0.0):
            return at
        wish_nothing(work)
        linearise(problem, state, work, depth, solids.EXACT, 0.0, with_self)
        step(measured, state, work, EXACT_DAMPING)
        move(problem, state, work, trial)
        linearise(problem, trial, work, depth, solids.EXACT, wish, with_self)
        at, spare = spare, at
    return at


def lower_cost(
    problem: Problem,
    measured: Problem,
    states: State,
    work: Work,
    wishes: Wishes,
    best: Array,
    most: int,
    depth: int,
    with_self: bool,
) -> int:
    """Lower the cost of the solved `best`, keeping it solved, while there is time. Returns the iterations.

    `measured` is the problem where motion is measured by the cost. Self-contacts are examined only `with_self`.
    """
    at, free, spare, loose = 0, 1, 2, _looseness(wishes)
    start = pick(states, at)
    copy(best, start.q)
    _measure_motion(problem, measured, best, loose, False)
    linearise(problem, start, work, depth, solids.EXACT, wishes.clearance, with_self)
    least = measure_cost(problem, start, wishes)
    step_length, enough = 1.0, 0.0
    if wishes.initial + wishes.bends == 0.0:
        enough = CLOSE * (MISSING * wishes.clearance / problem.unit) ** 2
    for iteration in range(most):
        if least <= enough or step_length < LEAST_STEP or over(work.clock):
            return iteration
        state, trial = pick(states, at), pick(states, free)
        _wish_for_less(state, work, wishes, step_length)
        step(measured, state, work, EXACT_DAMPING)
        if wishes.initial + wishes.bends == 0.0:
            for k in range(state.q.shape[0]):
                put_vec(work.step, k, 0, scale(step_length, get_vec(work.step, k, 0)))
        move(problem, state, work, trial)
        linearise(problem, trial, work, depth, solids.EXACT, wishes.clearance, with_self)
        _measure_motion(problem, measured, trial.q, loose, step_length < 1.0)
        found_at = _return_to_targets(problem, measured, states, free, spare, work, depth, wishes.clearance, with_self)
        _measure_motion(problem, measured, trial.q, loose, False)
        free, spare = found_at, free + spare - found_at
        found = pick(states, free)
        if late(work.clock):  # contacts are missing
            return iteration
        better = measure_cost(problem, found, wishes)
        if met(problem, found, 0.0) and better < least:
            gained = least - better
            least = better
            at, free = free, at
            copy(found.q, best)
            if gained < LEAST_GAIN * least:
                return iteration + 1
            step_length = min(1.0, 2.0 * step_length)
        else:
            step_length *= 0.5
    return most


@entry
def prefer(
    robot: Array,
    scene: Array | None,
    settings: Array,
    targets: Array,
    reference: Array,
    proved: tuple[float, float, float, float, float],
    workspace: Array,
    best: Array,
) -> tuple[int, float, float, float, float, float]:
    """Improve the solved `best` (n, 3) and prove it again; what is not proved is not taken.

    `reference` (n, 3) is the configuration to stay close to; `proved` holds position error, angle error, proved
    clearance and self-clearance of `best`, and the seconds that may be spent; the rest is as for `search.search`, but
    `workspace` ends with as many numbers more as `robot` has. Returns the iterations, the first four of `proved` for
    what `best` holds then, and the seconds that were spent.

    Self-contacts are dear to search for, and most shapes never come near themselves. So they are left out, until the
    proof finds that the body has come to run through itself. Contacts are searched for more closely where it finds one.
    """
    problem = read_problem(robot, scene, settings, targets)
    states, work = carve(workspace, problem)
    wishes = Wishes(settings[t.INITIAL_WEIGHT], settings[t.BENDS_WEIGHT], settings[t.WISHED_CLEARANCE], reference)
    loosened = workspace[workspace.shape[0] - robot.shape[0] :]
    for i in range(robot.shape[0]):
        loosened[i] = robot[i]
    measured = read_problem(loosened, scene, settings, targets)
    copy(best, work.solved)
    begin(work.clock)
    began, used, most = now(work.clock), 0, int(settings[t.MAX_ITERATIONS])
    with_self, depth = False, problem.step_depth + 2
    while True:
        left = began + proved[4] - now(work.clock)
        allow(work.clock, IMPROVING * left)
        used += lower_cost(problem, measured, states, work, wishes, best, most, depth, with_self)
        allow(work.clock, began + proved[4] - now(work.clock))
        state = pick(states, 0)
        copy(best, state.q)
        linearise(problem, state, work, problem.step_depth, solids.EXACT, 0.0, False)
        own, self_clearance = self_proof(problem, state, work)
        verdict, clearance = proof(problem, state, work) if own == CLEAR else (CLEAR, 0.0)
        if own == CLEAR and verdict == CLEAR and met(problem, state, 0.0):
            return used, state.norms[POSITION], state.norms[ANGLE], clearance, self_clearance, now(work.clock) - began
        copy(work.solved, best)
        if late(work.clock):
            break
        if own != CLEAR and not with_self:
            with_self = True
        elif verdict != CLEAR and depth < problem.step_depth + DEEPEST:
            depth += 2
        else:
            break
    return used, proved[0], proved[1], proved[2], proved[3], now(work.clock) - began
