"""The command check."""

import sys
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
        "  robot: radius 0.05",
        "  ball: 0.4 x 0.4 x 0.4, 1.381 from the base",
        "  targets: 2.236 from the base",
        f"{files[1]}: 3 segments, length 2.4 to 3.6; 0 obstacles; 3 waypoints",
        "  robot: radius 0.05",
        "  targets: 2.236 to 2.245 from the base",
    ]
    assert main(["check", "--json", files[1]]) == 0
    contents = strict(capsys.readouterr().out)
    assert (contents["segments"], contents["obstacles"], contents["waypoints"]) == (3, 0, 3)
    assert (contents["radius"], contents["sizes"]) == ([0.05, 0.05], [])
    assert contents["targets_from_base"] == pytest.approx([5**0.5, 5.04**0.5])


@pytest.mark.parametrize(
    ("start", "code", "said"),
    [
        ("result.json", 0, "meets its target"),
        ("straight", 1, "start is clear, a motion can begin there, but it is no answer: position error "),
    ],
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
    assert said.out.splitlines()[-1] == f"  note: {defect}"
    assert said.err == ""
    assert main(["check", "--json", file]) == 0
    assert strict(capsys.readouterr().out)["notes"] == [defect]


@pytest.mark.parametrize("json", [[], ["--json"]])
def test_a_file_that_is_wrong_does_not_hide_the_others(
    capsys: pytest.CaptureFixture[str], problem: Write, monkeypatch: pytest.MonkeyPatch, json: list[str]
) -> None:
    """A mesh that needs a package which is not installed, for one; and none is forgiven by what follows it."""
    monkeypatch.setitem(sys.modules, "trimesh", None)
    files = [problem("bad.yaml"), problem("shell.yaml"), problem("easy.yaml")]
    assert main(["check", *files, *json]) == 2
    said = capsys.readouterr()
    answered = [line for line in said.out.splitlines() if not line.startswith("  ")]
    assert len(answered) == 1
    assert files[2] in answered[0]
    bad, missing = said.err.splitlines()
    assert bad.startswith(f"{files[0]}: target.position: expected 3 finite numbers")
    assert missing.startswith(f"{files[1]}: ")
    assert "sinuous[mesh]" in missing


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


def test_many_obstacles_are_counted(capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path) -> None:
    ball = "{{sphere: {{center: [{}, 5, 5], radius: 1}}}}"
    file = tmp_path / "many.yaml"
    file.write_text(
        Path(problem("easy.yaml")).read_text() + f"scene: [{', '.join(ball.format(i) for i in range(20))}]\n"
    )
    assert main(["check", str(file)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "  and 8 more obstacles" in said
    assert len(said) == 16


def test_what_is_suspicious_is_a_note(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "degrees.yaml"
    file.write_text(
        "robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 90}}\n"
        "target: {position: [0, 0, 3]}\n"
        "scene: [{box: {center: [0, 0, -1], size: [4, 4, 2.1], name: floor}}]\n"
    )
    notes = [
        "max_bend of all segments is 90 rad, more than a full turn; is it in degrees?",
        "the base touches floor; where the robot stands on it or sits in it, say so with mount",
    ]
    assert main(["check", str(file)]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == [f"  note: {note}" for note in notes]
    assert main(["solve", str(file)]) == 1
    assert capsys.readouterr().err.splitlines() == [f"note: {file}: {note}" for note in notes]


def test_actuators_at_the_start_are_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "driven.yaml"
    robot = "robot: {segments: {count: 2, length: 1, tendons: {count: 3, radius: 0.1}}}\n"
    file.write_text(robot + "target: {position: [0.3, 0, 1.8]}\nstart: [[1, 0, 1], [0, 0, 1]]\n")
    assert main(["check", str(file)]) == 1
    assert "actuators there: s1.t1=0.1  s1.t2=-0.05  " in capsys.readouterr().out
    assert main(["check", "--json", str(file)]) == 1
    values = strict(capsys.readouterr().out)["actuators"]
    assert list(values) == [f"s{k}.t{j}" for k in (1, 2) for j in (1, 2, 3)]
    assert values["s2.t1"] == pytest.approx(0.1)
    file.write_text(robot + "target: {position: [0.3, 0, 1.8]}\n")
    assert main(["check", "--json", str(file)]) == 0
    assert strict(capsys.readouterr().out)["actuators"] is None
