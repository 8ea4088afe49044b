"""FABRIK with obstacle avoidance as a method."""

import numpy as np

import sinuous as sn
from sinuous.base.arguments import MethodName
from tests.methods import laws

ARM = sn.Robot.uniform(5, (45, 70), 2.0, radius=4, mount=10)


def test_without_obstacles_it_is_fabrikc() -> None:
    one, other = (sn.Solver(laws.ARM, method=method) for method in ("fabrik_avoid", "fabrikc"))
    for target in [*laws.PAPER, *laws.tip_targets(laws.ARM, 20)]:
        np.testing.assert_allclose(one.solve(target).q, other.solve(target).q, rtol=1e-12, atol=1e-12)


def scenes() -> list[sn.Scene]:
    """Ten spheres on the way of the straight robot and around it."""
    out = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        centers = rng.uniform((-120, -120, 70), (120, 120, 260), (20, 3))
        out.append(sn.Scene([sn.Sphere(center, 18) for center in centers]))
    return out


def test_it_steps_aside_where_fabrikc_runs_into_obstacles() -> None:
    solved: dict[MethodName, int] = {"fabrik_avoid": 0, "fabrikc": 0}
    for scene in scenes()[:2]:
        free = [
            ARM.tip(q)
            for q in laws.shapes(ARM, 36, 1.5, 3)
            if scene.distance(ARM.backbone(q)[4:]).min() > ARM.radii[0] + 1.0
        ]
        targets = [sn.Target(pose[:3, 3], direction=pose[:3, 2]) for pose in free]
        assert len(targets) > 5
        for method in solved:
            solver = sn.Solver(ARM, scene, method=method, max_starts=1)
            solved[method] += laws.solved_and_verified(solver, targets)
    assert solved["fabrik_avoid"] > solved["fabrikc"] + 5
