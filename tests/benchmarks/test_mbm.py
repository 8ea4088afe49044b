"""Problems of MotionBenchMaker: read as they stand, planned, and judged by code that knows nothing of the planner."""

import gzip
import json
from pathlib import Path
from typing import Any

import pytest

import sinuous as sn
from benchmarks import mbm
from benchmarks.__main__ import main

READY = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
TURNED = [1.2, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]

POST = {"name": "post", "type": "cylinder", "dimensions": [1.2, 0.06], "position": [0.25, 0.17, 0.6]}
SHELF = {"name": "shelf", "type": "box", "dimensions": [0.2, 0.2, 0.1], "position": [0.6, 0.0, 0.1]}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    obstacles = [{**each, "quaternion_xyzw": [0, 0, 0, 1]} for each in (POST, SHELF)]
    problem = {"problem": 7, "obstacles": obstacles, "start": READY, "goal": TURNED}
    with gzip.open(tmp_path / "post.jsonl.gz", "wt", encoding="utf-8") as file:
        file.write(json.dumps(problem) + "\n")
    return tmp_path


def test_problems_are_planned_and_judged(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mbm", str(folder), "--quick", "--out", str(folder / "out"), "--record", str(folder)]) == 0
    text = capsys.readouterr().out
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines() if line.startswith("| ")]
    assert [(row[1], row[5]) for row in rows if "/" in row[5]] == [("post", "1/1"), ("all", "1/1")]
    assert (folder / "mbm.txt").read_text() == f"# mbm\n\n{text}"


def test_a_plan_through_an_obstacle_is_found_out(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def blind(robot: sn.Robot, start: sn.Solution, goal: sn.Target, _scene: sn.Scene, **options: Any) -> sn.Motion:
        return sn.Planner(robot, **options).plan(start, goal)

    monkeypatch.setattr(sn, "plan", blind)
    (problem,) = mbm.read_scenarios(folder)["post"]
    assert mbm.examine("continuum", 0, problem).trial.wrong == "overlap"
    assert main(["mbm", str(folder), "--quick", "--out", str(folder / "out")]) == 1


def test_the_panda_itself_is_planned_and_judged(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mbm", str(folder), "--robot", "panda", "--quick", "--out", str(folder / "out")]) == 0
    assert "panda" in capsys.readouterr().out
