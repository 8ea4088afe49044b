"""What is saved and loaded is equal.

Motions come back from files as they were, and what is no motion is refused.

JSON is read strictly, and results are strict JSON on one line.
"""

import json
import math
import os
from collections.abc import Callable
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from sinuous.base.documents import result_value, yaml_text
from sinuous.files.documents import json_line, parse_json, parse_yaml, result
from sinuous.motion.job import job_of, read_problem
from sinuous.scene.obstacles import Obstacle
from tests.helpers import random_pose, refused, with_each
from tests.model import test_elastic as elastic
from tests.model.test_actuators import DRIVEN
from tests.model.test_laws import robots
from tests.scene.shapes import EACH_KIND, cube, obj, together
from tests.statics import test_equilibrium as loaded

LAMP = sn.Sphere((0, 0, 9), 1.0)
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))

seeds = st.integers(0, 10**6)
names = st.none() | st.sampled_from(["lamp", "no", "a: b", "größe"])
numbers = st.floats(-1e3, 1e3)
points = st.tuples(numbers, numbers, numbers)
sizes = st.floats(1e-9, 1e6)


def turned(seed: int) -> Any:
    return random_pose(np.random.default_rng(seed))[:3, :3]


obstacles = st.one_of(
    st.builds(sn.Sphere, points, sizes, st.booleans(), names),
    st.builds(lambda c, s, r, n: sn.Box(c, s, turned(r), name=n), points, st.tuples(*[sizes] * 3), seeds, names),
    st.builds(sn.Capsule, points, points, sizes, names),
    st.builds(
        lambda a, h, r, i: sn.Cylinder(a, np.add(a, (0, h + 1e-3, 1)), r, i), points, sizes, sizes, st.booleans()
    ),
    st.builds(lambda p, s: sn.HalfSpace(p, turned(s)[0]), points, seeds),
)
targets = st.one_of(
    st.builds(sn.Target, points, segment=st.none() | st.just(1)),
    st.builds(lambda p, s: sn.Target(p, direction=turned(s)[0]), points, seeds),
    st.builds(lambda s: sn.Target(rotation=turned(s)), seeds),
    st.just(sn.Target(np.eye(4))),
)
waypoints = st.lists(targets, min_size=1, max_size=3)


def names_of(scene: sn.Scene) -> list[str]:
    return [scene.name(i) for i in range(len(scene))]


def again(problem: sn.Job) -> sn.Job:
    return job_of(parse_yaml(yaml_text(problem.to_dict())), "")


@given(robots, st.lists(obstacles, max_size=3), waypoints, st.booleans(), st.data())
def test_problems_of_all_kinds(
    robot: sn.Robot, scene: list[Any], asked: list[sn.Target], is_path: bool, data: st.DataObject
) -> None:
    times = data.draw(st.sampled_from([None, np.arange(len(asked) + 1) / 3]))
    question: Any = {"path": [asked, *asked], "times": times} if is_path else {"target": asked}
    problem = sn.Job(
        robot,
        scene=scene,
        tolerance=data.draw(st.sampled_from([None, sn.Tolerance(0.1), sn.Tolerance(angle=1e-7)])),
        start=data.draw(st.none() | st.just(np.full((len(robot), 3), 1 / 3))),
        prefer=data.draw(st.sampled_from([None, sn.Preferences(bends=0.1)])),
        rates=data.draw(st.sampled_from([None, sn.Rates(bend=0.1, acceleration=sn.Rates(length=2.5))])),
        **question,
    )
    found = again(problem)
    assert found.equals(problem)
    assert found.robot.equals(robot)
    assert not found.equals(sn.Job(robot, asked[0], scene, tolerance=sn.Tolerance(0.2)))


@pytest.mark.parametrize(
    ("file", "ending"),
    list(zip(EXAMPLES, cycle(["yaml", "json"]), strict=False)),
    ids=lambda each: getattr(each, "stem", each),
)
def test_examples(tmp_path: Path, file: Path, ending: str) -> None:
    problem = read_problem(file)
    problem.save(tmp_path / f"again.{ending}")
    found = read_problem(tmp_path / f"again.{ending}")
    assert found.equals(problem)
    assert names_of(found.scene) == names_of(problem.scene)


