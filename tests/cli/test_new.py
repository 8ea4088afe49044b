"""The command new."""

import json
from pathlib import Path

import numpy as np
import pytest

from sinuous.answer.verification import verify
from sinuous.cli import app
from sinuous.cli.app import main
from sinuous.files.problem_file import read_problem
from sinuous.problem.problem import Problem

TEMPLATES = Path(app.__file__).parent / "templates"


def test_there_is_one_template_of_each_kind() -> None:
    assert {file.stem for file in TEMPLATES.iterdir()} == set(app.KINDS)


@pytest.mark.parametrize("kind", app.KINDS)
def test_what_is_written_solves_and_is_proved(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """With the command that it says, and by the independent verification."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", kind, "my arm.yaml"]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"my arm.yaml: {app.KINDS[kind]}; next: sinuous ")
    command = "track" if "sinuous track" in said else "solve"
    text = Path("my arm.yaml").read_text(encoding="utf-8")
    assert f"#     sinuous {command} 'my arm.yaml'" in text
    assert text.count("#") > 8
    assert main([command, "my arm.yaml", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (result["status"], result["clearance"] >= 0.0) == ("solved", True)
    asked = read_problem("my arm.yaml")
    assert asked.notes == ()
    for waypoint, found in zip(asked.waypoints, result.get("waypoints", [result]), strict=True):
        assert verify(Problem(asked.robot, waypoint, asked.scene, asked.tolerance), np.array(found["q"])).ok


def test_a_file_that_is_there_stays_unless_it_is_forced(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text("mine\n")
    assert main(["new", "tendon", str(file)]) == 2
    said = capsys.readouterr()
    assert said.err == f"FILE: expected a new file, or --force, got '{file}' (is there already)\n" or "..." in said.err
    assert file.read_text() == "mine\n"
    assert main(["new", "tendon", str(file), "--force"]) == 0
    assert "robot:" in file.read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["robot", "arm.yaml"], "KIND: expected one of tendon, pneumatic, insertion, inspection, got 'robot'"),
        (["tendon", "nowhere/arm.yaml"], "FILE: expected a file that can be written, got 'nowhere/arm.yaml'"),
        (["tendon", "arm.json"], "FILE: expected a name that ends in .yaml, got 'arm.json'"),
        (["tendon", ".", "--force"], "FILE: expected a new file, or --force, got '.'"),
    ],
)
def test_what_cannot_be_written_is_refused(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(said)
    assert list(tmp_path.iterdir()) == []
