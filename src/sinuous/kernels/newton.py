"""Damped Gauss-Newton from one start: linearise, step in two sweeps, keep what gets better."""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels import actuation, limits, sweeps
from sinuous.kernels.body import CLEAR, PER_SEGMENT, contacts, prove
from sinuous.kernels.chain import forward, frame, put_frame, spatial_columns
from sinuous.kernels.clock import now
from sinuous.kernels.compile import kernel
from sinuous.kernels.sweeps import carve_rows, rows_size
from sinuous.kernels.targets import add_rows, end_segment
from sinuous.kernels.vectors import Array, put_vec

Problem = namedtuple(
    "Problem",
    [
        "limits",
        "actuation",
        "base",
        "tool",
        "scene",
        "targets",
        "mount",
        "unit",
        "margin",
        "position_tolerance",
        "angle_tolerance",
    ],
)
"""What does not change during a solve: tables of robot, scene and targets; lengths that scale and bound."""

State = namedtuple("State", ["q", "frames", "columns", "rows", "norms"])
"""A configuration and the problem linearised there. `norms`: merit, position error, angle error, least clearance seen."""

Work = namedtuple("Work", ["root", "mean", "step", "bound", "among", "clock"])
"""Scratch of one solve."""

MERIT, POSITION, ANGLE, SEEN = 0, 1, 2, 3

ROUNDS = 4
"""Most times that a step is taken back because it would leave a limit, and computed anew along that limit."""


@kernel
def _capacity(problem: Problem) -> int:
    contacts_at_most = problem.limits.shape[0] * PER_SEGMENT if problem.scene.shape[0] > 0 else 0
    return 6 * problem.targets.shape[0] + contacts_at_most + problem.actuation.shape[0]


@kernel
def state_size(problem: Problem) -> int:
    """Numbers that `carve_state` takes from a buffer."""
    n = problem.limits.shape[0]
    return 33 * n + 16 + rows_size(n, _capacity(problem))


@kernel
def carve_state(buffer: Array, problem: Problem) -> State:
    """Lay out a state in the beginning of `buffer`; its base is the robot's."""
    n = problem.limits.shape[0]
    frames = buffer[3 * n : 15 * n + 12].reshape((n + 1, 12))
    rotation, position = frame(problem.base, 0)
    put_frame(frames, 0, rotation, position)
    return State(
        buffer[: 3 * n].reshape((n, 3)),
        frames,
        buffer[15 * n + 12 : 33 * n + 12].reshape((n, 18)),
        carve_rows(buffer[33 * n + 16 :], n, _capacity(problem)),
        buffer[33 * n + 12 : 33 * n + 16],
    )


@kernel
def work_size(problem: Problem) -> int:
    """Numbers that `carve_work` takes from a buffer."""
    return 16 * problem.limits.shape[0] + problem.scene.shape[0] + 2


@kernel
def carve_work(buffer: Array, problem: Problem) -> Work:
    """Lay out scratch in the beginning of `buffer`."""
    n, m = problem.limits.shape[0], problem.scene.shape[0]
    return Work(
        buffer[: 9 * n].reshape((n, 9)),
        buffer[9 * n : 12 * n].reshape((n, 3)),
        buffer[12 * n : 15 * n].reshape((n, 3)),
        buffer[15 * n : 16 * n].view(np.int64),
        buffer[16 * n : 16 * n + m].view(np.int64),
        buffer[16 * n + m : 16 * n + m + 2].view(np.int64),
    )


@kernel
def linearise(problem: Problem, state: State, work: Work, depth: int) -> None:
    """Fill frames, rows and norms of `state` for its configuration."""
    q, frames, rows = state.q, state.frames, state.rows
    forward(q, frames)
    origin = frame(frames, 0)[1]
    off = turn = 0.0
    seen = math.inf
    mount = problem.mount
    at = actuator = 0
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        if problem.scene.shape[0] > 0:
            at, least = contacts(
                problem.limits,
                q,
                frames,
                problem.scene,
                k,
                mount,
                problem.margin,
                depth,
                origin,
                problem.unit,
                work.among,
                rows,
                at,
            )
            seen = min(seen, least)
            mount -= q[k, 2]
        for i in range(problem.targets.shape[0]):
            if end_segment(problem.targets, i, q.shape[0]) == k:
                at, miss, angle = add_rows(problem.targets, i, frames, problem.tool, origin, problem.unit, rows, at)
                off, turn = max(off, miss), max(turn, angle)
    rows.start[q.shape[0]] = at
    merit = 0.0
    for i in range(at):
        merit += rows.value[i] * rows.value[i]  # idle rows hold 0
    norms = state.norms
    norms[MERIT], norms[POSITION], norms[ANGLE], norms[SEEN] = merit, off, turn, seen