@pytest.mark.parametrize("ending", ["yaml", "json"])
def test_robots_with_motors_elastic_tendons_and_payloads(tmp_path: Path, ending: str) -> None:
    payload = [sn.Payload(0.1, (0, 0.05, 0.1)), sn.Payload(0.2, segment=1)]
    uncertain = sn.Uncertainty((0.004, 0.01))
    for robot in (DRIVEN, elastic.arm(tension=(0.5, 30.0)), loaded.arm(payload=payload, uncertainty=uncertain)):
        robot.save(tmp_path / f"arm.{ending}")
        assert sn.load(tmp_path / f"arm.{ending}", sn.Robot).equals(robot)
    assert not DRIVEN.equals(DRIVEN.changed(segments=[s.changed(tendons=None) for s in DRIVEN.segments]))


def test_obstacles_from_files_stay_where_they_are(tmp_path: Path) -> None:
    (tmp_path / "shapes").mkdir()
    (tmp_path / "shapes" / "parts.obj").write_text(obj(together(cube(), cube(1.0, (0.5, 0.0, 0.0)))))
    (tmp_path / "shapes" / "scan.xyz").write_text("0 0 1\n0 0 2\n")
    np.savez(tmp_path / "shapes" / "mask.npz", values=np.ones((2, 2, 2), bool), origin=(5, 5, 5), spacing=0.5)
    (tmp_path / "room.yaml").write_text(
        "- mesh: {file: shapes/parts.obj, scale: 2, position: [1, 2, 3], xyzw: [0, 1, 0, 2]}\n"
        "- points: {file: shapes/scan.xyz, radius: [0.1, 0.25], name: scan}\n"
        "- grid: {file: shapes/mask.npz}\n"
        "- sphere: {center: [0, 9, 0], radius: 1}\n"
    )
    scene = sn.load(tmp_path / "room.yaml")
    assert isinstance(scene, sn.Scene)
    assert len(scene) == 5
    (tmp_path / "elsewhere").mkdir()
    scene.save(tmp_path / "elsewhere" / "room.yaml")
    text = (tmp_path / "elsewhere" / "room.yaml").read_text()
    assert text.count("file: ") == 3
    assert "../shapes/parts.obj" in text
    found = sn.load(tmp_path / "elsewhere" / "room.yaml")
    assert isinstance(found, sn.Scene)
    assert found.equals(scene)
    assert names_of(found) == names_of(scene)
    whole = sn.Mesh.load(tmp_path / "shapes" / "parts.obj", 2.0)
    parts = whole.bodies()
    named = [part.named("engine") for part in parts]
    some_of_it = scene.obstacles[1:], scene.obstacles[:2], [whole], parts, [*parts, *parts]
    for kept in (*some_of_it, [*named, LAMP], [*named, LAMP.named("lamp")]):
        some = sn.Scene(kept)
        some.save(tmp_path / "some.yaml")
        assert some.equals(sn.load(tmp_path / "some.yaml"))


HELD: dict[str, Callable[[], Obstacle]] = {
    **{name: EACH_KIND[name] for name in ("mesh", "mesh around", "plates", "cloud", "cells", "samples")},
    "bodies": lambda: sn.Mesh(*together(cube(), cube(1.0, (0.5, 0.0, 0.0)))),
    "points": lambda: sn.PointCloud(np.eye(3), 0.1),
}


@pytest.mark.parametrize("name", HELD)
def test_obstacles_of_arrays_are_written_out(tmp_path: Path, name: str) -> None:
    problem = sn.Job(sn.Robot.uniform(2, 1.0), sn.Target((0, 0, 1)), [LAMP, HELD[name]()])
    problem.save(tmp_path / "a.yaml")
    assert read_problem(tmp_path / "a.yaml").equals(problem)
    assert os.listdir(tmp_path) == ["a.yaml"]


def test_a_function_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    problem = sn.Job(sn.Robot.uniform(2, 1.0), sn.Target((0, 0, 1)), [LAMP, EACH_KIND["function"]()])
    refused("scene[1]", lambda: problem.save(tmp_path / "a.yaml"), "a file can hold")
    assert os.listdir(tmp_path) == []


