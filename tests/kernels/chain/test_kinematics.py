"""The chain of segments: products of exponentials, and their derivatives by the complex step."""

import numpy as np
import pytest

from sinuous.kernels.chain import arc
from sinuous.kernels.chain import kinematics as chain
from tests.helpers import (
    Floats,
    as_matrix,
    columns_of,
    complex_columns,
    configurations,
    expm_chain,
    frames_of,
    random_pose,
    twist_of,
    vec,
)

SAMPLES = [q for n in (1, 2, 5, 12) for q in configurations(n, n, 12)]


def reach(q: Floats) -> float:
    return float(1.0 + q[:, 2].sum())


@pytest.mark.parametrize("s", [0.0, 1e-9, 0.25, 0.7, 1.0])
def test_the_body_between_the_ends(s: float) -> None:
    rng = np.random.default_rng(2)
    for q in SAMPLES:
        base = random_pose(rng)
        frames = frames_of(q, base)
        for k in range(len(q)):
            part = q[: k + 1].copy()
            part[k] *= s
            expected = expm_chain(part, base)[-1]
            got = as_matrix(*chain.compose(*chain.frame(frames, k), *arc.pose(*(s * q[k]))))
            np.testing.assert_allclose(got, expected, atol=3e-14 * reach(q))
            np.testing.assert_allclose(chain.body_point(q, frames, k, s), got[:3, 3], atol=1e-14 * reach(q))


@pytest.mark.parametrize("s", [0.0, 1e-6, 0.4, 1.0])
def test_columns_are_the_derivatives_of_body_poses(s: float) -> None:
    rng = np.random.default_rng(3)
    for q in SAMPLES:
        base = random_pose(rng)
        origin = base[:3, 3]
        seen = as_matrix(np.eye(3), -origin)  # twists are about the base
        k = len(q) - 1
        frames, columns = frames_of(q, base), columns_of(q, base)

        def place(x: Floats, seen: Floats = seen, base: Floats = base, s: float = s) -> Floats:
            part = x.copy()
            part[-1] = s * part[-1]
            return np.asarray(seen @ expm_chain(part, base)[-1])

        rates = complex_columns(place, q)
        x, y, stretch = chain.body_columns(q, frames, vec(origin), k, s)
        # The body at a fraction moves with the ends of all segments before its own, and by `s` of its own columns.
        columns[k] = s * np.array([*x[0], *x[1], *y[0], *y[1], *stretch[0], *stretch[1]])
        pose = place(q)
        for i in range(q.size):
            got = columns[i // 3, 6 * (i % 3) : 6 * (i % 3) + 6]
            np.testing.assert_allclose(got, twist_of(rates[..., i], pose), atol=1e-12 * reach(q))
