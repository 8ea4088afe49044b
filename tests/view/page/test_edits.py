"""Obstacles that are moved and resized by hand: a rigid motion moves what they are, and nothing else.

What is said of a shape: the nearest places lie on the surfaces, and errors are those that solutions tell.

Workers: in order, the latest of a key, and nothing that is raised ends them.

Tests of the fields of the panel: what a person puts there is neither lost nor taken back.
"""

import asyncio
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from sinuous.view.page.edits import KINDS, make_obstacle, move_obstacle, pose_of, resize_obstacle, sizes_of
from sinuous.view.page.panel import Fields
from sinuous.view.page.session import Worker
from sinuous.view.page.status import find_nearest
from tests.helpers import Floats, present, random_pose, refused
from tests.scene.shapes import EACH_KIND

RNG = np.random.default_rng(0)
CARRIED = [make() for name, make in EACH_KIND.items() if name not in ("cells", "samples", "function")]


def distance(obstacle: Obstacle, points: Floats) -> Floats:
    return sn.Scene([obstacle]).distance(points)


@pytest.mark.parametrize("obstacle", CARRIED, ids=lambda obstacle: obstacle.kind)
def test_a_rigid_motion_carries_the_distances_along(obstacle: Obstacle) -> None:
    motion, points = random_pose(RNG, 2.0), RNG.normal(size=(50, 3))
    moved = move_obstacle(obstacle, motion)
    there = points @ motion[:3, :3].T + motion[:3, 3]
    np.testing.assert_allclose(distance(moved, there), distance(obstacle, points), atol=1e-9)
    assert moved.name == obstacle.name
    assert getattr(moved, "inside", None) == getattr(obstacle, "inside", None)


def test_what_is_from_a_file_stays_from_there(tmp_path: Path) -> None:
    np.save(tmp_path / "scan.npy", RNG.normal(size=(20, 3)))
    cloud = sn.PointCloud.load(tmp_path / "scan.npy", 0.1, scale=2.0, position=(1, 0, 0))
    moved = move_obstacle(cloud, random_pose(RNG))
    assert moved.source is not None
    again = sn.PointCloud.load(moved.source.file, **moved.source.arguments)
    assert again.equals(moved)


def test_grids_move_unless_a_file_says_where_they_are(tmp_path: Path) -> None:
    values = np.ones((3, 3, 3), bool)
    shift = np.eye(4)
    shift[:3, 3] = 5.0
    grid = move_obstacle(sn.Grid(values, (0, 0, 0), 1.0), shift)
    assert isinstance(grid, sn.Grid)
    np.testing.assert_array_equal(grid.origin, (5, 5, 5))
    np.savez(tmp_path / "grid.npz", values=values, origin=np.zeros(3), spacing=1.0)
    fixed = sn.Grid.load(tmp_path / "grid.npz")
    assert pose_of(fixed) is None
    refused("obstacle", lambda: move_obstacle(fixed, shift), "cannot be moved")


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_obstacle_is_of_its_kind_and_its_sizes_can_be_set(kind: str) -> None:
    obstacle = make_obstacle(kind, np.array([1.0, 2.0, 3.0]), 0.5)
    assert obstacle.kind == kind
    for label, value in sizes_of(obstacle).items():
        other = resize_obstacle(obstacle, **{label.replace(" ", "_"): 2.0 * value})
        assert sizes_of(other) == pytest.approx(sizes_of(obstacle) | {label: 2.0 * value})
        before, after = pose_of(obstacle), pose_of(other)
        np.testing.assert_allclose(present(after), present(before), atol=1e-12)


ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.05)
SCENE = sn.Scene([sn.Sphere((0.5, 0, 1.5), radius=0.2, name="ball"), sn.Box((-1, 0, 1), (0.5, 0.5, 0.5), name="crate")])


