"""The parameters that measurements say: damped Gauss-Newton with a soft loss (Nocedal & Wright, section 10.3).

The loss of a row whose points are off by `r` altogether is `2 s^2 (sqrt(1 + r^2 / s^2) - 1)`: squares of what is usual,
no more than linear in outliers. Drawings count as measurements that are off by `parameters.WIDTHS`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.poses import rotation_of
from sinuous.model.robot import Robot
from sinuous.studies.calibration.measurements import Measurements
from sinuous.studies.calibration.model import RobotModel, derivatives, model, predicted
from sinuous.studies.calibration.parameters import ParameterGroup, Values

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