ROBOT = sn.Robot.uniform(3, (45, 70), max_bend=1.6, radius=4)
BALL = sn.Sphere((0, 100, 100), radius=10, name="ball")
PLACE = np.array([60.0, 0.0, 150.0])
MOVING = sn.Moving(BALL, [0, 1], [(0, 0, 0), (0, 3, 0)])


@pytest.mark.parametrize("scene", [None, BALL, MOVING], ids=["nothing", "ball", "moving"])
def test_motions_are_saved_and_loaded(scene: Any, tmp_path: Path) -> None:
    q = sn.solve(ROBOT, PLACE).q
    near = np.add(q, (0.01, 0.02, 0.3))
    motions = [
        sn.track(ROBOT, [PLACE, np.add(PLACE, (0, 9, 0))], scene, tolerance=sn.Tolerance(0.01)),
        sn.Motion(ROBOT, [q, near], scene),
        sn.plan(ROBOT, q, np.add(PLACE, (0, 9, 0)), scene, duration=2),
        sn.plan(ROBOT, q, near, scene, duration=2),
        sn.track(ROBOT, [PLACE, (0, 0, 900)], scene),
        sn.track(ROBOT, [PLACE, PLACE], sn.Sphere((0, 0, 50), radius=20), start=q),
    ]
    assert {str(motion.status) for motion in motions} == {"solved", "out_of_reach", "start_blocked"}
    for i, motion in enumerate(motions):
        for name in ("motion.yaml", "motion.json"):
            motion.save(tmp_path / name)
            again = sn.load(tmp_path / name, sn.Motion)
            assert again.equals(motion), (i, name)
            assert again.to_dict() == motion.to_dict()


def test_files_of_motions_are_checked(tmp_path: Path) -> None:
    sn.Motion(ROBOT, [[[0, 0.1, 55]] * 3, [[0, 0.2, 55]] * 3]).save(tmp_path / "motion.json")
    text = (tmp_path / "motion.json").read_text(encoding="utf-8")
    for old, new, key in (
        ('"steps": [', '"steps": [[1.0], ', "motion.steps"),
        ('"knots": [', '"knots": [[1.0], ', "motion.knots"),
        ('"remaining": 0', '"remaining": -1', "motion.remaining"),
    ):
        assert old in text
        (tmp_path / "wrong.json").write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(sn.InputError, match=r"wrong\.json: motion\.\w+: expected") as caught:
            sn.load(tmp_path / "wrong.json")
        assert caught.value.key == key
    with pytest.raises(sn.InputError, match="file: expected a Robot"):
        sn.load(tmp_path / "motion.json", sn.Robot)


@with_each(
    ("text", "key", "problem"),
    [
        ('{"a": NaN}', "a", "expected a finite number"),
        ('{"a": [0, {"b": -Infinity}]}', "a[1].b", "expected a finite number"),
        ('{"a": 1e400}', "a", "expected a finite number"),
        ('{"a": ' + "9" * 5000 + "}", "a", "expected a finite number"),
        ('{"a": 1, "a": 1}', "a", "stands twice"),
        ('{"a": 1,\nb}', "line 2", "Expecting property name"),
        ('{"a": 1}\n{"a": 1}', "line 2", "Extra data"),
        ("", "line 1", "Expecting value"),
        ("[" * 100_000, "file", "nested too deeply"),
    ],
)
def test_refusals_name_line_or_key(text: str, key: str, problem: str) -> None:
    refused(key, lambda: parse_json(text), problem)


def test_nothing_of_numpy_and_nothing_infinite_leaks() -> None:
    value = {
        "a": np.float64(1.5),
        "b": np.arange(3),
        "c": (np.int64(2), math.inf),
        "d": float("nan"),
        "e": np.bool_(True),
    }
    line = json_line(value)
    assert "\n" not in line
    assert json.loads(line) == {"a": 1.5, "b": [0, 1, 2], "c": [2, None], "d": None, "e": True}
    assert result_value(np.array([np.inf, 1.0])) == [None, 1.0]


def test_the_file_comes_first_and_the_time_of_preparing_after_that_of_solving() -> None:
    entries = result("a.yaml", {"status": "solved", "seconds": 1.0, "method": "newton"}, 2.0)
    assert list(entries) == ["file", "status", "seconds", "prepare_seconds", "method"]
