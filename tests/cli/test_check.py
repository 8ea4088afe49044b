"""The command check."""

import sys
from pathlib import Path

import pytest

from tests.cli.conftest import TARGET, Run

DEFECT = "sheet: 3 edges with one triangle only (holes), so it is used as a shell and not as a solid"


def test_it_says_what_files_contain(run: Run) -> None:
    assert run("check scene.yaml path.yaml shell.yaml").out.splitlines() == [
        "scene.yaml: 3 segments, length 2.4 to 3.6; 1 obstacle; 1 waypoint",
        "  robot: radius 0.05",
        "  ball: 0.4 x 0.4 x 0.4, 1.381 from the base",
        "  targets: 2.236 from the base",
        "path.yaml: 3 segments, length 2.4 to 3.6; 0 obstacles; 3 waypoints",
        "  robot: radius 0.05",
        "  targets: 2.236 to 2.245 from the base",
        "shell.yaml: 3 segments, length 2.4 to 3.6; 1 obstacle; 1 waypoint",
        "  robot: radius 0.05",
        "  sheet: 0.1 x 0.1 x 0, 9 from the base",
        "  targets: 2.236 from the base",
        f"  note: {DEFECT}",
    ]
    path, shell = run("check --json path.yaml shell.yaml").results
    assert (path["segments"], path["obstacles"], path["waypoints"]) == (3, 0, 3)
    assert (path["radius"], path["sizes"]) == ([0.05, 0.05], [])
    assert path["targets_from_base"] == pytest.approx([5**0.5, 5.04**0.5])
    assert shell["notes"] == [DEFECT]


def test_a_start_is_verified(run: Run) -> None:
    run("solve scene.yaml --out result.json")
    for start, code, said in (
        ("result.json", 0, "meets its target"),
        ("[[0, 0, 1], [0, 0, 1], [0, 0, 1]]", 1, "start is clear, a motion can begin there, but it is no answer: "),
    ):
        Path("started.yaml").write_text(Path("scene.yaml").read_text() + f"start: {start}\n")
        assert said in run("check started.yaml", code).out
        assert run("check --json started.yaml", code).results[0]["start"]["ok"] is (code == 0)


@pytest.mark.parametrize("json", ["", "--json"])
def test_a_file_that_is_wrong_does_not_hide_the_others(run: Run, monkeypatch: pytest.MonkeyPatch, json: str) -> None:
    """A mesh that needs a package which is not installed, for one; and none is forgiven by what follows it."""
    monkeypatch.setitem(sys.modules, "trimesh", None)
    said = run(f"check bad.yaml shell.yaml easy.yaml {json}", 2)
    (answered,) = (line for line in said.out.splitlines() if not line.startswith("  "))
    assert "easy.yaml" in answered
    bad, missing = said.err.splitlines()
    assert bad.startswith("bad.yaml: target.position: expected 3 finite numbers")
    assert missing.startswith("shell.yaml: ")
    assert "sinuous[mesh]" in missing


CURLED = """
robot:
  radius: 0.15
  segments: {count: 3, length: [0.8, 1.2], max_bend: 3}
target: {position: [0, 0, 1]}
tolerance: {position: 10, angle: 1}
start: [[2.7, 0.1, 1.0], [2.6, 0.0, 1.0], [2.6, 0.1, 1.0]]
"""


def test_a_start_that_runs_through_itself_is_no_answer(run: Run) -> None:
    for change, code, words in (
        ("radius: 0.15", 1, ("start is no answer", "between segments 1 and")),
        ("radius: 0.15\n  self_collision: allow", 0, ("start meets its target",)),
        ("radius: 0.5", 1, ("note: segments 1 to 3: a radius of 0.5 is above the smallest",)),
    ):
        Path("curled.yaml").write_text(CURLED.replace("radius: 0.15", change))
        said = run("check curled.yaml", code).out
        assert all(word in said for word in words)


def test_what_is_suspicious_is_a_note(run: Run) -> None:
    Path("degrees.yaml").write_text(
        "robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 90}}\n"
        "target: {position: [0, 0, 3]}\n"
        "scene: [{box: {center: [0, 0, -1], size: [4, 4, 2.1], name: floor}}]\n"
    )
    notes = [
        "max_bend of all segments is 90 rad, more than a full turn; is it in degrees?",
        "the base touches floor; where the robot stands on it or sits in it, say so with mount",
    ]
    assert run("check degrees.yaml").out.splitlines()[-2:] == [f"  note: {note}" for note in notes]
    assert run("solve degrees.yaml", 1).err.splitlines() == [f"note: degrees.yaml: {note}" for note in notes]


def test_actuators_at_the_start_are_said(run: Run) -> None:
    driven = "robot: {segments: {count: 2, length: 1, tendons: {count: 3, radius: 0.1}}}\n"
    Path("still.yaml").write_text(driven + "target: {position: [0.3, 0, 1.8]}\n")
    Path("driven.yaml").write_text(Path("still.yaml").read_text() + "start: [[1, 0, 1], [0, 0, 1]]\n")
    assert "actuators there: s1.t1=0.1  s1.t2=-0.05  " in run("check driven.yaml", 1).out
    started, still = run("check --json driven.yaml still.yaml", 1).results
    assert list(started["actuators"]) == [f"s{k}.t{j}" for k in (1, 2) for j in (1, 2, 3)]
    assert started["actuators"]["s2.t1"] == pytest.approx(0.1)
    assert still["actuators"] is None


def test_joints_are_listed(run: Run) -> None:
    joints = "[{prismatic: {limits: [0, 2], name: feed}}, {revolute: {limits: [-1, 1]}}]"
    start = "start: {joints: [1.0, 0.5], q: [[0, 0, 1]]}\n"
    Path("arm.yaml").write_text(f"robot: {{segments: {{length: 1, radius: 0.1}}, joints: {joints}}}\n{TARGET}{start}")
    said = run("check arm.yaml", 1).out.splitlines()
    assert said[:4] == [
        "arm.yaml: 1 segment, length 1; 0 obstacles; 1 waypoint",
        "  joint feed: prismatic, 0 to 2",
        "  joint j2: revolute, -1 to 1",
        "  robot: radius 0.1",
    ]
    (result,) = run("check --json arm.yaml", 1).results
    assert result["joints"] == [
        {"name": "feed", "kind": "prismatic", "limits": [0, 2]},
        {"name": "j2", "kind": "revolute", "limits": [-1, 1]},
    ]
    for old, new, refusal in (
        ("prismatic", "slider", "robot.joints[0].slider: unknown key"),
        ("[-1, 1]", "[1, -1]", "robot.joints[1].revolute.limits: lower limit above"),
        ("name: feed", "name: j2", "robot.joints[1].name: is that of joints[0].name already"),
        ("[1.0, 0.5]", "[1.0]", "start.joints: expected finite numbers of shape (..., 2)"),
    ):
        Path("bad.yaml").write_text(Path("arm.yaml").read_text().replace(old, new, 1))
        assert run("check bad.yaml", 2).err.startswith(f"bad.yaml: {refusal}")
