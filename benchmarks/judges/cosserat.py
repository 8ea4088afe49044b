"""A Cosserat rod under load by shooting, with SciPy: shares nothing with the kernels. Bending, torsion and stretch."""

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from sinuous.base.checks import Floats


def shoot(
    lengths: Floats,
    stiffness: Floats,
    rests: Floats,
    weights: Floats,
    loads: Floats,
    base: Floats,
    guess: Floats | None = None,
) -> list[Floats]:
    """Poses (n, 4, 4) of the ends of n rods that follow each other.

    `lengths` (n,); `stiffness` (n, 3): EI, GJ, EA; `rests` (n, 3) curvatures without load in the frame of the rod;
    `weights` (n, 3) per length; `loads` (n, 6) force and moment in the world at the end of each; `base` (4, 4).
    """

    def rates(_: float, y: Floats, k: int) -> Floats:
        R, n, m = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        bend, twist, stretch = stiffness[k]
        u = R.T @ m / [bend, bend, twist] + rests[k]
        tangent = R[:, 2] * (1.0 + R[:, 2] @ n / stretch)
        W = np.array([[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]])
        return np.concatenate([tangent, (R @ W).ravel(), -weights[k], -np.cross(tangent, n)])

    def run(wrench: Floats) -> tuple[Floats, list[Floats]]:
        y, ends = np.concatenate([base[:3, 3], base[:3, :3].ravel(), wrench]), []
        for k, length in enumerate(lengths):
            y = solve_ivp(rates, (0.0, length), y, args=(k,), rtol=1e-8, atol=1e-10, method="DOP853").y[:, -1].copy()
            pose = np.eye(4)
            pose[:3, 3], pose[:3, :3] = y[:3], y[3:12].reshape(3, 3)
            ends.append(pose)
            y[12:18] -= loads[k]
        return y[12:18], ends

    force = loads[:, :3].sum(axis=0) + (weights * np.asarray(lengths)[:, None]).sum(axis=0)
    start = np.concatenate([force, np.zeros(3)]) if guess is None else guess
    scale = max(1e-9, float(np.abs(start).max()))
    own: Any = lambda x: run(x * scale)[0] / scale  # noqa: E731
    found = root(own, start / scale, tol=1e-9)
    assert np.abs(found.fun).max() < 1e-6, "the shooting did not end"
    return run(found.x * scale)[1]
