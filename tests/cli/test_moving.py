"""Obstacles that move, on the command line."""

import json
from functools import partial
from pathlib import Path

import pytest

from sinuous.cli.app import main
from sinuous.view.pictures import report
from sinuous.view.pictures.animate import animate

SCENE = """
robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 2.5}, radius: 0.05}
scene:
  - sphere: {center: [0, 0, 0], radius: 0.4, name: ball, moving: [[0, [0, 0, 2.2]], [2, [0, 0, 2.2]], [4, [0, 3, 2.2]]]}
"""
PLAN = f"{SCENE}start: [[0.6, 0, 1], [0.6, 0, 1], [0.6, 0, 1]]\ngoal: [[-0.6, 0, 1], [-0.6, 0, 1], [-0.6, 0, 1]]\n"
RATES = "rates: {bend: 0.8, length: 0.3}\n"


def written(folder: Path, text: str) -> str:
    file = folder / "problem.yaml"
    file.write_text(text)
    return str(file)


def test_plan_and_track_in_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "animate", partial(animate, seconds=0.5))
    assert main(["plan", written(tmp_path, PLAN + RATES), "--json", "--plot", str(tmp_path / "way.html")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["between"] == "proved"
    assert 1.5 < answer["times"][-1] < 4.0
    assert (tmp_path / "way.html").stat().st_size > 1000
    assert main(["plan", written(tmp_path, PLAN), "--duration", "5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["times"][-1] == 5.0
    path = "path: [{position: [1.2, 0.5, 1.8]}, {position: [0.6, 0.5, 1.9]}]\ntimes: [1, 3]\n"
    assert main(["check", written(tmp_path, PLAN + RATES)]) == 0
    assert "ball" in capsys.readouterr().out
    assert main(["track", written(tmp_path, SCENE + path), "--json", "--plot", str(tmp_path / "way.gif")]) == 0
    assert json.loads(capsys.readouterr().out)["times"][-1] == 3.0


@pytest.mark.parametrize(
    ("command", "text", "said"),
    [
        (["plan"], PLAN, "rates: expected rates, or the duration"),
        (["plan", "--duration", "0"], PLAN, "--duration: expected a number greater than 0"),
        (["plan"], PLAN + "rates: {bend: 1, acceleration: {bend: [1, 2]}}\n", "rates.acceleration.bend"),
        (
            ["solve"],
            SCENE + "target: {position: [1, 0, 2]}\n",
            "scene: expected obstacles that stand still, or track or plan",
        ),
        (["plan", "--begin", "nan"], PLAN + RATES, "--begin: expected a finite number"),
    ],
)
def test_what_is_missing_is_said_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str], text: str, said: str
) -> None:
    assert main([command[0], written(tmp_path, text), *command[1:]]) == 2
    error = capsys.readouterr().err.strip()
    assert said in error
    assert len(error.splitlines()) == 1
    if len(command) == 1:
        assert "problem.yaml" in error