@kernel
def step(problem: Problem, state: State, work: Work, mu: float) -> bool:
    """Fill `work.step` with the damped Newton step that keeps the limits; say whether limits bound it."""
    limits.release(problem.limits, work.root, work.mean, work.bound)
    bound = False
    coupled = problem.actuation.shape[0] > 0
    if coupled:
        actuation.release(state.rows)
    for _ in range(ROUNDS):
        sweeps.forward(state.columns, work.root, work.mean, state.rows, mu, coupled)
        sweeps.backward(state.columns, work.root, work.mean, state.rows, work.step, coupled)
        count = limits.bind(problem.limits, state.q, work.step, work.root, work.mean, work.bound)
        if coupled:
            count += actuation.bind(problem.actuation, state.q, work.step, state.rows)
        if count == 0:
            break
        bound = True
    return bound


@kernel
def move(problem: Problem, state: State, work: Work, trial: State) -> None:
    """Take the step, within all limits."""
    limits.move(problem.limits, state.q, work.step, trial.q)
    actuation.hold_back(problem.actuation, state.q, trial.q)


@kernel
def enter(problem: Problem, state: State, work: Work) -> None:
    """Bring the configuration of `state` within all limits."""
    q = state.q
    for k in range(q.shape[0]):
        put_vec(q, k, 0, limits.retract(problem.limits, k, q[k, 0], q[k, 1], q[k, 2]))
    actuation.straighten(problem.actuation, q, work.step)


@kernel
def met(problem: Problem, state: State) -> bool:
    """Targets within tolerance, and no overlap seen."""
    norms = state.norms
    return bool(
        norms[POSITION] <= problem.position_tolerance
        and norms[ANGLE] <= problem.angle_tolerance
        and norms[SEEN] >= 0.0
    )


@kernel
def descend(
    problem: Problem, state: State, trial: State, work: Work, most: int, deadline: float
) -> tuple[State, State, int, int, float, bool]:
    """Iterate from `state.q` until solved and proved, stuck, or out of time.

    Returns the best state and the other one, the verdict of the proof (-1: the targets were not met), the number of iterations, the
    proved clearance, and whether limits bound the last step.
    """
    depth = 3
    enter(problem, state, work)
    linearise(problem, state, work, depth)
    easing = 1.0
    slow = 0
    bound = False
    for iteration in range(most + 1):
        if met(problem, state):
            if problem.scene.shape[0] == 0:
                return state, trial, CLEAR, iteration, math.inf, bound
            verdict, clearance, _, _, _ = prove(
                problem.limits,
                state.q,
                state.frames,
                problem.scene,
                problem.mount,
                0.1,
                1e-7 * problem.unit,
                work.among,
            )
            if verdict == CLEAR or depth >= 9:
                return state, trial, verdict, iteration, clearance, bound
            depth += 2
            linearise(problem, state, work, depth)
            continue
        if iteration == most or slow >= 6 or (deadline > 0.0 and now(work.clock) > deadline):
            return state, trial, -1, iteration, 0.0, bound
        merit = state.norms[MERIT]
        mu = max(1e-10, 0.01 * easing * merit)
        spatial_columns(state.q, state.frames, frame(state.frames, 0)[1], state.columns)
        bound = step(problem, state, work, mu)
        move(problem, state, work, trial)
        linearise(problem, trial, work, depth)
        if trial.norms[MERIT] < merit:
            slow = slow + 1 if trial.norms[MERIT] > 0.8 * merit else 0
            easing = max(1e-6, 0.3 * easing)
            state, trial = trial, state
        else:
            slow += 1
            easing *= 10.0
    return state, trial, -1, most, 0.0, bound


