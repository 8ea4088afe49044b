"""The chain moved off the walls, once it lies along a route.

A descent keeps no more clearance than it has to, and to prove a hair's breadth takes hundreds of times as long as to
prove a tenth of the radius. The route has more: it lies in the middle of where it leads through.
"""

import math

from sinuous.kernels.body.rows import INNER, put_body_row
from sinuous.kernels.chain.kinematics import body_point, forward_with_columns
from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.fields.distances import closest, obstacle, price
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.fitting.curve import Curve, closest_on, length_of
from sinuous.kernels.maths.vectors import Vec, copy, scale
from sinuous.kernels.problem import Problem
from sinuous.kernels.step import actuation
from sinuous.kernels.step.newton import add_targets, close, move, rest, step
from sinuous.kernels.step.states import State, Work, pick
from sinuous.kernels.tables import RADIUS

PLACES = 12
"""Places of every segment that are kept off the walls."""

ROUNDS = 10
"""Most Newton steps."""

SHARE, ROOM = 0.5, 0.5
"""Of the clearance that the route has beside a place, how much the place should have; no more than so many radii."""

BEST = 2
"""The state that keeps the best configuration."""

WINDOW = 0.1
"""How far the place beside it may be from where it belongs, of the length of the route."""

MU = 1e-5
"""Damping of the steps."""


def _wished(problem: Problem, curve: Curve, k: int, share: float, p: Vec) -> float:
    """Distance from the obstacles that the place `p` of segment `k` should have."""
    radius = problem.limits[k, RADIUS]
    foot, _ = closest_on(curve, p, share * length_of(curve), WINDOW * length_of(curve))
    d, _ = closest(problem.scene, foot, (1.0 + ROOM / SHARE) * radius, STEP)
    return radius + min(ROOM * radius, max(problem.margin, SHARE * (d - radius)))


def push_off(problem: Problem, state: State, curve: Curve) -> tuple[float, int]:
    """Linearise: rows that push places off the walls, and the targets.

    Returns the least clearance of all places, and how many are pushed.
    """
    q, rows = state.q, state.rows
    forward_with_columns(q, state.frames, state.columns)
    least = math.inf
    at = actuator = pushed = 0
    total = begin = 0.0
    for k in range(q.shape[0]):
        total += q[k, 2]
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        radius = problem.limits[k, RADIUS]
        for j in range(PLACES):
            s = (j + 1.0) / PLACES
            along = begin + s * q[k, 2]
            if along < problem.mount:
                continue
            p = body_point(q, state.frames, k, s)
            d, which = closest(problem.scene, p, (1.0 + ROOM) * radius + problem.margin, STEP)
            least = min(least, d - radius)
            if d >= radius + ROOM * radius:
                continue
            wished = _wished(problem, curve, k, along / total, p)
            if d < wished:
                d, gradient = obstacle(problem.scene, which, p, d)
                force = scale(1.0 / problem.unit, gradient)
                at = put_body_row(rows, at, q, state.frames, (k, s, p), force, INNER, (wished - d) / problem.unit)
                pushed += 1
        begin += q[k, 2]
        at, _, _ = add_targets(problem, state, k, at)
    close(state, at)
    return least, pushed


def clear(problem: Problem, states: State, at: int, work: Work, curve: Curve) -> int:
    """Move the chain of state `at` off the walls, as far as the time allows; returns the state that holds the result.

    States 0 and 1 take turns; state 2 keeps the clearest configuration.
    """
    if problem.scene.table.shape[0] == 0:
        return at
    best, most = pick(states, BEST), -math.inf
    looks = best.q.shape[0] * (SEGMENT_LOOKS + PLACES * price(problem.scene))
    for _ in range(ROUNDS):
        state = pick(states, at)
        least, rows = push_off(problem, state, curve)
        if least > most:
            most = least
            copy(state.q, best.q)
        if rows == 0 or spend(work.clock, looks):
            break
        rest(work)
        step(problem, state, work, MU)
        move(problem, state, work, pick(states, 1 - at))
        at = 1 - at
    return BEST
