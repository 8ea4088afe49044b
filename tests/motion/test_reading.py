"""Motions that are read from any of the files that we write are those that were written; others are refused."""

import json
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import refused

ROBOT = sn.Robot(
    [
        sn.Segment((0, 60), max_bend=0, name="feed", stage=sn.Stage(gain=40.0, unit="steps")),
        sn.Segment(80, max_bend=2.0, name="arm", tendons=sn.Tendons(count=3, radius=5)),
    ],
    radius=3,
)
BALL = sn.Sphere((60, 0, 60), radius=10, name="ball")
Q = np.array([[[0, 0, 10], [0, 0.2, 80]], [[0, 0, 30], [0.3, 0.5, 80]], [[0, 0, 50], [-0.4, 0.1, 80]]], float)
TIMES = np.array([0.0, 0.5, 2.0])


def motion() -> sn.Motion:
    return sn.Motion(ROBOT, Q, [BALL], TIMES)


def test_every_file_that_is_written_is_read(tmp_path: Path) -> None:
    written = motion()
    written.save(tmp_path / "own.json")
    written.save(tmp_path / "own.yaml")
    written.to_csv(tmp_path / "rows.csv")
    written.to_npz(tmp_path / "rows.npz")
    written.to_ros(tmp_path / "joints.json", joints_per_segment=3)
    written.to_ros(tmp_path / "motors.json", of="actuators")
    (tmp_path / "result.json").write_text(json.dumps(written.to_dict()), encoding="utf-8")
    for name in ("own.json", "own.yaml"):
        assert sn.Motion.load(tmp_path / name).equals(written)
    for name in ("rows.csv", "rows.npz", "joints.json", "motors.json", "result.json"):
        found = sn.Motion.load(tmp_path / name, ROBOT, [BALL])
        np.testing.assert_allclose(found.q, Q, atol=1e-9, err_msg=name)
        np.testing.assert_allclose(found.times, TIMES, atol=1e-9)
        assert found.status == written.status


def test_a_table_of_motor_values_is_read_by_their_names(tmp_path: Path) -> None:
    values = ROBOT.to_actuators(Q)
    names = [actuator.name for actuator in ROBOT.actuators]
    order = [2, 0, 3, 1]
    rows = ["; ".join(["t", *(names[k] for k in order)])]
    rows += [
        "; ".join(repr(float(each)) for each in (time, *row[order])) for time, row in zip(TIMES, values, strict=True)
    ]
    (tmp_path / "motors.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    np.testing.assert_allclose(sn.Motion.load(tmp_path / "motors.csv", ROBOT).q, Q, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", "time,feed.bend_x\n0,1\n", "columns: no column"),
        ("a.csv", "0,1,2\n3,4,5\n", "columns: no names"),
        ("a.json",
         '{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {"sec": 0, "nanosec": 1}}]}',
         "joint_names: of another robot"),
        ("a.json", '{"joint_names": ["a"], "points": []}', "points: "),
        ("a.json", "{", "file: no JSON"),
        ("a.json", "{}", "file: holds no motion"),
        ("a.glb", b"glTF\xff", r"not UTF-8 at byte 4; expected a motion in \.csv, .* JSON or YAML, got '.*a\.glb'"),
        ("a.json", b"\xff", r"not UTF-8 at byte 0; expected a motion"),
    ],
)  # fmt: skip
def test_other_files_are_refused(name: str, content: str | bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(sn.InputError, match=message):
        sn.Motion.load(tmp_path / name, ROBOT)


def test_the_robot_is_said_once(tmp_path: Path) -> None:
    own, rows = tmp_path / "own.json", tmp_path / "rows.csv"
    motion().save(own)
    motion().to_csv(rows)
    refused("robot", lambda: sn.Motion.load(own, ROBOT), "the file holds one", file=own)
    refused("robot", lambda: sn.Motion.load(rows), "missing", file=rows)


def test_joints_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    motion().to_ros(tmp_path / "joints.json", joints_per_segment=3)
    values = json.loads((tmp_path / "joints.json").read_text(encoding="utf-8"))
    values["points"][1]["positions"][2] += 0.1
    (tmp_path / "joints.json").write_text(json.dumps(values), encoding="utf-8")
    file = tmp_path / "joints.json"
    refused("positions", lambda: sn.Motion.load(file, ROBOT), "joints of one segment differ", file=file)


def test_columns_of_a_table_are_chosen_and_ordered(tmp_path: Path) -> None:
    motion().to_csv(tmp_path / "motors.csv", columns=["arm.t2", "feed", "feed.length"])
    head, *rows = (tmp_path / "motors.csv").read_text(encoding="utf-8").splitlines()
    assert head == "time,arm.t2,feed,feed.length"
    values = np.array([row.split(",") for row in rows], float)
    np.testing.assert_allclose(values[:, 2], 40.0 * values[:, 3])  # steps of the stage
    for wrong, key, words in (
        (["arm.t9"], "columns[0]", ""),
        (["feed", "feed"], "columns[1]", "given twice"),
        ("feed", "columns", "a list of names"),
    ):
        refused(key, lambda wrong=wrong: motion().to_csv(tmp_path / "motors.csv", columns=wrong), words)  # type: ignore[misc]


def test_rows_at_50_hz_keep_rates_and_accelerations_of_the_motors(tmp_path: Path) -> None:
    rates = sn.Rates(actuator=[400.0, 5.0, 5.0, 5.0], acceleration=sn.Rates(actuator=[900.0, 15.0, 15.0, 15.0]))
    names = [actuator.name for actuator in ROBOT.actuators]
    for blend in (0.0, 0.5):
        motion().timed(rates, blend).to_csv(tmp_path / "rows.csv", rate=50, columns=names)
        rows = np.genfromtxt(tmp_path / "rows.csv", delimiter=",", skip_header=1)
        steps = np.diff(rows[:, 0])
        assert np.allclose(steps[:-1], 0.02)
        speeds = np.diff(rows[:, 1:], axis=0) / steps[:, None]
        gains = np.diff(speeds, axis=0) / (0.5 * (steps[1:] + steps[:-1]))[:, None]
        assert (np.abs(speeds) <= np.array([400.0, 5.0, 5.0, 5.0]) * (1.0 + 1e-6)).all()
        assert (np.abs(gains) <= np.array([900.0, 15.0, 15.0, 15.0]) * (1.0 + 1e-6)).all()
        assert np.abs(speeds).max(axis=0).max() > 1.0
