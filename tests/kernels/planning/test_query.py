"""Paths of configurations: every edge is clear, ends and limits are kept, and the same seed gives the same path."""

import math

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion.p5 import draw
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import ANSWER_WIDTH, CLEARANCES, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, PROVED_BOUND, sweep_size
from sinuous.kernels.planning.query import nodes_of, plan, plan_size
from sinuous.model.robot import robot_group
from sinuous.scene.scene import Scene
from sinuous.solver.certificates.steps import prove_steps
from tests.helpers import Floats
from tests.kernels.certificate.motions import shape

NODES, KNOTS = 4000, 500
ROBOT = sn.Robot([sn.Segment((0.8, 1.2), 2.8, radius=0.05)] * 4)


class Plan:
    """One plan, whose trees can grow on."""

    def __init__(self, robot: sn.Robot, scene: Scene) -> None:
        self.robot, self.scene, n = robot, scene.snapshot(), len(robot)
        self.work = np.full(sweep_size(n, len(scene)), np.nan), np.full(plan_size(n, NODES), np.nan)
        self.q, self.answers = np.full((KNOTS, n, 3), np.nan), np.full((KNOTS, ANSWER_WIDTH), np.nan)

    def grow(
        self, ends: Floats, draws: tuple[int, int] = (0, 5000), seed: int = 0, tries: int = 0, seconds: float = 60.0
    ) -> Floats:
        """Knots (T, n, 3) of what was found; none when T is 0."""
        asked = float(self.robot.mount), self.robot.mean_length, seconds, seed, *draws, tries
        group = robot_group(self.robot), self.scene.group.copy()
        count, self.nodes, self.length = plan(*group, ends, asked, *self.work, self.q, self.answers)
        return self.q[:count].copy()


def pair(seed: int, robot: sn.Robot = ROBOT) -> tuple[Scene, Floats]:
    """Spheres, and two configurations (2, n, 3) that are clear of them and of themselves."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-4.0, 4.0, (60, 3))
    scene = Scene([sn.Sphere(c, 0.3) for c in centers if np.linalg.norm(c[:2]) > 0.4 or not -0.4 < c[2] < 4.4])
    ends: list[Floats] = []
    while len(ends) < 2:
        q = shape(robot, rng)
        if prove_steps(robot, scene.snapshot(), np.stack([q, q])).proved.all():
            ends.append(q)
    return scene, np.stack(ends)


def test_every_edge_is_clear_and_the_ends_are_those_that_were_asked_for() -> None:
    knots = []
    for seed in range(20):
        scene, ends = pair(seed)
        made = Plan(ROBOT, scene)
        path = made.grow(ends)
        assert len(path) >= 2, seed
        np.testing.assert_array_equal(path[[0, -1]], ends)
        again = prove_steps(ROBOT, made.scene, path)
        assert again.proved.all()
        answers = made.answers[: len(path) - 1]
        assert (answers[:, VERDICT] == CLEAR).all()
        for column in (CLEARANCES + PROVED_BOUND, CLEARANCES + CLEARANCES_WIDTH + PROVED_BOUND):
            assert answers[:, column].min() == pytest.approx(again.answers[:, column].min(), rel=0.2)
        assert max(ROBOT.excess(q) for q in path) < 1e-12
        knots.append(len(path))
    assert max(knots) > 2  # not all of them are straight


def test_shortcuts_make_no_path_longer_and_leave_it_clear() -> None:
    shorter = 0
    for seed in range(8):
        scene, ends = pair(seed)
        plain, tight = Plan(ROBOT, scene), Plan(ROBOT, scene)
        plain.grow(ends)
        path = tight.grow(ends, tries=30)
        assert prove_steps(ROBOT, tight.scene, path).proved.all()
        assert (tight.answers[: len(path) - 1, VERDICT] == CLEAR).all()
        assert tight.length <= plain.length + 1e-9
        shorter += tight.length < 0.99 * plain.length
    assert shorter > 0


def test_the_bound_of_a_path_is_tight_and_that_of_any_edge_half_as_large_as_it_may_be() -> None:
    edges = 0
    for seed in range(12):
        scene, ends = pair(seed)
        made = Plan(ROBOT, scene)
        path = made.grow(ends)
        tight = prove_steps(ROBOT, made.scene, path, slack=0.01).clearances
        found = made.answers[: len(path) - 1, CLEARANCES + PROVED_BOUND]
        assert (found >= 0.49 * tight).all()
        assert found.min() >= 0.89 * tight.min()
        edges += len(found)
    assert edges > 12


@pytest.mark.parametrize(("segments", "number"), [(6, 192), (4, 1)])
def test_trees_come_out_of_narrow_places(segments: int, number: int) -> None:
    """Hardly any direction leads out of there in which all segments move at once."""
    hard = draw(segments, 1, number, 0)
    for seed in range(4):
        path = Plan(hard.robot, hard.scene).grow(np.stack([hard.start, hard.goal]), (0, 1024), seed=seed)
        assert len(path) > 2, seed
        assert prove_steps(hard.robot, hard.scene.snapshot(), path).proved.all()


def test_a_tree_that_is_behind_keeps_limits_that_segments_share() -> None:
    line = sn.Actuators([[0.05, 0.0, 0.0] * 4, [0.0, 0.05, 0.0] * 4], limits=[(-0.08, 0.08)] * 2)
    robot = sn.Robot([sn.Segment(1.0, 2.8, radius=0.05)] * 4, actuators=line)
    rng = np.random.default_rng(5)
    goals = [q for q in (shape(robot, rng) for _ in range(2000)) if robot.excess(q) <= 0.0]
    goals = [q for q in goals if np.hypot(*robot.tip(q)[:2, 3]) > 1.0][:150]
    made = Plan(robot, Scene([sn.Sphere(robot.tip(q)[:3, 3], 0.02) for q in goals]))  # so none of them is reached
    made.grow(np.stack([np.tile([0.0, 0.0, 1.0], (4, 1)), *goals]), (0, 200))
    nodes = nodes_of(made.work[1], len(robot))
    assert len(goals) == 150
    assert len(nodes) > 2
    assert max(robot.excess(q) for q in nodes) < 1e-12


def test_trees_grow_on_with_more_goals() -> None:
    """What few draws do not reach is reached by more, from the nodes that are there."""
    for scene, ends in map(pair, range(20)):
        made = Plan(ROBOT, scene)
        if len(made.grow(ends, (0, 2))):
            continue
        nodes = nodes_of(made.work[1], len(ROBOT)).copy()
        np.testing.assert_array_equal(nodes[0], ends[0])
        path = made.grow(ends[:1], (2, 5000))
        np.testing.assert_array_equal(path[[0, -1]], ends)
        now = nodes_of(made.work[1], len(ROBOT))
        np.testing.assert_array_equal(now[: len(nodes)], nodes)
        return
    pytest.fail("no pair is hard enough")


def test_the_length_is_that_of_the_path() -> None:
    scene, ends = pair(1)
    made = Plan(ROBOT, scene)
    path = made.grow(ends)
    levers = 1.0 * np.arange(3, -1, -1) + 0.5
    steps = np.diff(path, axis=0) * np.stack([levers, levers, np.ones(4)], axis=-1)
    assert made.length == pytest.approx(math.fsum(np.sqrt((steps**2).sum(axis=(1, 2)))))