def test_the_line_to_the_nearest_place_ends_on_both_surfaces() -> None:
    for seed in range(20):
        q = np.random.default_rng(seed).uniform((-1, -1, 0.8), (1, 1, 1.2), (3, 3))
        near = present(find_nearest(ROBOT, SCENE.snapshot(), q))
        assert abs(float(SCENE.distance(near.surface))) < 1e-6
        if near.distance > 0.0:  # deep within a box, its other side may be nearer to the surface of the body
            assert abs(float(SCENE.distance(near.body)) - near.distance) < 1e-6
        points = ROBOT.backbone(q, 16)
        assert np.isclose(near.distance, float(SCENE.distance(points).min()) - 0.05, atol=1e-9)


def test_there_is_no_nearest_place_without_obstacles_or_within_the_mount() -> None:
    q = np.array([[0.0, 0.0, 1.0]] * 3)
    assert find_nearest(ROBOT, sn.Scene().snapshot(), q) is None
    free = find_nearest(ROBOT, SCENE.snapshot(), q)
    mounted = find_nearest(ROBOT.changed(mount=2.5), SCENE.snapshot(), q)
    assert present(mounted).distance > present(free).distance


def test_of_one_key_only_the_latest_that_has_not_begun_is_run() -> None:
    hold, done = threading.Event(), threading.Event()
    ran: list[object] = []
    worker = Worker("test", ran.append)
    worker.post("first", hold.wait)
    for i in range(100):
        worker.post("move", partial(ran.append, i))
    worker.post("other", lambda: ran.append("other"))
    worker.post("move", lambda: ran.append("last"))
    worker.post("end", done.set)
    hold.set()
    assert done.wait(30.0)
    worker.stop()
    assert ran == ["other", "last"]


def test_what_is_raised_is_told_and_the_next_task_runs() -> None:
    done, told = threading.Event(), list[Exception]()
    worker = Worker("test", told.append)

    def fail() -> None:
        raise ValueError("no")

    worker.post(1, fail)
    worker.post(2, done.set)
    assert done.wait(30.0)
    worker.stop()
    assert [str(error) for error in told] == ["no"]


class Handle:
    """A field of a browser, without the browser."""

    label = "a number"

    def __init__(self, value: float) -> None:
        self.value = value
        self._hear: Any = None

    def on_update(self, hear: Callable[[Any], object]) -> None:
        self._hear = hear

    def put(self, value: float) -> None:
        """Change the value as a browser does."""
        self.value = value
        asyncio.run(self._hear(SimpleNamespace(client=object())))


class Model:
    """A number that is at most 9; its events wait until they are handled."""

    def __init__(self) -> None:
        self.number, self._events = 1.0, list[Callable[[], object]]()
        self.handle = Handle(self.number)
        self.fields = Fields(cast(Any, None), cast(Any, self))
        self.fields.field(self.handle, self.get, self.put)
        self.meanwhile: Callable[[], object] = lambda: None

    def get(self) -> float:
        number = self.number
        self.meanwhile()
        return number

    def put(self, value: float) -> None:
        if value > 9.0:
            raise ValueError("at most 9")
        self.number = value

    def do(self, key: str, change: Callable[[], object]) -> None:
        assert key
        self._events.append(change)

    def handled(self) -> None:
        for event in self._events:
            event()


@pytest.mark.parametrize("meanwhile", [False, True])
def test_what_a_person_puts_there_before_or_while_fields_are_refreshed_stays_until_it_is_handled(
    meanwhile: bool,
) -> None:
    model = Model()
    if meanwhile:
        model.meanwhile = lambda: model.handle.put(3.0)
    else:
        model.handle.put(3.0)
    model.fields.refresh()
    model.meanwhile = lambda: None
    assert (model.handle.value, model.number) == (3.0, 1.0)
    model.handled()
    model.fields.refresh()
    assert (model.handle.value, model.number) == (3.0, 3.0)


def test_what_was_refused_vanishes() -> None:
    model = Model()
    model.handle.put(10.0)
    with pytest.raises(ValueError, match="at most 9"):
        model.handled()
    model.fields.refresh()
    assert (model.handle.value, model.number) == (1.0, 1.0)
