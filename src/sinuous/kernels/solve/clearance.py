"""Room: a robot touches nothing that it need not, so an answer that ends in contact is led away from it."""

import math

from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.clock import late
from sinuous.kernels.fields import solids
from sinuous.kernels.fields.distances import coarseness
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.newton import EXACT_DAMPING, linearise, met, move, proof, self_proof, step, wish_nothing
from sinuous.kernels.step.states import ANGLE, CLEARANCE_SEEN, MERIT, POSITION, WISH, State, Work, pick

GRAZING = 0.2
"""Share of the room below which a clearance is contact."""

CLEARANCE_STEPS = 3
"""Most steps out of contact: in tubes they are dear, and further ones gain little."""

IN_VAIN = 0.9
"""Share of what is missing that a step has to leave less than, or room is sought in vain."""

Known = tuple[float, float, float, float, float]
"""Of an answer: position error, angle error, clearance, self-clearance and merit."""


def increase_clearance(
    problem: Problem, states: State, work: Work, margin: float, known: Known, best: Array
) -> tuple[int, Known]:
    """Lead the solved `best` (n, 3) out of contact, if it is in contact, and some steps do that; it stays proved.

    A step meets the targets exactly, and with what they leave of the motion takes a clearance of `margin` (length).
    Returns the number of steps, and what is known of `best` then.
    """
    if margin <= 0.0 or known[2] >= GRAZING * margin:
        return 0, known
    depth, mode = problem.step_depth + 2, solids.INTERPOLATED if coarseness(problem.scene) > 0.0 else solids.EXACT
    at, used, missing = 0, 0, math.inf
    copy(best, pick(states, at).q)
    while True:
        state = pick(states, at)
        linearise(problem, state, work, depth, mode, margin, False)
        if late(work.clock):
            return used, known
        if used == CLEARANCE_STEPS or not 0.0 < state.norms[WISH] < IN_VAIN * missing:
            break
        missing = state.norms[WISH]
        wish_nothing(work)
        step(problem, state, work, EXACT_DAMPING)
        at, used = 1 - at, used + 1
        move(problem, state, work, pick(states, at))
    if used == 0 or state.norms[CLEARANCE_SEEN] <= known[2] or not met(problem, state, 0.0):
        return used, known
    own, self_clearance = self_proof(problem, state, work)
    if own != CLEAR:
        return used, known
    verdict, clearance = proof(problem, state, work)
    if verdict != CLEAR or clearance <= known[2]:  # a bound may be less tight than the one before
        return used, known
    copy(state.q, best)
    return used, (state.norms[POSITION], state.norms[ANGLE], clearance, self_clearance, state.norms[MERIT])
