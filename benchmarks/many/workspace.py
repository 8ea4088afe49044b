"""A map of the README's robot among spheres: how long it takes, and whether its proofs are true."""

from collections.abc import Iterator

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.many.questions import ROBOT, spheres
from benchmarks.problems import free_configurations
from sinuous.answer.status import Status
from sinuous.base.checks import Floats
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver
from sinuous.studies.workspace.find import reach
from sinuous.studies.workspace.reach import Reach, Verdict

SECTION = "map of the workspace, 5 segments among 40 spheres, 26 directions a voxel, 2 threads"
PROOFS = {Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED}
NONE = Goal(0.0, correctness=True)


def measure(plan: Plan) -> Iterator[Line]:
    """Time, volumes, and claims that random shapes refute."""
    spacing = plan.count(10, 100)
    scene = spheres(plan)
    found = reach(ROBOT, scene, float(spacing), workers=2)
    volume = found.volume()
    yield Line(SECTION, f"a map at {spacing} mm", found.seconds, "s", Goal(120.0))
    yield Line(SECTION, "reachable volume", volume.found / 1e9, "m^3", note=f"grid within {volume.error / 1e9:.3g}")
    rng = plan.rng(36)
    shapes = free_configurations(ROBOT, scene, plan.count(1_000, 20), rng)
    tips = np.asarray(ROBOT.tip(shapes))
    count = plan.count(1_000, 20)
    wrong = f"of {count:,} voxels and directions that are proved unreachable, refuted by {len(tips):,} clear shapes"
    yield Line(SECTION, wrong, float(_refuted(found, tips, count, rng)), "", NONE)
    yield Line(SECTION, "tips of these shapes that are called unreachable", float(_denied(scene, tips)), "", NONE)


def _refuted(found: Reach, tips: Floats, count: int, rng: np.random.Generator) -> int:
    """How many claims some shape refutes: its tip is there, and points there, within the tolerance."""
    claims = np.argwhere((found.verdicts > Verdict.SOLVED) & (found.verdicts <= Verdict.BASE_BLOCKED))
    some = claims[rng.choice(len(claims), min(count, len(claims)), replace=False)]
    places, axes = found.voxels.middles[tuple(some[:, :3].T)], found.directions[some[:, 3]]
    far = np.linalg.norm(places[:, None] - tips[:, :3, 3], axis=-1)
    turned = np.arccos(np.clip(axes @ tips[:, :3, 2].T, -1.0, 1.0))
    return int(((far <= 1e-4 * ROBOT.mean_length) & (turned <= 1e-3)).any(axis=1).sum())


def _denied(scene: Scene, tips: Floats) -> int:
    """How many tips of clear shapes the calls that a map is made of prove to be impossible."""
    solver = Solver(ROBOT, scene, max_starts=1, routes=False)
    denied = 0
    for directions in (tips[:, :3, 2], None):
        many = solver.solve_many(positions=tips[:, :3, 3], directions=directions)
        denied += sum(status in PROOFS for status in many.status.tolist())
    return denied
