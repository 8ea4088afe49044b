"""Chains laid along a curve, at many depths at once: nonlinear least squares (Levenberg and Marquardt) in NumPy.

Depth is the length of the curve up to the tip. A chain at depth d lies along the first d of the curve, from the base
on. What is minimised is how far places of the body are off the curve, across it, and, much heavier, how far the tip is
off.
"""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.motion.configurations import movable, within_limits
from sinuous.problem.curve import Curve
from sinuous.robot.robot import Robot

PLACES = 8
"""Places of every segment that are drawn to the curve."""

ROUNDS = 12
"""Most steps."""

TIP = 30.0
"""How much heavier the tip counts than another place."""

DAMPING, EASE, HARDEN = 1e-4, 0.2, 10.0
"""Damping of the first step, and its factors after a step that was better, and after one that was not."""

NUDGE = 1e-7
"""Step of finite differences: rad, and lengths relative to that of the robot."""

ENOUGH = 1e-3
"""A round that brings none of the chains more than so great a share is the last."""


def depths_of(robot: Robot) -> tuple[float, float]:
    """Least and greatest length of the whole chain."""
    low, high = np.array([segment.length for segment in robot.segments]).sum(axis=0).tolist()
    return low, high


def lay(robot: Robot, curve: Curve, depths: Floats, near: Floats | None = None) -> Floats:
    """Configurations (T, n, 3) within the limits of segments, along the curve, with the tip at `depths` (T,).

    From configurations `near` them every step is taken, so that they depend smoothly on all that is given; otherwise
    those alone that bring places nearer.
    """
    q = _first(robot, curve, depths) if near is None else within_limits(robot, near)
    free = np.flatnonzero(movable(robot.segments))
    if len(free) == 0:
        return q
    nudges = np.where(free % 3 == 2, NUDGE * robot.mean_length, NUDGE)
    mu = np.full(len(depths), DAMPING)
    residual, tangents = _residual(robot, curve, depths, q)
    for _ in range(ROUNDS):
        jacobian = _jacobian(robot, q, tangents, free, nudges)
        transposed = jacobian.swapaxes(1, 2)
        normal, pull = transposed @ jacobian, transposed @ residual[..., None]
        scale = np.einsum("tii->ti", normal) + 1e-12 * np.einsum("tii->t", normal)[:, None]
        np.einsum("tii->ti", normal)[:] += mu[:, None] * scale
        tried = q.reshape(len(q), -1).copy()
        tried[:, free] -= np.linalg.solve(normal, pull)[..., 0]
        tried = within_limits(robot, tried.reshape(q.shape))
        new, new_tangents = _residual(robot, curve, depths, tried)
        before, after = (residual**2).sum(axis=1), (new**2).sum(axis=1)
        better = after < before if near is None else np.full(len(q), True)
        mu = np.where(better, EASE * mu, HARDEN * mu)
        q[better], residual[better], tangents[better] = tried[better], new[better], new_tangents[better]
        if near is None and (np.where(better, before - after, 0.0) <= ENOUGH * before).all():
            break
    return q


def _first(robot: Robot, curve: Curve, depths: Floats) -> Floats:
    """Chains whose ends of segments have the tangents of the curve beside them; all stretch by the same share."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    low, high = np.array([segment.length for segment in robot.segments]).T
    spread = max(float((high - low).sum()), 1e-300)
    share = np.clip((depths - low.sum()) / spread, 0.0, 1.0)[:, None]
    q = np.zeros((len(depths), len(robot), 3))
    q[..., 2] = low + share * (high - low)
    ends = np.cumsum(q[..., 2], axis=1)
    frames = Rotation.from_matrix(np.broadcast_to(robot.base[:3, :3], (len(depths), 3, 3)))
    for k in range(len(robot)):
        x, y, z = frames.inv().apply(curve.tangent(ends[:, k])).T
        aside = np.hypot(x, y)
        turn = np.arctan2(aside, z) / np.where(aside > 0.0, aside, 1.0)
        q[:, k, 0], q[:, k, 1] = turn * x, turn * y
        q[:, k] = within_limits(robot, q)[:, k]
        frames = frames * Rotation.from_rotvec(np.stack([-q[:, k, 1], q[:, k, 0], np.zeros(len(q))], axis=1))
    return q


def _places(robot: Robot, q: Floats) -> Floats:
    """Places (..., n * PLACES, 3) of the body that are drawn to the curve; the last is the tip."""
    return robot.backbone(q, PLACES)[..., 1:, :]


def _residual(robot: Robot, curve: Curve, depths: Floats, q: Floats) -> tuple[Floats, Floats]:
    """How far places are off the curve, across it (T, r), and tangents (T, places, 3) beside them, the tip's zero."""
    lengths = q[..., 2]
    shares = np.arange(1, PLACES + 1) / PLACES
    along = (np.cumsum(lengths, axis=1) - lengths)[..., None] + lengths[..., None] * shares
    along = along.reshape(len(q), -1)
    length = along[:, -1]
    along *= np.divide(depths, length, out=np.ones_like(depths), where=length > 0.0)[:, None]
    tangents = curve.tangent(along)
    tangents[:, -1] = 0.0
    return _across(_places(robot, q) - curve.at(along), tangents), tangents


def _across(off: Floats, tangents: Floats) -> Floats:
    """Part of vectors (..., places, 3) across the tangents, flat (..., 3 places); the tip's weighs more."""
    rest = off - (off * tangents).sum(axis=-1, keepdims=True) * tangents
    rest[..., -1, :] *= TIP
    return rest.reshape(*rest.shape[:-2], -1)


def _jacobian(robot: Robot, q: Floats, tangents: Floats, free: NDArray[np.intp], nudges: Floats) -> Floats:
    """Derivative (T, r, c) of what is minimised by the coordinates `free` (c,), by central differences."""
    moved = np.repeat(q.reshape(1, len(q), -1), 2 * len(free), axis=0)
    for i, (column, nudge) in enumerate(zip(free, nudges, strict=True)):
        moved[2 * i, :, column] += nudge
        moved[2 * i + 1, :, column] -= nudge
    places = _places(robot, moved.reshape(-1, *q.shape))
    slopes = (places[0::2] - places[1::2]) / (2.0 * nudges[:, None, None, None])
    return np.moveaxis(_across(slopes, tangents), 0, -1)
