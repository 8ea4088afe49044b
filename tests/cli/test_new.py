"""The command new."""

from pathlib import Path

import numpy as np
import pytest

from sinuous.answer.verification import verify
from sinuous.cli import app
from sinuous.cli.app import main
from sinuous.motion.job import read_problem
from sinuous.problem.problem import Problem
from tests.cli.conftest import Run

TEMPLATES = Path(app.__file__).parent / "templates"


def test_there_is_one_template_of_each_kind() -> None:
    assert {file.stem for file in TEMPLATES.iterdir()} == set(app.KINDS)


@pytest.mark.parametrize("kind", app.KINDS)
def test_what_is_written_solves_and_is_proved(capsys: pytest.CaptureFixture[str], run: Run, kind: str) -> None:
    """With the command that it says, and by the independent verification."""
    assert main(["new", kind, "my arm.yaml"]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"my arm.yaml: {app.KINDS[kind]}; next: sinuous ")
    command = "track" if "sinuous track" in said else "solve"
    text = Path("my arm.yaml").read_text(encoding="utf-8")
    assert f"#     sinuous {command} 'my arm.yaml'" in text
    assert text.count("#") > 8
    run(f"new {kind} easy.yaml --force")  # over what is there
    (result,) = run(f"{command} easy.yaml --json").results
    assert (result["status"], result["clearance"] >= 0.0) == ("solved", True)
    asked = read_problem("my arm.yaml")
    assert asked.notes == ()
    for waypoint, found in zip(asked.waypoints, result.get("waypoints", [result]), strict=True):
        assert verify(Problem(asked.robot, waypoint, asked.scene, asked.tolerance), np.array(found["q"])).ok
