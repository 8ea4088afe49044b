"""Solving among meshes, clouds and grids, and while the cloud changes: what is called solved is free, by other code."""

import math
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.step.newton import SAMPLED_PROOF_SLACK
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle
from tests.helpers import Floats, present
from tests.scene import shapes

ROBOT = sn.Robot.uniform(4, (0.2, 0.35), 2.4, radius=0.03)


def ring(p: Floats) -> Floats:
    """A torus about the way ahead."""
    return np.asarray(np.hypot(np.hypot(p[:, 0], p[:, 1]) - 0.3, p[:, 2] - 0.5) - 0.15)


def sampled_ring() -> sn.Grid:
    shape, low = (75, 75, 80), np.array([-0.9, -0.9, -0.4])
    return sn.Grid(ring(low + 0.025 * np.argwhere(np.ones(shape))).reshape(shape), low, 0.025)


def blobs(size: float) -> shapes.Triangles:
    """Balls around the way, clear of the base."""
    vertices, faces = shapes.ball(3)
    places = [(0.35, 0.1, 0.5), (-0.3, 0.25, 0.6), (0.0, -0.4, 0.45), (0.05, 0.1, 0.95)]
    return shapes.together(*((size * vertices + np.array(place), faces) for place in places))


def scan() -> Floats:
    return blobs(0.16)[0][::2]


MADE: dict[str, Callable[[], Obstacle]] = {
    "mesh": lambda: sn.Mesh(*blobs(0.17)),
    "shell": lambda: sn.Mesh(blobs(0.17)[0], blobs(0.17)[1][::2], thickness=0.01),
    "thin shell": lambda: sn.Mesh(blobs(0.17)[0], blobs(0.17)[1][::2]),
    "hollow": lambda: sn.Mesh(*shapes.together(blobs(0.17), shapes.inverted(blobs(0.1)))),
    "room": lambda: sn.Mesh(0.9 * shapes.ball(3)[0], shapes.ball(3)[1], inside=True),
    "cloud": lambda: sn.PointCloud(scan(), 0.015),
    "cloud of all sizes": lambda: sn.PointCloud(scan(), np.linspace(0.0, 0.03, len(scan()))),
    "cubes": lambda: sn.Grid(np.random.default_rng(5).random((6, 6, 6)) < 0.15, (-0.5, -0.5, 0.2), 0.2),
    "samples": sampled_ring,
    "function": lambda: sn.Field(ring, (-0.9, -0.9, -0.4), (0.9, 0.9, 1.5), 0.03),
}


def targets(scene: sn.Scene, seed: int, count: int) -> list[sn.Target]:
    """Where the tip of some configurations is that are free at a glance."""
    rng = np.random.default_rng(seed)
    found: list[sn.Target] = []
    for _ in range(1000):
        angle, bend = rng.uniform(-math.pi, math.pi, 4), 1.2 * np.sqrt(rng.random(4))
        q = np.stack([bend * np.cos(angle), bend * np.sin(angle), rng.uniform(0.2, 0.35, 4)], axis=-1)
        backbone = ROBOT.backbone(q, 10)
        if scene.distance(backbone).min() > 0.04:
            found.append(sn.Target(backbone[-1]))
        if len(found) == count:
            return found
    raise AssertionError("too few are free")


@pytest.mark.parametrize("kind", MADE)
def test_solved_is_free_and_most_are_solved(kind: str) -> None:
    obstacle = MADE[kind]()
    scene = sn.Scene([obstacle, sn.Sphere((0.9, 0.0, 0.5), 0.1)])
    solver = sn.Solver(ROBOT, scene)
    asked = targets(scene, 1, 20)
    solutions = [solver.solve(target) for target in asked]
    solved = [s for s in solutions if s.solved]
    touched = 0
    for solution in solved:
        backbone = ROBOT.backbone(solution.q, 200)
        true = min(float(measure(o, backbone).min()) for o in scene.obstacles) - 0.03
        check = solution.verify()
        assert check.ok
        assert solution.clearance is not None
        assert 0.0 < solution.clearance <= min(true, check.clearance) + 1e-9
        touched += true < 0.05
        if kind not in ("samples", "function"):
            # The truth between two points of the backbone is at most half of their distance less.
            assert solution.clearance >= (1.0 - SAMPLED_PROOF_SLACK) * (true - 0.5 * 0.35 / 200) - 1e-6
    assert len(solved) >= 19
    assert touched >= 3, "nothing was in the way"


def test_all_kinds_in_one_scene() -> None:
    scene = sn.Scene([MADE["cubes"](), sn.PointCloud(scan() + np.array([0.0, 0.0, 0.6]), 0.01), MADE["room"]()])
    solver = sn.Solver(ROBOT, scene)
    solutions = [solver.solve(target) for target in targets(scene, 2, 10)]
    assert sum(s.solved for s in solutions) >= 9
    assert all(s.verify().ok for s in solutions if s.solved)


def test_solving_while_the_cloud_changes() -> None:
    """The cloud is where the robot has to pass, so that a solve with points of two moments would be seen."""
    rng = np.random.default_rng(6)

    def seen(i: int) -> Floats:
        side = 0.25 if i % 2 else -0.25
        return rng.normal((side, 0.1, 0.5), 0.04, size=(10 + 50 * (i % 7), 3))

    scene = sn.Scene([sn.PointCloud(seen(0), 0.01)])
    solver = sn.Solver(ROBOT, scene)
    asked = targets(scene, 3, 5)
    stop = threading.Event()
    found: list[sn.Solution] = []

    def work() -> None:
        while not stop.is_set():
            found.extend(solver.solve(target) for target in asked)

    worker = threading.Thread(target=work)
    worker.start()
    for i in range(60):
        scene.update(seen(i))
        before = len(found)  # after the update, which takes longer than some solves
        while worker.is_alive() and len(found) < before + len(asked):
            time.sleep(1e-4)
    stop.set()
    worker.join()
    solved = [solution for solution in found if solution.solved]
    assert len(solved) > 0.8 * len(found)
    scenes = {id(solution.problem.scene): solution.problem.scene for solution in found}
    assert len(scenes) >= 60
    stands = []
    # Drawn, not every so many: the same targets come again and again.
    for solution in (solved[i] for i in rng.permutation(len(solved))[:300]):
        own = solution.problem.scene.distance(ROBOT.backbone(solution.q, 50)).min() - 0.03
        assert 0.0 < present(solution.clearance) <= own + 1e-9
        now = scene.distance(ROBOT.backbone(solution.q, 50)).min() - 0.03
        stands.append((own < 0.1, now < 0.0))
    near, overlapping_now = np.sum(stands, axis=0)
    assert near > 10, "the cloud was never in the way"
    assert overlapping_now > 5, "the cloud never moved to where the body was"
