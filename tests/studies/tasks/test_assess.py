"""An assessment says of every task what solving it says, and its totals are those of the rows.

A sweep changes just the fields that are named, and refuses what is none.
"""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

import sinuous as sn
from tests.helpers import refused, refused_each

ROBOT = sn.Robot.uniform(3, length=(45, 70), max_bend=1.5, radius=4, name="three")
OTHER = ROBOT.changed(name="thick", segments=[sn.Segment((45, 70), max_bend=1.5, radius=8)] * 3)
BALL = sn.Sphere((0, 60, 120), radius=25, name="ball")
NEAR = sn.Target((0, 10, 190))
TASKS: dict[str, Any] = {
    "near": NEAR,
    "elbow": [NEAR, sn.Target((0, 5, 60), segment=1)],
    "line": sn.studies.Follow([sn.Target((x, 10, 190)) for x in (-20, 0, 20)]),
    "far": sn.Target((0, 0, 900)),
    "half": sn.studies.Follow([NEAR, sn.Target((0, 0, 900))]),
    "inside": sn.Target((0, 60, 120)),
}


@pytest.fixture(scope="module")
def found() -> sn.studies.Assessment:
    return sn.studies.assess([ROBOT, OTHER], TASKS, [BALL])


def test_each_row_is_what_solving_says(found: sn.studies.Assessment) -> None:
    rows = {row.task: row.done for row in found.rows if row.robot == "three"}
    one, path = sn.solve(ROBOT, NEAR, [BALL]), sn.track(ROBOT, [sn.Target((x, 10, 190)) for x in (-20, 0, 20)], [BALL])
    assert (rows["near"].status, rows["near"].clearance, rows["near"].share) == ("solved", one.clearance, 1.0)
    assert (rows["line"].status, rows["line"].clearance) == (str(path.status), path.clearance)
    assert rows["line"].duration == path.times[-1]
    assert (rows["far"].status, rows["far"].share, rows["far"].duration) == ("out_of_reach", 0.0, None)
    assert (rows["half"].status, rows["half"].share) == ("out_of_reach", 0.5)
    assert (rows["inside"].status, rows["inside"].binds) == ("target_blocked", "ball")
    assert rows["elbow"].status == str(sn.solve(ROBOT, TASKS["elbow"], [BALL]).status)


def test_totals_sum_the_rows_up(found: sn.studies.Assessment) -> None:
    for total in found.totals:
        own = [row.done for row in found.rows if row.robot == total.robot]
        solved = [each for each in own if each.status == "solved"]
        assert (total.done, total.tasks) == (len(solved), len(TASKS))
        assert total.clearance == min(each.clearance for each in solved if each.clearance is not None)
        assert total.seconds == max(each.seconds for each in own)
        assert total.duration == max(each.duration for each in solved if each.duration is not None)
        assert total.binds in {each.binds for each in own if each.status != "solved"}
    assert not found.solved
    assert {row.task for row in found.failed("three")} >= {"far", "half", "inside"}
    assert found.best().done == max(total.done for total in found.totals)
    assert "of 6 done" in str(found)
    assert repr(found) == "Assessment(2 robots, 6 tasks)"


def test_tables(found: sn.studies.Assessment, tmp_path: Path) -> None:
    found.to_csv(tmp_path / "robots.csv")
    found.to_csv(tmp_path / "tasks.csv", tasks=True)
    for name, count in (("robots.csv", 2), ("tasks.csv", 12)):
        with (tmp_path / name).open(encoding="utf-8") as text:
            assert len(list(csv.DictReader(text))) == count
    assert json.loads(json.dumps(found.to_dict()))["totals"][1]["robot"] == "thick"
    refused("file", lambda: found.to_csv(tmp_path / "no" / "robots.csv"), "cannot be written")


