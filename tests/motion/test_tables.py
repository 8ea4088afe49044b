"""Configurations and actuators as a table: all numbers, under their names."""

import csv
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.answer.solutions import column_names
from tests.helpers import refused

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


def test_a_motion_without_knots_is_a_table_without_rows(tmp_path: Path) -> None:
    robot = sn.Robot.uniform(2, 1.0)
    nothing = sn.track(robot, [sn.Target((0.0, 0.0, 9.0))])
    assert len(nothing.q) == 0
    nothing.to_csv(tmp_path / "none.csv")
    assert len((tmp_path / "none.csv").read_text().splitlines()) == 1


def test_a_file_that_cannot_be_written_is_named(track: sn.Motion, tmp_path: Path) -> None:
    refused("file", lambda: track.to_csv(tmp_path), "cannot be written")
