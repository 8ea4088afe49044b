"""A chain drawn to its targets in short steps, so that it stays between the obstacles that it lies between.

A descent goes straight for the targets: its first step is as long as the chain is off, and what then overlaps may be
pushed off to the wrong side of a wall.
"""

from sinuous.kernels.body.rows import END
from sinuous.kernels.clock import SEGMENT_WORK, spend
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.newton import linearise, move, project_to_limits, step, wish_nothing
from sinuous.kernels.step.states import ANGLE, CLEARANCE_SEEN, POSITION, State, Work, pick
from sinuous.kernels.tables import RADIUS

MOST_STEPS = 60
"""Most steps."""

REACH_STEP, TURN_STEP = 0.25, 0.08
"""How far a step moves what is asked for and what overlaps: in radii of the body at its end, and in rad."""

LEAST_REACH = 1e-3
"""How far it does at least, in lengths of the robot."""

DAMPING = 2e-5
"""Damping of the steps."""


def _hold_back(problem: Problem, state: State) -> None:
    """Ask less of a step than would meet the targets and end all overlaps."""
    n, rows = problem.limits.shape[0], state.rows
    reach = max(REACH_STEP * problem.limits[n - 1, RADIUS], LEAST_REACH * problem.unit)
    off, turn = state.norms[POSITION], state.norms[ANGLE]
    fraction = min(1.0, reach / off if off > 0.0 else 1.0, TURN_STEP / turn if turn > 0.0 else 1.0)
    for i in range(rows.start[n]):
        if rows.kind[i] == END:
            rows.value[i] *= fraction
        else:
            rows.value[i] = min(rows.value[i], reach / problem.unit)


def draw_to_targets(problem: Problem, states: State, work: Work) -> int:
    """Draw the chain of state 0 to the targets, as far as the time allows; returns the state with the result.

    States 0 and 1 take turns.
    """
    at, n = 0, problem.limits.shape[0]
    project_to_limits(problem, pick(states, at), work)
    for _ in range(MOST_STEPS):
        state = pick(states, at)
        linearise(problem, state, work, problem.step_depth, INTERPOLATED, 0.0, False)
        off, turn = state.norms[POSITION], state.norms[ANGLE]
        there = off <= problem.position_tolerance and turn <= problem.angle_tolerance
        if (there and state.norms[CLEARANCE_SEEN] >= 0.0) or spend(work.clock, SEGMENT_WORK * n):
            break
        _hold_back(problem, state)
        wish_nothing(work)
        step(problem, state, work, DAMPING)
        move(problem, state, work, pick(states, 1 - at))
        at = 1 - at
    return at
