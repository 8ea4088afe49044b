"""Exploring: rounds are the same for a seed, all that is kept is clear, and plans walk on it."""

import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.judge import wrong_in
from sinuous.solver.options import SolveOptions
from sinuous.studies.exploring.explorer import Explorer
from tests.helpers import refused

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), max_bend=2.0, radius=0.05)
HANGING = sn.Robot(
    [sn.Segment(1.0, radius=0.05)] * 2, stiffness=sn.Stiffness(bend=1.0), mass=0.1, gravity=(0, 0, -9.81)
)
SCENE = [sn.Sphere((0.6, 0.0, 1.2), 0.3), sn.Sphere((-0.3, 0.7, 1.0), 0.25), sn.HalfSpace((0, 0, -0.2), (0, 0, 1))]


def explored(
    rounds: int, memory: sn.Memory | None = None, scene: Any = SCENE, **options: Any
) -> sn.studies.Exploration:
    return sn.studies.explore(ROBOT, scene, time=600, memory=memory, rounds=rounds, **options)


@pytest.fixture(scope="module")
def two() -> sn.studies.Exploration:
    return explored(2)


def test_the_same_rounds_make_the_same_memory(two: sn.studies.Exploration, tmp_path: Path) -> None:
    first = explored(1, workers=1)
    first.memory.save(tmp_path / "place.npz")
    memory = sn.Memory.load(tmp_path / "place.npz")
    with ThreadPoolExecutor(2) as pool:
        again = explored(1, memory, engine=pool)
    assert (again.rounds, again.memory.fingerprint) == (2, two.memory.fingerprint)
    assert again.to_dict() | {"seconds": 0.0} == two.to_dict() | {"seconds": 0.0}
    assert explored(2, seed=1).memory.fingerprint != two.memory.fingerprint


def test_all_that_is_kept_is_clear_and_within_limits(two: sn.studies.Exploration) -> None:
    memory = two.memory
    assert two.shapes == len(memory) > 100
    assert two.motions == len(memory.edges) > 100
    assert sum(two.parts) == two.shapes
    assert 0.0 <= two.covered <= 1.0
    assert 0.5 < two.joined <= 1.0
    rng = np.random.default_rng(0)
    for pair in memory.edges[rng.choice(len(memory.edges), 25, replace=False)]:
        assert not wrong_in(ROBOT, sn.Scene(SCENE), memory.q[pair])


def test_a_plan_walks_along_what_is_kept(two: sn.studies.Exploration) -> None:
    planner = sn.Planner(ROBOT, SCENE, memory=two.memory.reading(), max_starts=1)
    rng, steps = np.random.default_rng(1), 0
    graph = two.memory._shapes.everything
    for one, other in rng.choice(np.flatnonzero(graph.parts == 0), (8, 2)):
        goal = sn.Target(graph.tips[other] + 0.01)
        motion = planner.plan(graph.q[one], goal)
        assert motion.solved
        assert motion.solutions[0].verify().ok
        assert not wrong_in(ROBOT, sn.Scene(SCENE), motion.q)
        to_shape = planner.plan(graph.q[one], graph.q[other])
        assert to_shape.solved
        np.testing.assert_array_equal(to_shape.q[[0, -1]], graph.q[[one, other]])
        steps += len(motion.q) - 1
    assert steps >= 8


def test_a_changed_scene_keeps_what_is_still_clear(two: sn.studies.Exploration) -> None:
    memory = pickle.loads(pickle.dumps(two.memory))
    more = [*SCENE, sn.Sphere((0.0, -0.7, 1.3), 0.35)]
    start, goal = (sn.solve(ROBOT, sn.Target(place), more).q for place in ((0.2, -1.2, 0.9), (0.9, -0.4, 1.6)))
    motion = sn.plan(ROBOT, start, goal, more, memory=memory.reading())
    assert motion.solved  # motions that are not clear any more are closed on the way
    assert not wrong_in(ROBOT, sn.Scene(more), motion.q)
    left = explored(0, memory, more)
    assert 0 < left.shapes < two.shapes
    assert 0 < left.motions < two.motions
    assert (left.rounds, left.tests) == (0, 0)
    for pair in memory.edges[:: len(memory.edges) // 10]:
        assert not wrong_in(ROBOT, sn.Scene(more), memory.q[pair])


def test_a_plan_that_is_searched_for_is_remembered() -> None:
    memory = sn.Memory(ROBOT)
    start, goal = (sn.solve(ROBOT, sn.Target(place), SCENE).q for place in ((1.2, -0.4, 1.0), (-0.2, 1.3, 0.9)))
    planner = sn.Planner(ROBOT, SCENE, memory=memory)
    first = planner.plan(start, goal)
    assert first.solved
    assert len(memory.edges) == len(first.q) - 1
    again = planner.plan(goal, start)
    assert again.solved
    assert len(memory.edges) == len(first.q) - 1


def test_starts_are_joined_and_a_worker_travels(two: sn.studies.Exploration) -> None:
    kept = sn.studies.explore(
        ROBOT, SCENE, time=0, starts=np.stack([two.memory.q[5], two.memory.q[5], two.memory.q[9]])
    )
    assert 1 < kept.shapes <= 3
    blocked = sn.studies.explore(ROBOT, [sn.Sphere((0, 0, 1), 0.3)], time=0)
    assert (blocked.shapes, blocked.parts) == (0, ())
    assert np.isnan(blocked.covered)
    assert blocked.to_dict()["covered"] is None
    explorer = Explorer(ROBOT, sn.Scene(SCENE), SolveOptions.of({"max_starts": 3}))
    assert pickle.loads(pickle.dumps(explorer)).robot.equals(ROBOT)


@pytest.mark.parametrize(
    ("key", "options", "words"),
    [
        ("starts[0]", {"starts": [[9, 0, 1], [0, 0, 1]]}, ""),
        ("rounds", {"rounds": -1}, ""),
        ("spacing", {"spacing": 0}, ""),
        ("memory", {"memory": "arm.npz"}, "expected a Memory"),
        ("memory", {"memory": sn.Memory(sn.Robot.uniform(3, 1.0))}, "of another robot;"),
        ("engine", {"engine": "steam"}, ""),
        ("workers", {"workers": 0}, ""),
        ("scene", {"scene": [sn.Moving(sn.Sphere((3, 0, 0), 0.1), [0, 1], [(3, 0, 0), (4, 0, 0)])]}, "moves"),
        ("gravity", {"robot": HANGING}, ""),
        ("robot", {"robot": 7}, ""),
        ("budget", {"budget": 7}, "unknown option; expected one of "),
    ],
)
def test_what_cannot_be_meant_is_refused(key: str, options: dict[str, Any], words: str) -> None:
    given: dict[str, Any] = {"robot": ROBOT, "time": 0.0, **options}
    refused(key, lambda: sn.studies.explore(**given), words)
