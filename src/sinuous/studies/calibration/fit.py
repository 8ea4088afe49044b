"""The parameters that measurements say: damped Gauss-Newton with a soft loss (Nocedal & Wright, section 10.3).

The loss of a row whose points are off by `r` altogether is `2 s^2 (sqrt(1 + r^2 / s^2) - 1)`: squares of what is usual,
no more than linear in outliers. Drawings count as measurements that are off by `parameters.WIDTHS`.

Mistakes that tables of measurements have: exchanged columns, signs, units, rows that are late.

Each is tried on the robot as drawn, aligned with the rows. One that leaves less error than the fit did is told, not
mended.

Play of actuators: how far a motor turns back before the tip follows, as friction makes it, too.

A displacement stays where it is until the motor is more than half of the play away from it (the play operator: Brokate
& Sprekels 1996, Hysteresis and Phase Transitions). So it depends on the motion before; rows are in the order of time.
"""

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, counted
from sinuous.model.actuators import Motors
from sinuous.model.poses import rotation_of
from sinuous.model.robot import Robot
from sinuous.studies.calibration.measurements import UNIT_FACTORS, Measurements
from sinuous.studies.calibration.model import RobotModel, derivatives, model, predicted
from sinuous.studies.calibration.parameters import ParameterGroup, Values, lines_of

OUTLIER_MEDIANS = 3.0
"""Medians of the residuals from which on a row counts as an outlier."""

DRAWING_WEIGHT = 0.1
"""How many rows the drawing counts as, for each that was measured: rows of one motion are not independent."""

MOST_STEPS = 30
"""Most steps of a fit."""

LEAST_GAIN = 1e-4
"""A fit ends when a step lessens the loss by less than this share."""

DAMPING_TRIES = 8
"""How often a step that does not lessen the loss is damped more."""

SCALE_ROUNDS = 2, 8
"""How often the scale of the loss is taken anew: at least, and at most, as long as it becomes less than half."""

POSE_TURNS = 4
"""How often a robot that gravity bends is aligned with its measurements: the pose turns it under gravity."""

LEAST_SCALE = 1e-9
"""Lengths of the robot: the least scale of the loss."""


class FitState(NamedTuple):
    """Values of all that is fitted.

    Attributes
    ----------
    pose : ndarray (4, 4)
        From the world of the robot to the frame of the measuring device.
    levelled : bool
        Whether gravity is known in that frame, so that another pose turns the robot under it; else it turns with it.
    values : Values
    """

    pose: Floats
    levelled: bool
    values: Values


class Fit(NamedTuple):
    """What a fit ends with.

    Attributes
    ----------
    state : FitState
    residuals : ndarray (N, k, 3)
        Predicted less measured; 0 where nothing was seen.
    slopes : ndarray (N, k, 3, P)
        Their derivatives by the twist of the pose (6), then by the parameters.
    weights : ndarray (N,)
        Of the rows in the soft loss.
    scale : float
    hessian : ndarray (P, P)
        Of half the loss, the drawing included.
    """

    state: FitState
    residuals: Floats
    slopes: Floats
    weights: Floats
    scale: float
    hessian: Floats


def predict(drawn: Robot, state: FitState, rows: Measurements) -> Floats:
    """Points (N, k, 3) in the frame of the device."""
    points = predicted(_model(drawn, state, rows), rows.actuators)
    return points @ state.pose[:3, :3].T + state.pose[:3, 3]


def _model(drawn: Robot, state: FitState, rows: Measurements) -> RobotModel:
    if state.levelled and drawn.gravity is not None:
        drawn = drawn.changed(gravity=drawn.gravity @ state.pose[:3, :3])
    return model(drawn, state.values, rows.places)


def errors(residuals: Floats) -> Floats:
    """How far a row is off altogether (N,)."""
    return np.sqrt(np.einsum("nkc,nkc->n", residuals, residuals))


