"""The command check."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sinuous.cli.app import main
from tests.cli.test_solve import strict

Write = Callable[[str], str]


def test_it_says_what_files_contain(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    files = [problem("scene.yaml"), problem("path.yaml")]
    assert main(["check", *files]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{files[0]}: 3 segments, length 2.4 to 3.6; 1 obstacle; 1 waypoint",
        f"{files[1]}: 3 segments, length 2.4 to 3.6; 0 obstacles; 3 waypoints",
    ]
    assert main(["check", "--json", files[1]]) == 0
    contents = strict(capsys.readouterr().out)
    assert (contents["segments"], contents["obstacles"], contents["waypoints"]) == (3, 0, 3)


@pytest.mark.parametrize(
    ("start", "code", "said"), [("result.json", 0, "meets its target"), ("straight", 1, "is no answer")]
)
def test_a_start_is_verified(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path, start: str, code: int, said: str
) -> None:
    main(["solve", problem("scene.yaml"), "--out", str(tmp_path / "result.json")])
    capsys.readouterr()
    file = tmp_path / "started.yaml"
    value = "[[0, 0, 1], [0, 0, 1], [0, 0, 1]]" if start == "straight" else start
    file.write_text(Path(problem("scene.yaml")).read_text() + f"start: {value}\n")
    assert main(["check", str(file)]) == code
    assert said in capsys.readouterr().out
    assert main(["check", "--json", str(file)]) == code
    assert strict(capsys.readouterr().out)["start"]["ok"] is (code == 0)


def test_defects_of_meshes_are_listed(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("shell.yaml")
    defect = "sheet: 3 edges with one triangle only (holes), so it is used as a shell and not as a solid"
    assert main(["check", file]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines()[1:] == [f"  note: {defect}"]
    assert said.err == ""
    assert main(["check", "--json", file]) == 0
    assert strict(capsys.readouterr().out)["notes"] == [defect]


CURLED = """
robot:
  radius: 0.15
  segments: {count: 3, length: [0.8, 1.2], max_bend: 3}
target: {position: [0, 0, 1]}
tolerance: {position: 10, angle: 1}
start: [[2.7, 0.1, 1.0], [2.6, 0.0, 1.0], [2.6, 0.1, 1.0]]
"""


def test_a_start_that_runs_through_itself_is_no_answer(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "curled.yaml"
    file.write_text(CURLED)
    assert main(["check", str(file)]) == 1
    said = capsys.readouterr().out
    assert "start is no answer" in said
    assert "between segments 1 and" in said
    file.write_text(CURLED.replace("radius: 0.15", "radius: 0.15\n  self_collision: allow"))
    assert main(["check", str(file)]) == 0
    capsys.readouterr()
    file.write_text(CURLED.replace("radius: 0.15", "radius: 0.5"))
    assert main(["check", str(file)]) == 1
    assert "note: segments 1 to 3: a radius of 0.5 is above the smallest" in capsys.readouterr().out
    file.write_text(CURLED.replace("radius: 0.15", "self_collision: never"))
    assert main(["check", str(file)]) == 2
    assert "robot.self_collision: expected avoid or allow, got 'never'" in capsys.readouterr().err