def test_a_sweep_is_assessed_and_drawn(tmp_path: Path) -> None:
    robots = sn.studies.sweep(ROBOT, {"segments.length": [[30, 40], [45, 70]]})
    found = sn.studies.assess(robots, [NEAR])
    assert [total.done for total in found.totals] == [0, 1]
    assert found.rows[0].task == "task 1"
    assert found.rows[0].done.binds == "length"
    sn.view.plot_assessment(found, tmp_path / "robots.png")
    assert (tmp_path / "robots.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("robot", "tasks", "told"),
    [
        (ROBOT, {"a": 7}, r"^tasks\['a'\]: expected a Target"),
        (ROBOT, [], "at least one task"),
        (ROBOT, NEAR, "a mapping or a list"),
        (ROBOT, {"a": sn.Target((0, 0, 1), segment=9)}, r"^tasks\['a'\]"),
        ([ROBOT, ROBOT], [NEAR], "same name"),
        ({"a": 3}, [NEAR], r"^robot\['a'\]"),
        (3, [NEAR], "^robot: "),
        ({}, [NEAR], "at least one Robot"),
    ],
)
def test_wrong_arguments_are_refused(robot: Any, tasks: Any, told: str) -> None:
    with pytest.raises(sn.InputError, match=told):
        sn.studies.assess(robot, tasks)


def test_wrong_paths_are_refused() -> None:
    wrongs: list[Any] = [NEAR, [], "line"]
    refused_each("targets", wrongs, sn.studies.Follow)
    follow = sn.studies.Follow([NEAR], start=[[0.0, 0.0, 50.0]])
    refused("tasks['a'].start", lambda: sn.studies.assess(ROBOT, {"a": follow}))


DRAWN = sn.Robot.uniform(3, length=(45, 70), max_bend=1.5, radius=4, tendons=sn.Tendons(3, radius=4))


def test_every_combination_is_there_in_order() -> None:
    robots = sn.studies.sweep(DRAWN, {"segments.count": [2, 5], "radius": [1, 2.5]})
    assert list(robots) == [f"segments.count={n}, radius={r}" for n in (2, 5) for r in (1, 2.5)]
    assert [(len(robot), robot.radii[0]) for robot in robots.values()] == [(2, 1.0), (2, 2.5), (5, 1.0), (5, 2.5)]


@pytest.mark.parametrize(
    ("field", "value", "changed"),
    [
        ("segments.length", [30, 40], lambda r: r.segments[2].length == (30.0, 40.0)),
        ("segments[1].max_bend", 0.5, lambda r: [s.max_bend for s in r.segments] == [1.5, 0.5, 1.5]),
        ("segments.tendons.displacement", [-5, 5], lambda r: r.actuators[8].limits == (-5.0, 5.0)),
        ("mount", 20, lambda r: r.mount == 20.0),
        ("base", {"position": [1, 2, 3]}, lambda r: r.base[0, 3] == 1.0),
        ("self_collision", "allow", lambda r: not r.avoids_itself),
        ("radius", 2, lambda r: set(r.radii) == {2.0}),
    ],
)
def test_any_field_of_the_robot_file(field: str, value: Any, changed: Any) -> None:
    (robot,) = sn.studies.sweep(DRAWN, {field: [value]}).values()
    assert changed(robot)
    assert not changed(DRAWN)


def test_its_own_value_changes_nothing() -> None:
    (robot,) = sn.studies.sweep(DRAWN, {"segments.max_bend": [1.5]}).values()
    assert robot.equals(DRAWN)


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"colour": ["red"]}, "colour"),
        ({"segments": [3]}, "names no field"),
        ({"segments[7].length": [3]}, "there is no such segment"),
        ({"segments.chambers.length": [3]}, "this robot has no chambers"),
        ({"segments.length": [-1]}, "length"),
        ({"radius": 3}, "a list of values"),
        ({"radius": []}, "make 0 robots"),
        ({}, "a mapping of fields"),
    ],
)
def test_wrong_fields_are_refused(fields: Any, told: str) -> None:
    with pytest.raises(sn.InputError, match=told):
        sn.studies.sweep(DRAWN, fields)
