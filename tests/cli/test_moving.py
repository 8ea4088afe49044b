"""Obstacles that move, on the command line."""

from pathlib import Path

from tests.cli.conftest import Run

SCENE = """
robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 2.5}, radius: 0.05}
scene:
  - sphere: {center: [0, 0, 0], radius: 0.4, name: ball, moving: [[0, [0, 0, 2.2]], [2, [0, 0, 2.2]], [4, [0, 3, 2.2]]]}
"""
PLAN = f"{SCENE}start: [[0.6, 0, 1], [0.6, 0, 1], [0.6, 0, 1]]\ngoal: [[-0.6, 0, 1], [-0.6, 0, 1], [-0.6, 0, 1]]\n"
TRACK = f"{SCENE}path: [{{position: [1.2, 0.5, 1.8]}}, {{position: [0.6, 0.5, 1.9]}}]\ntimes: [1, 3]\n"


def test_plan_and_track_in_time(run: Run) -> None:
    Path("rates.yaml").write_text(f"{PLAN}rates: {{bend: 0.8, length: 0.3}}\n")
    Path("plan.yaml").write_text(PLAN)
    Path("track.yaml").write_text(TRACK)
    (answer,) = run("plan rates.yaml --json --plot way.html").results
    assert answer["between"] == "proved"
    assert 1.5 < answer["times"][-1] < 4.0
    assert Path("way.html").stat().st_size > 1000
    assert run("plan plan.yaml --duration 5 --json").results[0]["times"][-1] == 5.0
    assert "ball" in run("check rates.yaml").out
    assert run("track track.yaml --json").results[0]["times"][-1] == 3.0
