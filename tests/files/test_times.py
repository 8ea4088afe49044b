"""Times of waypoints, in problem files and beside them."""

from pathlib import Path

import pytest

from sinuous.base.errors import InputError
from sinuous.files.problem_file import read_problem

ROBOT = "robot: {segments: {count: 2, length: [1, 2]}}\n"
LISTED = ROBOT + "path: [{position: [0, 0, 3]}, {position: [0, 0.1, 3]}]\n"


def write(folder: Path, text: str, name: str = "problem.yaml") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def test_they_stand_in_the_file_or_in_the_table_of_the_path(tmp_path: Path) -> None:
    write(tmp_path, "t,x,y,z\n0,0,0,3\n2.5,0,0.1,3\n", "tips.csv")
    listed = read_problem(write(tmp_path, LISTED + "times: [0, 2.5]\n"))
    table = read_problem(write(tmp_path, ROBOT + "path: tips.csv\n"))
    for problem in (listed, table):
        assert problem.times is not None
        assert problem.times.tolist() == [0.0, 2.5]
    assert listed.equals(table)
    assert read_problem(write(tmp_path, LISTED)).times is None


def test_they_are_saved(tmp_path: Path) -> None:
    problem = read_problem(write(tmp_path, LISTED + "times: [0, 2.5]\n"))
    problem.save(tmp_path / "again.yaml")
    assert read_problem(tmp_path / "again.yaml").equals(problem)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (LISTED + "times: [1, 1]\n", r"times\[1\]: expected more than 1, got 1.0 \(times must increase\)"),
        (LISTED + "times: [1]\n", "times: expected 2 finite numbers"),
        (ROBOT + "target: {position: [0, 0, 3]}\ntimes: [1]\n", "times: expected those of a path"),
        (ROBOT + "path: tips.csv\ntimes: [0, 1]\n", "times: expected one of both"),
    ],
)
def test_what_are_no_times_is_refused(tmp_path: Path, text: str, message: str) -> None:
    write(tmp_path, "t,x,y,z\n0,0,0,3\n2.5,0,0.1,3\n", "tips.csv")
    with pytest.raises(InputError, match=message):
        read_problem(write(tmp_path, text))
