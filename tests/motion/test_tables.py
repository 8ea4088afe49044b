"""Configurations and actuators as a table: all numbers, under their names."""

import csv
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.solutions import column_names

ROBOT = sn.Robot(
    [
        sn.Segment((0.0, 0.5), 0.0, name="stage"),
        sn.Segment(1.0, 2.0, tendons=sn.Tendons(3, 0.1)),
        sn.Segment((0.8, 1.2), 2.0, chambers=sn.Chambers(3, 0.1, names=["up", "left", "a, b"])),
    ],
    actuators=sn.Actuators([[0, 0, 1, 0, 0, 0, 0, 0, 0]], names=["feed"]),
)
PATH = [sn.Target((0.1 * i, 0.5, 1.8)) for i in range(3)]


@pytest.fixture(scope="module")
def track() -> sn.Motion:
    return sn.track(ROBOT, [*PATH, sn.Target((0.0, 0.0, 9.0))])


def test_it_holds_every_number_to_the_last_digit(track: sn.Motion, tmp_path: Path) -> None:
    track.to_csv(tmp_path / "motors.csv")
    with (tmp_path / "motors.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time", *column_names(ROBOT)]
    assert [row["time"] for row in rows] == ["0.0", "1.0", "2.0"]
    for row, solution in zip(rows, track.solutions[:3], strict=True):
        assert solution.actuators is not None
        assert {name: float(row[name]) for name in solution.actuators} == pytest.approx(solution.actuators, abs=1e-15)
        assert [float(row[name]) for name in column_names(ROBOT)[:9]] == solution.q.ravel().tolist()


def test_a_motor_and_a_joint_of_one_name_have_each_their_own_column(tmp_path: Path) -> None:
    """Before, the column of the motor had the value of the joint."""
    drive = sn.Actuators([[1, 0, 0, 0]], names=["roll"], gain=100, offset=5)
    robot = sn.Robot([sn.Segment(1.0, 2.0)], joints=[sn.Revolute(name="roll")], actuators=drive)
    solutions = sn.Solver(robot).solve_many(positions=[[0.0, 0.0, 1.0]])
    motion = sn.Motion(robot, [([0.1], [[0.0, 0.0, 1.0]]), ([0.2], [[0.0, 0.0, 1.0]])])
    motion.to_csv(tmp_path / "all.csv")
    motion.to_csv(tmp_path / "one.csv", columns=["roll.motor"])
    solutions.to_csv(tmp_path / "motors.csv")
    tables = {each.stem: list(csv.reader(each.read_text().splitlines())) for each in tmp_path.iterdir()}
    assert tables["all"][0] == ["time", "roll", "s1.bend_x", "s1.bend_y", "s1.length", "roll.motor"]
    assert [[float(row[1]), float(row[-1])] for row in tables["all"][1:]] == [[0.1, 15.0], [0.2, 25.0]]
    assert [float(row[-1]) for row in tables["one"][1:]] == [15.0, 25.0]
    assert tables["motors"][0] == ["target", "status", "roll.motor"]
    assert float(tables["motors"][1][-1]) == pytest.approx(100.0 * float(solutions[0].joints[0]) + 5.0)
    for name in ("all.csv", "one.csv"):
        np.testing.assert_allclose(sn.Motion.load(tmp_path / name, robot).joints, [[0.1], [0.2]], atol=1e-15)