def fitted(drawn: Robot, start: FitState, rows: Measurements, steps: int = MOST_STEPS) -> Fit:
    """Fit a state to measurements."""
    state, seen = start, np.isfinite(rows.points)
    goal = np.where(seen, rows.points, 0.0)

    def residuals_of(state: FitState) -> Floats:
        return np.where(seen, predict(drawn, state, rows) - goal, 0.0)

    residuals = residuals_of(state)
    least = LEAST_SCALE * drawn.mean_length
    fit, scale = None, np.inf
    for turn in range(SCALE_ROUNDS[1]):
        smaller = max(OUTLIER_MEDIANS * float(np.median(errors(residuals))), least)
        if turn >= SCALE_ROUNDS[0] and smaller > 0.5 * scale:
            break
        scale = smaller
        loss, damping = _loss(state, residuals, scale), 1e-4
        for _ in range(steps):
            slopes = _slopes(drawn, state, rows) * seen[..., None]
            fit = _assembled(state, residuals, slopes, scale)
            better = _step(fit, residuals_of, loss, damping)
            if better is None:
                break
            before, (state, residuals, loss, damping) = loss, better
            if before - loss < LEAST_GAIN * before:
                break
    assert fit is not None
    slopes = _slopes(drawn, state, rows) * seen[..., None]
    return _assembled(state, residuals, slopes, scale)


def _step(
    fit: Fit, residuals_of: Callable[[FitState], Floats], loss: float, damping: float
) -> tuple[FitState, Floats, float, float] | None:
    """A step that lessens the loss: state, residuals, loss and damping after it; None where there is none."""
    right, hessian = _gradient(fit), np.array(fit.hessian)
    values = fit.state.values
    stuck = np.concatenate([np.zeros(6, np.bool_), (values.x <= values.lowest) & (right[6:] > 0.0)])
    right[stuck], hessian[stuck], hessian[:, stuck] = 0.0, 0.0, 0.0  # at their least values they stay (Bertsekas 1982)
    hessian[stuck, stuck] = 1.0
    for _ in range(DAMPING_TRIES):
        damped = hessian + damping * np.diag(np.diag(hessian))
        state = moved(fit.state, -np.asarray(np.linalg.solve(damped, right), np.float64))
        try:
            residuals = residuals_of(state)
        except (InputError, np.linalg.LinAlgError, OverflowError):  # a step into what no robot is
            residuals = None
        if residuals is not None:
            new = _loss(state, residuals, fit.scale)
            if new < loss:
                return state, residuals, new, damping / 5.0
        damping *= 10.0
    return None


def moved(state: FitState, step: Floats) -> FitState:
    """A state after a step (P,): the pose by a twist in the frame of the device, then the parameters."""
    pose = np.eye(4)
    pose[:3, :3] = rotation_of(step[:3]) @ state.pose[:3, :3]
    pose[:3, 3] = state.pose[:3, 3] + step[3:6]
    values = state.values
    return state._replace(pose=pose, values=values.with_x(np.maximum(values.x + step[6:], values.lowest)))


def _slopes(drawn: Robot, state: FitState, rows: Measurements) -> Floats:
    own = _model(drawn, state, rows)
    turns = state.levelled and own.robot.has_external_load
    points, slopes = derivatives(own, rows.actuators, of_gravity=turns)
    rotation = state.pose[:3, :3]
    slopes = np.asarray(np.matmul(rotation, slopes), np.float64)
    pose = by_pose(points @ rotation.T)
    if turns:  # a turn of the robot turns gravity the other way in its own world
        pose[..., :3] += slopes[..., -3:] @ rotation.T @ _crossing(np.asarray(drawn.gravity))
        slopes = slopes[..., :-3]
    return np.concatenate([pose, slopes], axis=-1)


def by_pose(points: Floats) -> Floats:
    """Derivatives (..., 3, 6) of points (..., 3) by a small turn about the origin, and a small motion."""
    return np.concatenate([-_crossing(points), np.broadcast_to(np.eye(3), (*points.shape, 3))], axis=-1)


def _crossing(vectors: Floats) -> Floats:
    """Matrices (..., 3, 3) that make cross products `vectors x ...`."""
    return -np.cross(vectors[..., None, :], np.eye(3))


def _loss(state: FitState, residuals: Floats, scale: float) -> float:
    off = np.einsum("nkc,nkc->n", residuals, residuals) / scale**2
    drawing = DRAWING_WEIGHT * len(residuals) * float(((state.values.x / state.values.widths) ** 2).sum())
    return float(2.0 * (np.sqrt(1.0 + off) - 1.0).sum()) + drawing


