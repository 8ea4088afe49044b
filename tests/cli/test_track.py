"""The command track."""

from functools import partial
from pathlib import Path
from typing import Any

import pytest

import sinuous as sn
from sinuous.motion import motion as motion_module
from sinuous.motion.resampling import lines_between
from sinuous.motion.tracker import Tracker
from sinuous.solver.certificates.steps import Steps
from tests.cli.conftest import ROBOT, Run
from tests.cli.test_solve import KEYS, OWN


def test_json_has_totals_and_waypoints(run: Run) -> None:
    whole, half, single = run("track --json path.yaml half.yaml easy.yaml", 1).results
    assert [whole["status"], half["status"], single["status"]] == ["solved", "out_of_reach", "solved"]
    assert [track["between"] for track in (whole, half, single)] == ["proved", "proved", "proved"]
    assert [track["unproved_steps"] for track in (whole, half, single)] == [[], [], []]
    assert [len(track["waypoints"]) for track in (whole, half, single)] == [3, 3, 1]
    assert all(list(waypoint) == OWN for waypoint in whole["waypoints"])
    totals = [key for key in KEYS if key not in ("q", "actuators", "tensions", "uncertainty", "start", "route_class")]
    assert [key for key in whole if key in KEYS] == totals
    assert whole["seconds"] > sum(waypoint["seconds"] for waypoint in whole["waypoints"])
    assert half["worst"] == half["waypoints"][1]["worst"]


def test_an_interrupt_keeps_the_waypoints_so_far(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    go_on = Tracker.go_to
    tried: list[object] = []

    def interrupted(self: Tracker, targets: Any) -> sn.Solution:
        if len(tried) == 2:
            raise KeyboardInterrupt
        tried.append(targets)
        return go_on(self, targets)

    monkeypatch.setattr(Tracker, "go_to", interrupted)
    said = run("track path.yaml easy.yaml --json", 130)
    (track,) = said.results
    assert (len(track["waypoints"]), track["remaining"], track["status"]) == (2, 1, "time_limit")
    kept = "sinuous: interrupted after 0 of 2 files, with 2 of 3 waypoints of path.yaml"
    assert said.err.splitlines()[-1] == f"{kept}; the results so far are written"


def table(file: str) -> list[list[str]]:
    return [line.split(",") for line in Path(file).read_text(encoding="utf-8").splitlines()]


def test_configurations_and_actuators_are_a_table(run: Run) -> None:
    text = Path("path.yaml").read_text().replace("max_bend: 2", "max_bend: 2, tendons: {count: 3, radius: 0.1}")
    Path("driven.yaml").write_text(text)
    run("track driven.yaml --csv motors.csv")
    header, *rows = table("motors.csv")
    assert header[:2] == ["time", "s1.bend_x"]
    assert header[-3:] == ["s3.t1", "s3.t2", "s3.t3"]
    assert [row[0] for row in rows] == ["0.0", "1.0", "2.0"]
    assert {len(row) for row in rows} == {1 + 9 + 9}
    at = [header.index(name) for name in ("s3.t2", "s1.length")]
    run("track driven.yaml --csv own.csv --columns s3.t2,s1.length")
    assert table("own.csv") == [["time", "s3.t2", "s1.length"], *([row[0], *(row[k] for k in at)] for row in rows)]
    run("solve easy.yaml --csv own.csv --columns s2.length,s1.length")
    assert table("own.csv")[0] == ["solution", "status", "s2.length", "s1.length"]
    said = run("solve easy.yaml --csv own.csv --columns s9", 2).err
    assert "easy.yaml: --columns[0]: expected one of s1.bend_x" in said
    assert "--columns: is for --csv" in run("solve easy.yaml --columns s1.length", 2).err


def test_a_table_has_a_row_for_each_sample_and_lines_that_are_not_proved_are_noted(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    run("track path.yaml --csv q.csv --rate 10")
    assert [float(row[0]) for row in table("q.csv")[1:]] == pytest.approx([0.1 * i for i in range(21)])

    def unproved(*asked: Any) -> Steps:
        return Steps.told(len(lines_between(*asked).proved), (1,), None, None)

    monkeypatch.setattr(motion_module, "lines_between", unproved)
    said = run("track path.yaml --csv q.csv --rate 10").err
    assert "note: q.csv: rate: 1 of 20 lines between rows are not proved clear" in said


def test_tables_of_several_files_are_numbered(run: Run) -> None:
    run("track easy.yaml half.yaml --deviation 1 --csv q.csv", 1)
    assert [len(table(f"q-{i}.csv")) for i in (1, 2)] == [2, 3]
    assert not Path("q.csv").exists()


def test_a_path_that_the_tip_leaves_is_not_solved(run: Run) -> None:
    text = ROBOT + "scene: [{sphere: {center: [0, 0, 2], radius: 0.3}}]\n"
    text += "path: [{position: [1, 0, 2]}, {position: [-1, 0, 2]}]\n"
    Path("across.yaml").write_text(text)
    Path("allowed.yaml").write_text(text + "reconfigure: allow\n")
    said = run("track across.yaml", 1).out
    assert said.startswith("across.yaml: left_path (2 of 2 waypoints reached; in step")
    (found,) = run("track across.yaml --json --csv rows.csv", 1).results
    assert (found["status"], found["reconfigured"]) == ("left_path", [2])
    assert found["left_steps"]
    assert found["largest_deviation"]["position"] > 0.2
    for typed in ("across.yaml --reconfigure allow", "allowed.yaml"):
        (allowed,) = run(f"track {typed} --json").results
        assert (allowed["status"], allowed["knots"]) == ("solved", found["knots"])
        assert allowed["left_steps"] == found["left_steps"]
    run("track allowed.yaml --reconfigure refuse", 1)
    assert "--reconfigure: expected refuse or allow" in run("track path.yaml --reconfigure no", 2).err


@pytest.mark.parametrize("name", ["path.yaml", "far.yaml"])
def test_pictures_of_motions_solved_or_not(run: Run, name: str) -> None:
    pytest.importorskip("matplotlib")
    run(f"track {name} --plot motion.png", int(name == "far.yaml"))
    assert Path("motion.png").stat().st_size > 10_000


def test_a_path_moves(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    from PIL import Image

    from sinuous.view.pictures import reports

    monkeypatch.setattr(reports, "animate", partial(sn.view.animate, seconds=0.4))
    run("track path.yaml --plot motion.gif")
    with Image.open("motion.gif") as image:
        assert image.n_frames == 6  # type: ignore[attr-defined]
