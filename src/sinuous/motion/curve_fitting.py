"""Chains fitted to a curve, at many depths at once: nonlinear least squares (Levenberg and Marquardt) in NumPy.

Depth is the length of the curve up to the tip. A chain at depth d lies along the first d of the curve, from the base
on; where joints move its base, along the last part of that which is as long as the chain. What is minimised is how far
places of the body are off the curve, across it, and, much heavier, how far the tip is off. Under load these are places
of the loaded body, and what is found is the drive.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import random_configuration, within_limits
from sinuous.problem.path import Curve
from sinuous.problem.target import Target
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, kept_rests

PLACES = 8
"""Places of every segment that are drawn to the curve; under load they are shared among its arcs."""

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

FINEST = 3e-4
"""The same where joints carry the chain, in lengths of the robot that places come nearer to the curve."""

MOST_BRANCHES, BRANCH_STARTS = 30, 40
"""Branches of the inverse kinematics of joints that are tried, until one carries the chain all the way; and most starts
from which one is sought."""


def depths_of(robot: Robot) -> tuple[float, float]:
    """Least and greatest length of the segments."""
    low, high = np.array([segment.length for segment in robot.segments]).sum(axis=0).tolist()
    return low, high


def fit_chains_along(
    robot: Robot, curve: Curve, depths: Floats, near: Floats | None = None, scene: Scene | None = None
) -> Floats:
    """Configurations (T, n, 3) within the limits of segments, along the curve, with the tip at `depths` (T,).

    From configurations `near` them every step is taken, so that they depend smoothly on all that is given; otherwise
    those alone that bring places nearer, and joints carry the chain along, clear of a `scene`. Where no body is at rest
    under its load, the configuration is fitted as if it had none.
    """
    q = _first(robot, curve, depths, scene) if near is None else within_limits(robot, near)
    if robot.has_external_load:
        if near is None:
            q = fit_chains_along(robot.changed(gravity=None, payload=None), curve, depths, None, scene)
        rests = np.array([Rest(robot, each).states is not None for each in q], bool)
        q[rests] = _laid(_LoadedChains(robot), curve, depths[rests], q[rests], near is not None)
        return q
    return _laid(_Chains(robot), curve, depths, q, near is not None)


def _laid(chains: "_Chains", curve: Curve, depths: Floats, q: Floats, always: bool) -> Floats:
    """Lead configurations (T, n, 3) to the curve; `always`: take every step."""
    robot = chains.robot
    coordinates = robot.drive.coordinates
    free = np.flatnonzero(coordinates.unlocked)
    basis = coordinates.basis[free]
    if len(free) == 0 or len(q) == 0:
        return q
    nudges = np.where(free % 3 == 2, NUDGE * robot.mean_length, NUDGE)
    mu, finest = np.full(len(depths), DAMPING), 0.0
    if robot.joints:  # which are more than the curve says, so that rounds go on for long that hardly bring anything
        finest = (FINEST * robot.mean_length) ** 2 * PLACES * len(robot.segments)
    residual, tangents = chains.residual(curve, depths, q)
    for _ in range(ROUNDS):
        jacobian = chains.jacobian(q, tangents, free, nudges) @ basis
        transposed = jacobian.swapaxes(1, 2)
        normal, pull = transposed @ jacobian, transposed @ residual[..., None]
        scale = np.einsum("tii->ti", normal) + 1e-12 * np.einsum("tii->t", normal)[:, None]
        np.einsum("tii->ti", normal)[:] += mu[:, None] * scale
        tried = q.reshape(len(q), -1).copy()
        tried[:, free] -= np.linalg.solve(normal, pull)[..., 0] @ basis.T
        tried = within_limits(robot, tried.reshape(q.shape))
        new, new_tangents = chains.residual(curve, depths, tried)
        before, after = (residual**2).sum(axis=1), (new**2).sum(axis=1)
        better = np.isfinite(after) if always else after < before
        mu = np.where(better, EASE * mu, HARDEN * mu)
        q[better], residual[better], tangents[better] = tried[better], new[better], new_tangents[better]
        if not always and (np.where(better, before - after, 0.0) <= ENOUGH * before + finest).all():
            break
    return q


def _first(robot: Robot, curve: Curve, depths: Floats, scene: Scene | None) -> Floats:
    """Chains whose ends of segments have the tangents of the curve beside them; all stretch by the same share."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    low, high = np.array([segment.length for segment in robot.segments]).T
    spread, before = max(float((high - low).sum()), 1e-300), robot.drive.before
    share = np.clip((depths - low.sum()) / spread, 0.0, 1.0)[:, None] if not robot.joints else 0.5
    q = np.zeros((len(depths), len(robot), 3))
    q[:, before:, 2] = low + share * (high - low)
    ends = np.cumsum(q[:, :, 2], axis=1)
    begins = np.broadcast_to(robot.base, (len(depths), 4, 4))
    if robot.joints:
        length = float(ends[0, -1])
        q[:, :before], begins = _carried(robot, curve, depths - length, scene)
        ends += (depths - length)[:, None]
    frames = Rotation.from_matrix(begins[:, :3, :3])
    for k in range(before, len(robot)):
        x, y, z = frames.inv().apply(curve.tangent(ends[:, k])).T
        aside = np.hypot(x, y)
        turn = np.arctan2(aside, z) / np.where(aside > 0.0, aside, 1.0)
        q[:, k, 0], q[:, k, 1] = turn * x, turn * y
        q[:, k] = within_limits(robot, q)[:, k]
        frames = frames * Rotation.from_rotvec(np.stack([-q[:, k, 1], q[:, k, 0], np.zeros(len(q))], axis=1))
    return q