def _assembled(state: FitState, residuals: Floats, slopes: Floats, scale: float) -> Fit:
    weights = 1.0 / np.sqrt(1.0 + np.einsum("nkc,nkc->n", residuals, residuals) / scale**2)
    flat = slopes.reshape(len(slopes), -1, slopes.shape[-1])
    weighted = (flat * weights[:, None, None]).reshape(-1, flat.shape[-1])
    hessian = weighted.T @ flat.reshape(-1, flat.shape[-1]) / scale**2
    at = np.arange(6, len(hessian))
    hessian[at, at] += DRAWING_WEIGHT * len(residuals) / state.values.widths**2
    return Fit(state, residuals, slopes, weights, scale, hessian)


def _gradient(fit: Fit) -> Floats:
    """Gradient (P,) of half the loss."""
    result: Floats = np.einsum("n,nkcp,nkc->p", fit.weights, fit.slopes, fit.residuals, optimize=True) / fit.scale**2
    values = fit.state.values
    result[6:] += DRAWING_WEIGHT * len(fit.residuals) * values.x / values.widths**2
    return result


def left_out(fit: Fit, rows: Measurements, drawn: Robot) -> Floats:
    """Residuals (N, k, 3) of rows, each by a fit without its part: one Gauss-Newton step from the whole fit."""
    result = np.array(fit.residuals)
    flat = fit.slopes.reshape(len(fit.slopes), -1, fit.slopes.shape[-1])
    for fold in np.unique(rows.folds):
        mine = rows.folds == fold
        own = flat[mine]
        weighted = own * fit.weights[mine, None, None]
        hessian = fit.hessian - np.einsum("nkp,nkq->pq", weighted, own, optimize=True) / fit.scale**2
        pulled = np.einsum("nkp,nk->p", weighted, fit.residuals[mine].reshape(len(own), -1)) / fit.scale**2
        step = np.linalg.lstsq(hessian, pulled, rcond=1e-12)[0]
        part = rows.part(mine)
        try:
            off = predict(drawn, moved(fit.state, step), part) - part.points
        except (InputError, np.linalg.LinAlgError, OverflowError):
            off = np.einsum("nkp,p->nk", own, step).reshape(fit.residuals[mine].shape) + fit.residuals[mine]
        result[mine] = np.where(np.isfinite(part.points), off, 0.0)
    return result


def begun(drawn: Robot, rows: Measurements, levelled: bool, groups: tuple[ParameterGroup, ...] = ()) -> FitState:
    """The drawing, aligned with the measurements (Kabsch), anew where the robot turns under gravity."""
    state = FitState(np.eye(4), levelled, Values(groups, np.zeros(sum(len(each.names) for each in groups))))
    seen = np.isfinite(rows.points).all(axis=-1)
    there = rows.points[seen]
    for _ in range(POSE_TURNS if levelled and drawn.has_external_load else 1):
        points = predicted(_model(drawn, state, rows), rows.actuators)[seen]
        a, b = np.median(points, axis=0), np.median(there, axis=0)
        u, _, vt = np.linalg.svd((there - b).T @ (points - a))
        pose = np.eye(4)
        pose[:3, :3] = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
        pose[:3, 3] = b - pose[:3, :3] @ a
        state = state._replace(pose=pose)
    return state


def extended(state: FitState, group: ParameterGroup) -> FitState:
    """The same state with one more group of parameters, as drawn."""
    values = Values((*state.values.groups, group), np.concatenate([state.values.x, np.zeros(len(group.names))]))
    return state._replace(values=values)


LEAST_ERROR = 0.03
"""Median error of a fit, in lengths of the robot, from which on mistakes are looked for."""

EXPLAINED = 0.5
"""Share of that error that the drawn robot has at most without the mistake, where it is told."""

MOST_ROWS, MOST_LOADED_ROWS = 120, 20
"""Rows with which mistakes are tried; of a robot under load, each of which is an equilibrium."""

MOST_DELAY = 3
"""Most rows that a stream of measurements may be late or early."""


