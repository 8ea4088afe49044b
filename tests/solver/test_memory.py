"""Remembered shapes are starts: found by pose, kept within bounds, never answers."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.places import make
from benchmarks.places.place import right
from sinuous.kernels.solve.recall import ANGLE_WEIGHT
from sinuous.solver.shapes import NEAREST, SPACING, TAIL

ROBOT = sn.Robot.uniform(4, (0.5, 1.5), max_bend=2.5, radius=0.05, tool=sn.pose((0.0, 0.1, 0.2)))


def shapes(count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-2, 2, (count, 4, 2)), rng.uniform(0.5, 1.5, (count, 4, 1))], axis=2)


@pytest.mark.parametrize("kind", ["position", "direction", "rotation", "direction alone", "elbow and tip"])
@pytest.mark.parametrize("count", [1, 3, TAIL, 5 * TAIL])
def test_the_nearest_are_those_of_a_look_at_all(kind: str, count: int) -> None:
    memory, kept, asked = sn.Memory(ROBOT), shapes(count), shapes(4, seed=1)
    for some in np.array_split(kept, min(count, 3)):
        memory.add(some)
    for q in asked:
        tip, elbow = ROBOT.tip(q), ROBOT.forward(q)[1]
        targets, far = {
            "position": ([sn.Target(tip[:3, 3])], _apart(q, kept, position=True)),
            "direction": ([sn.Target(tip[:3, 3], direction=tip[:3, 2])], _apart(q, kept, position=True, axis=True)),
            "rotation": ([sn.Target(tip[:3, 3], rotation=tip[:3, :3])], _apart(q, kept, position=True, turn=True)),
            "direction alone": ([sn.Target(direction=tip[:3, 2])], _apart(q, kept, axis=True)),
            "elbow and tip": (
                [sn.Target(elbow[:3, 3], segment=2), sn.Target(tip[:3, 3])],
                np.hypot(_apart(q, kept, position=True), _apart(q, kept, position=True, segment=1)),
            ),
        }[kind]
        found = memory.nearest(targets)
        assert len(found) == min(NEAREST, count)
        np.testing.assert_array_equal(found, kept[np.argsort(far, kind="stable")[:NEAREST]])


def _apart(
    q: np.ndarray,
    kept: np.ndarray,
    *,
    position: bool = False,
    axis: bool = False,
    turn: bool = False,
    segment: int | None = None,
) -> np.ndarray:
    """Distances of poses as the docstring says them: chords of angles, which order as angles do."""
    poses = [ROBOT.tip(each) if segment is None else ROBOT.forward(each)[..., segment, :, :] for each in (q, kept)]
    place = np.linalg.norm(poses[1][:, :3, 3] - poses[0][:3, 3], axis=1) / ROBOT.mean_length
    cosine = np.clip(poses[1][:, :3, 2] @ poses[0][:3, 2], -1, 1)
    angle = np.arccos(cosine) if axis else Rotation.from_matrix(poses[0][:3, :3].T @ poses[1][:, :3, :3]).magnitude()
    distances: np.ndarray = np.hypot(place * position, 2.0 * np.sin(angle / 2.0) * ANGLE_WEIGHT * (axis or turn))
    return distances


def test_a_second_target_in_a_pipe_begins_from_the_first() -> None:
    place = make("two tubes", 2)
    memory = sn.Memory(place.robot)
    solver = sn.Solver(place.robot, place.scene, memory=memory)
    first = solver.solve(place.targets)
    again = solver.solve(place.targets)
    assert (first.solved, first.start, len(memory)) == (True, "route", 1)
    assert (again.solved, again.start, again.starts, len(memory)) == (True, "remembered", 1, 1)
    assert right(place, again.q)
    many = solver.solve_many([place.targets] * 3)
    assert list(many.start) == ["remembered"] * 3
    assert len(memory) == 1


def test_many_among_obstacles_may_end_undecided_near_a_remembered_shape() -> None:
    """The best of several starts is the remembered one, and nothing is solved in the first call."""
    robot = sn.Robot.uniform(4, (0.8, 1.2), max_bend=1.5, radius=0.1)
    grid = [sn.Sphere((x, y, 3.0), radius=0.3) for x in np.linspace(-1, 1, 5) for y in np.linspace(-1, 1, 5)]
    memory = sn.Memory(robot)
    memory.add(robot.straight[None] * (1.0, 1.0, 0.7) + (0.2, 0.0, 0.0))
    solver = sn.Solver(robot, grid, memory=memory, max_starts=20, time=0.3)
    found = solver.solve_many(positions=[(0.2, 0.1, 3.8), (0.4, 0.3, 3.7)], workers=1)
    assert all(each.verify().ok for each in found if each.solved)


def test_many_answers_are_those_of_a_loop_over_a_memory_that_does_not_learn() -> None:
    place = make("spheres 40", 4)
    tips = place.robot.tip(place.hidden_q + np.random.default_rng(0).normal(0, 0.03, (20, *place.hidden_q.shape)))
    memory = sn.Memory(place.robot)
    memory.add(place.hidden_q)
    reading = memory.reading()
    solver = sn.Solver(place.robot, place.scene, memory=reading, max_starts=50)
    many = solver.solve_many(positions=tips[:, :3, 3])
    each = [solver.solve(sn.Target(tip[:3, 3])) for tip in tips]
    assert len(reading) == 1
    for one, other in zip(many, each, strict=True):
        assert (one.status, one.start, one.starts) == (other.status, other.start, other.starts)
        np.testing.assert_array_equal(one.q, other.q)
    learning = sn.Solver(place.robot, place.scene, memory=memory, max_starts=50)
    assert learning.solve_many(positions=tips[:, :3, 3]).q.tobytes() == many.q.tobytes()
    assert 1 < len(memory) <= 1 + many.solved.sum()


def test_a_wrong_memory_changes_no_status() -> None:
    scene = [sn.Sphere((0.0, 1.5, 2.0), 0.4), sn.Box((1.0, 0.0, 2.0), (0.3, 0.3, 0.3))]
    memory = sn.Memory(ROBOT)
    memory.add(shapes(200, seed=3))
    targets = [sn.Target(ROBOT.tip(q)[:3, 3]) for q in shapes(30, seed=5)] + [sn.Target((90.0, 0.0, 0.0))]
    without, with_memory = sn.Solver(ROBOT, scene), sn.Solver(ROBOT, scene, memory=memory)
    for target in targets:
        one, other = without.solve(target), with_memory.solve(target)
        assert one.status == other.status
        if other.solved:
            assert other.verify().ok


def test_a_changed_scene_is_asked_anew() -> None:
    memory, scene, target = sn.Memory(ROBOT), sn.Scene([sn.PointCloud([(9, 9, 9)], 0.2)]), sn.Target((1.2, 0.3, 2.5))
    solver = sn.Solver(ROBOT, scene, memory=memory)
    before = solver.solve(target)
    middle = ROBOT.backbone(before.q)[40]
    scene.update(middle[None])
    after = solver.solve(target)
    assert after.solved
    assert after.verify().ok
    assert np.abs(after.q - before.q).max() > SPACING


def test_the_older_half_is_forgotten_when_it_is_full() -> None:
    memory = sn.Memory(ROBOT, megabytes=0.05)
    kept = shapes(300)
    for q in kept:
        memory.add(q)
    assert 0 < len(memory) * 15 * 4 * 8 < 0.05e6
    np.testing.assert_array_equal(memory.q, kept[-len(memory) :])
    target = sn.Target(ROBOT.tip(kept[-1])[:3, 3])
    np.testing.assert_array_equal(memory.nearest(target, 1)[0], kept[-1])


def test_it_comes_back_from_a_file_and_a_pickle(tmp_path: Path) -> None:
    memory = sn.Memory(ROBOT, megabytes=3.0)
    memory.add(shapes(20))
    memory.save(tmp_path / "arm.npz")
    for other in (sn.Memory.load(tmp_path / "arm.npz"), pickle.loads(pickle.dumps(memory))):
        assert other.robot.equals(ROBOT)
        assert (other.megabytes, other.learns, other.fingerprint) == (3.0, True, memory.fingerprint)
    assert [file.name for file in tmp_path.iterdir()] == ["arm.npz"]


@pytest.mark.parametrize("size", [0, 1, 100, -1])
def test_a_damaged_file_is_refused_in_a_line(tmp_path: Path, size: int) -> None:
    file = tmp_path / "arm.npz"
    memory = sn.Memory(ROBOT)
    memory.add(shapes(20))
    memory.save(file)
    whole = file.read_bytes()
    file.write_bytes(whole[:size] if size >= 0 else whole[:-2000] + bytes(1000) + whole[-1000:])
    with pytest.raises(
        sn.InputError, match=r"^memory: damaged.*; expected a file that Memory.save wrote, got .*arm\.npz'"
    ):
        sn.Memory.load(file)
