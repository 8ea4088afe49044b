"""How obstacles move in a step, as kernels read it, against poses that SciPy interpolates."""

import numpy as np
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.certificate.drift import BEGIN, TURN, TURNED, VELOCITY
from sinuous.solver.certificates.steps import Drifts

BALL = sn.Sphere((0, 0, 0), 0.1)


def test_drifts_lead_from_pose_to_pose() -> None:
    rng = np.random.default_rng(1)
    moving = []
    for count in (1, 2, 3, 7):
        times = np.sort(rng.uniform(0.0, 5.0, count))
        moving.append(sn.Moving(BALL, times, rng.normal(size=(count, 3)), rng.normal(size=(count, 4))))
        moving.append(sn.Moving(BALL, times, rng.normal(size=(count, 3))))
    drifts = Drifts(sn.Scene(moving).snapshot())
    times = drifts.divided(np.sort(np.concatenate([rng.uniform(-1.0, 6.0, 50), [2.0, 2.0]])))
    rows = drifts.rows(times)
    for e, own in enumerate(moving):
        poses = own.pose(times)
        here, way = rows[:, e, BEGIN : BEGIN + 3], rows[:, e, VELOCITY : VELOCITY + 3]
        turned, turn = rows[:, e, TURNED : TURNED + 9].reshape(-1, 3, 3), rows[:, e, TURN : TURN + 3]
        np.testing.assert_allclose(here, poses[:-1, :3, 3], atol=1e-12)
        np.testing.assert_allclose(here + way, poses[1:, :3, 3], atol=1e-12)
        np.testing.assert_allclose(turned, poses[:-1, :3, :3], atol=1e-12)
        after = turned @ Rotation.from_rotvec(turn).as_matrix()
        np.testing.assert_allclose(after, poses[1:, :3, :3], atol=1e-12)
        still = (times[1:] <= own.times[0]) | (times[:-1] >= own.times[-1]) | (times[1:] == times[:-1])
        assert not way[still].any()
        assert not turn[still].any()
        assert len(own.times) == 1 or (np.linalg.norm(way[~still], axis=1) > 0.0).all()