def _carried(robot: Robot, curve: Curve, along: Floats, scene: Scene | None) -> tuple[Floats, Floats]:
    """Rows (T, r, 3) of joints that carry the first segment along the curve, and where it begins (T, 4, 4).

    From the deepest place back, each from the one before, in a branch of their inverse kinematics in which they come
    as far as they can.
    """
    alone: dict[str, Any] = dict.fromkeys(("tool", "actuators", "gravity", "payload", "uncertainty"))
    alone |= zip(("clearance", "self_clearance"), robot._least_clearances, strict=True)
    arm = robot.changed(segments=(), mount=0.0, **alone)
    targets = [Target(place, direction=way) for place, way in zip(curve.at(along), curve.tangent(along), strict=True)]
    best, most = np.zeros((len(along), len(arm), 3)), -1
    solver = Solver(arm, scene, max_starts=1, routes=False)
    rng, far = np.random.default_rng(0), Solver(arm, scene, max_starts=BRANCH_STARTS, routes=False)
    for branch in range(MOST_BRANCHES):
        found = far.solve(targets[-1], random_configuration(arm, rng) if branch else None)
        rows = [found]
        for target in targets[-2::-1]:
            rows.append(solver.solve(target, rows[-1]))
        solved = sum(each.solved for each in rows)
        if solved > most:
            best, most = np.array([each.configuration for each in reversed(rows)]), solved
        if most == len(along):
            break
    return best, arm.forward(best)[:, -1]


class _Chains:
    """Chains of one robot, and how far they are off a curve.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._body = longest_body(robot) if robot.has_external_load else robot
        self._places = math.ceil(PLACES * len(robot) / len(self._body))  # of every arc

    def residual(self, curve: Curve, depths: Floats, q: Floats) -> tuple[Floats, Floats]:
        """How far places are off the curve, across it (T, r), and tangents (T, places, 3) there, the tip's zero."""
        arcs = self._arcs(q)
        lengths = arcs[:, self.robot.drive.before :, 2]
        shares = np.arange(1, self._places + 1) / self._places
        along = (np.cumsum(lengths, axis=1) - lengths)[..., None] + lengths[..., None] * shares
        along = along.reshape(len(q), -1)
        length = along[:, -1]
        if self.robot.joints:
            along += (depths - length)[:, None]
        else:
            along *= np.divide(depths, length, out=np.ones_like(depths), where=length > 0.0)[:, None]
        tangents = curve.tangent(along)
        tangents[:, -1] = 0.0
        return _across(self._at(arcs) - curve.at(along), tangents), tangents

    def jacobian(self, q: Floats, tangents: Floats, free: NDArray[np.intp], nudges: Floats) -> Floats:
        """Derivative (T, r, c) of what is minimised by the coordinates `free` (c,), by central differences."""
        ahead, behind = self._beside(q, free, nudges), self._beside(q, free, -nudges)
        slopes = (self._at(ahead) - self._at(behind)) / (2.0 * nudges[:, None, None, None])
        return np.moveaxis(_across(slopes, tangents), 0, -1)

    def _at(self, arcs: Floats) -> Floats:
        """Places (..., N * places, 3) of bodies (..., N, 3) that are drawn to the curve; the last is the tip."""
        return self._body.backbone(arcs, self._places)[..., 1 + self.robot.drive.before * self._places :, :]

    def _arcs(self, q: Floats) -> Floats:
        """Bodies (T, N, 3) in configurations (T, n, 3)."""
        return q

    def _beside(self, q: Floats, free: NDArray[np.intp], nudges: Floats) -> Floats:
        """Bodies (c, T, N, 3) where each of the coordinates `free` (c,) is moved by a nudge."""
        moved = np.repeat(q.reshape(1, len(q), -1), len(free), axis=0)
        moved[np.arange(len(free)), :, free] += nudges[:, None]
        return moved.reshape(-1, *q.shape)


class _LoadedChains(_Chains):
    """The same under load: a configuration is a drive, its body one of arcs at rest."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot)
        self._rest = kept_rests(robot)

    def residual(self, curve: Curve, depths: Floats, q: Floats) -> tuple[Floats, Floats]:
        """As without load; infinite where no body is at rest."""
        residual, tangents = super().residual(curve, depths, q)
        residual[[self._rest(each).states is None for each in q]] = np.inf
        return residual, tangents

    def _arcs(self, q: Floats) -> Floats:
        return np.array([self._rest(each).shown for each in q])

    def _beside(self, q: Floats, free: NDArray[np.intp], nudges: Floats) -> Floats:
        return np.stack([self._rest(each).beside(free, nudges) for each in q], axis=1)


def _across(off: Floats, tangents: Floats) -> Floats:
    """Part of vectors (..., places, 3) across the tangents, flat (..., 3 places); the tip's weighs more."""
    rest = off - (off * tangents).sum(axis=-1, keepdims=True) * tangents
    rest[..., -1, :] *= TIP
    return rest.reshape(*rest.shape[:-2], -1)
