"""A start followed briefly, as long as it touches nothing: of several starts most of what is dear is spared so.

Where a descent comes into contact, its steps and proofs take a hundred times as long as elsewhere, and what it ends in
is a place from which the next descent comes into contact. Often another start nearby leads past, in two steps.
"""

import math

from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.clock import late
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields import solids
from sinuous.kernels.fields.distances import coarseness
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.newton import (
    EXACT,
    MISSED,
    linearise,
    met,
    move,
    project_to_limits,
    proof,
    rest,
    self_proof,
    step,
)
from sinuous.kernels.step.states import MERIT, SEEN, State, Work, pick

BRIEF = 5
"""Steps of Newton's method that meet targets nearby."""


@kernel
def approach(problem: Problem, states: State, at: int, work: Work, wish: float) -> tuple[int, int, int, float, float]:
    """Follow the start in state `at` for some steps, unless it touches something; states 0 and 1 take turns.

    Returns which state it led to, the verdict of the proofs (MISSED: the targets were not met clear of everything), the
    number of steps, and the clearances from obstacles and from itself.
    """
    project_to_limits(problem, pick(states, at), work)
    mode = solids.STEP if coarseness(problem.scene) > 0.0 else solids.EXACT
    for used in range(BRIEF + 1):
        state = pick(states, at)
        linearise(problem, state, work, problem.step_depth, mode, wish, False)
        if used == BRIEF or late(work.clock) or met(problem, state, 0.0):
            break
        rest(work)
        step(problem, state, work, max(EXACT, 0.01 * state.norms[MERIT]))
        at = 1 - at
        move(problem, state, work, pick(states, at))
    state = pick(states, at)
    if late(work.clock) or not met(problem, state, 0.0):
        return at, MISSED, used, state.norms[SEEN], math.inf
    own, self_clearance = self_proof(problem, state, work)
    if own != CLEAR:
        return at, own, used, state.norms[SEEN], self_clearance
    verdict, clearance = proof(problem, state, work)
    return at, verdict, used, clearance, self_clearance