def find_mistake(drawn: Robot, rows: Measurements, levelled: bool, left: float) -> str | None:
    """Say which mistake explains most of the median error that a fit has left, if one does."""
    if left <= LEAST_ERROR * drawn.mean_length:
        return None
    most = MOST_LOADED_ROWS if drawn.has_external_load else MOST_ROWS
    chosen = np.zeros(len(rows.actuators), np.bool_)
    chosen[:: max(1, len(chosen) // most)] = True

    def error_of(actuators: Floats) -> float:
        part = rows._replace(actuators=actuators).part(chosen)
        try:
            residuals = predict(drawn, begun(drawn, part, levelled), part) - part.points
        except (InputError, np.linalg.LinAlgError, OverflowError):
            return np.inf
        return float(np.median(errors(np.where(np.isfinite(residuals), residuals, 0.0))))

    after, said = min((error_of(actuators), text) for text, actuators in _candidates(drawn, rows))
    if after > EXPLAINED * left:
        return None
    return f"{said} would explain these rows: the median error is {after:.3g} then, and {left:.3g} as it is fitted"


def _candidates(drawn: Robot, rows: Measurements) -> Iterator[tuple[str, Floats]]:
    """Yield what may be wrong, and the actuator values (N, m) if it is."""
    own, names = rows.actuators, [actuator.name for actuator in drawn.actuators]
    for i, j in combinations(range(len(names)), 2):
        order = list(range(len(names)))
        order[i], order[j] = j, i
        yield f"exchanging the columns {names[i]} and {names[j]}", own[:, order]
    for i, name in enumerate(names):
        turned = own.copy()
        turned[:, i] *= -1.0
        yield f"turning the sign of {name}", turned
    yield "turning the signs of all actuators", -own
    for factor in UNIT_FACTORS:
        yield f"actuator values times {factor:g}", own * factor
    for rows_late in (*range(1, MOST_DELAY + 1), *range(-MOST_DELAY, 0)):
        word = "late" if rows_late > 0 else "early"
        yield f"measurements that come {counted(abs(rows_late), 'row')} {word}", np.roll(own, rows_late, axis=0)


TRIED = 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08
"""Plays that are tried first: of the largest range of a tendon."""

REFINED = 2.0**-0.5, 2.0**0.5
"""And of the best of these, afterwards."""

RISEN = 1.2
"""Times the least error from which on larger plays are not tried."""

FEWEST_ROWS = 20
"""Rows from which on play is looked for."""

TRIAL_STEPS = 3
"""Most steps of a fit that tries one."""


def after_play(motors: Motors, lines: Floats, actuators: Floats, play: float) -> Floats:
    """Values (N, m) that motors without play would have, of rows in the order of time; `lines` (m,) is 1 for what has.

    `play` is that of displacements, in the length unit.
    """
    half = 0.5 * play * lines
    displaced = motors.displacements(actuators)
    result = np.empty_like(displaced)
    now = displaced[0]
    for i, there in enumerate(displaced):
        now = result[i] = np.clip(now, there - half, there + half)
    return motors.values(result)


def rows_after_play(drawn: Robot, rows: Measurements, play: float) -> Measurements:
    """The same rows with the values that motors without play would have."""
    if play == 0.0:
        return rows
    return rows._replace(actuators=after_play(drawn.drive.motors, lines_with_play(drawn), rows.actuators, play))


def lines_with_play(robot: Robot) -> Floats:
    """Which actuators (m,) have play: tendons and chambers."""
    lines = np.zeros(len(robot.drive))
    lines[lines_of(robot)[0]] = 1.0
    return lines


def find_play(drawn: Robot, state: FitState, rows: Measurements, chosen: slice) -> tuple[float, float, float]:
    """The play with which held-back rows are off by the least, their mean error without it, and with it."""
    places = lines_of(drawn)[0]
    if not len(places) or len(rows.labels) < FEWEST_ROWS:
        return 0.0, 0.0, 0.0
    largest = float(np.ptp(drawn.drive.motors.displacements(rows.actuators)[:, places], axis=0).max())

    def error_of(play: float) -> float:
        part = rows_after_play(drawn, rows, play).part(chosen)
        return float(errors(left_out(fitted(drawn, state, part, TRIAL_STEPS), part, drawn)).mean())

    before, best, least = error_of(0.0), 0.0, np.inf
    for play in (largest * each for each in TRIED):
        after = error_of(play)
        best, least = (play, after) if after < least else (best, least)
        if after > RISEN * min(least, before):
            break
    for play in (best * each for each in REFINED):
        after = error_of(play)
        best, least = (play, after) if after < least else (best, least)
    return best, before, least
