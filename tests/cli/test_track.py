"""The command track."""

import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import sinuous as sn
from sinuous.answer.solution import Solution
from sinuous.cli.app import main
from sinuous.motion import motion as motion_module
from sinuous.motion.resampling import lines_between
from sinuous.motion.tracker import Tracker
from sinuous.solver.certificates.steps import Steps
from tests.cli.conftest import ROBOT
from tests.cli.test_solve import KEYS, strict

Write = Callable[[str], str]


def test_json_has_totals_and_waypoints(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    files = [problem("path.yaml"), problem("half.yaml"), problem("easy.yaml")]
    assert main(["track", "--json", *files]) == 1
    whole, half, single = (strict(line) for line in capsys.readouterr().out.splitlines())
    assert [whole["status"], half["status"], single["status"]] == ["solved", "out_of_reach", "solved"]
    assert [track["between"] for track in (whole, half, single)] == ["proved", "proved", "proved"]
    assert [track["unproved_steps"] for track in (whole, half, single)] == [[], [], []]
    assert [len(track["waypoints"]) for track in (whole, half, single)] == [3, 3, 1]
    own = [key for key in KEYS if key not in ("file", "prepare_seconds")]
    assert all(list(waypoint) == own for waypoint in whole["waypoints"])
    totals = [key for key in KEYS if key not in ("q", "actuators", "tensions", "uncertainty", "start", "route_class")]
    assert [key for key in whole if key in KEYS] == totals
    assert whole["seconds"] > sum(waypoint["seconds"] for waypoint in whole["waypoints"])
    assert half["worst"] == half["waypoints"][1]["worst"]


def test_the_text_counts(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("half.yaml")
    assert main(["track", file]) == 1
    assert capsys.readouterr().out.startswith(f"{file}: out_of_reach (2 of 3 waypoints reached; waypoint 2: ")


def test_results_are_made_where_somebody_wants_them(
    problem: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a long path they are more work than solving it."""
    made: list[object] = []
    plainly = sn.Motion.to_dict

    def to_dict(self: sn.Motion) -> dict[str, Any]:
        made.append(self)
        return plainly(self)

    monkeypatch.setattr(sn.Motion, "to_dict", to_dict)
    for options, count in (([], 0), (["--json"], 1), (["--out", str(tmp_path / "track.jsonl")], 1)):
        made.clear()
        assert main(["track", problem("path.yaml"), *options]) == 0
        assert len(made) == count


def test_an_interrupt_keeps_the_waypoints_so_far(
    capsys: pytest.CaptureFixture[str], problem: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    go_on = Tracker.go_to
    tried: list[object] = []

    def interrupted(self: Tracker, targets: Any) -> Solution:
        if len(tried) == 2:
            raise KeyboardInterrupt
        tried.append(targets)
        return go_on(self, targets)

    monkeypatch.setattr(Tracker, "go_to", interrupted)
    assert main(["track", problem("path.yaml"), problem("easy.yaml"), "--json"]) == 130
    captured = capsys.readouterr()
    track = strict(captured.out)
    assert (len(track["waypoints"]), track["remaining"], track["status"]) == (2, 1, "time_limit")
    assert captured.err.splitlines()[-1] == "sinuous: interrupted after 0 of 2 files; the results so far are written"


TELLING = """
import sys
from sinuous.cli.app import main
from sinuous.motion.tracker import Tracker
go_on = Tracker.go_to
def telling(self, targets):
    answer = go_on(self, targets)
    print("reached", file=sys.stderr, flush=True)
    return answer
Tracker.go_to = telling
sys.exit(main(sys.argv[1:]))
"""
"""The command line, which says when a waypoint is behind it."""


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a process alone")
def test_a_real_interrupt(problem: Write, tmp_path: Path) -> None:
    """Two places at once cannot be met and this is not proved, so that every waypoint tries all its starts."""
    endless = tmp_path / "endless.yaml"
    torn = "  - [{position: [1, 0, 2]}, {position: [-1, 0, 2]}]\n"
    endless.write_text(ROBOT + "path:\n" + torn * 500)
    out = tmp_path / "results.jsonl"
    command = [sys.executable, "-c", TELLING, "track", problem("easy.yaml"), str(endless), "--json", "--out", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        first = process.stdout.readline()
        assert [process.stderr.readline() for _ in range(2)] == ["reached\n"] * 2  # one of each file
        process.send_signal(signal.SIGINT)
        rest, err = process.communicate(timeout=300)
    assert process.returncode == 130
    assert strict(first)["status"] == "solved"
    assert strict(rest)["remaining"] > 0
    assert out.read_text() == first + rest
    told = "sinuous: interrupted after 1 of 2 files; the results so far are written, the same command goes on\n"
    assert err.endswith(told)
    assert "Traceback" not in err


def table(file: Path) -> list[list[str]]:
    return [line.split(",") for line in file.read_text(encoding="utf-8").splitlines()]


def test_configurations_and_actuators_are_a_table(problem: Write, tmp_path: Path) -> None:
    file = Path(problem("path.yaml"))
    text = file.read_text().replace("max_bend: 2", "max_bend: 2, tendons: {count: 3, radius: 0.1}")
    file.write_text(text)
    assert main(["track", str(file), "--csv", str(tmp_path / "motors.csv")]) == 0
    header, *rows = table(tmp_path / "motors.csv")
    assert header[:2] == ["time", "s1.bend_x"]
    assert header[-3:] == ["s3.t1", "s3.t2", "s3.t3"]
    assert [row[0] for row in rows] == ["0.0", "1.0", "2.0"]
    assert {len(row) for row in rows} == {1 + 9 + 9}


def test_a_table_has_a_row_for_each_sample(problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = problem("path.yaml"), tmp_path / "q.csv"
    assert main(["track", file, "--csv", str(out), "--rate", "10"]) == 0
    assert [float(row[0]) for row in table(out)[1:]] == pytest.approx([0.1 * i for i in range(21)])
    capsys.readouterr()
    for rate, words in (("0", "expected a number greater than 0"), ("-1", "expected a number greater than 0")):
        assert main(["track", file, "--csv", str(out), "--rate", rate]) == 2
        assert words in capsys.readouterr().err
    assert main(["track", file, "--rate", "10"]) == 2
    assert capsys.readouterr().err.startswith("--rate: expected --csv FILE, too, got 10.0")


def test_lines_that_are_not_proved_are_noted(
    problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def unproved(*asked: Any) -> Steps:
        return Steps.told(len(lines_between(*asked).proved), (1,), None, None)

    monkeypatch.setattr(motion_module, "lines_between", unproved)
    out = tmp_path / "q.csv"
    assert main(["track", problem("path.yaml"), "--csv", str(out), "--rate", "10"]) == 0
    note = f"note: {out}: rate: 1 of 20 lines between rows are not proved clear"
    assert note in capsys.readouterr().err


def test_tables_of_several_files_are_numbered(problem: Write, tmp_path: Path) -> None:
    files = [problem("easy.yaml"), problem("half.yaml")]
    assert main(["track", *files, "--deviation", "1", "--csv", str(tmp_path / "q.csv")]) == 1
    assert [len(table(tmp_path / f"q-{i}.csv")) for i in (1, 2)] == [2, 3]
    assert not (tmp_path / "q.csv").exists()


def test_a_table_over_a_problem_file_is_refused(problem: Write, capsys: pytest.CaptureFixture[str]) -> None:
    file = problem("path.yaml")
    assert main(["track", file, "--csv", file]) == 2
    assert capsys.readouterr().err.startswith("--csv: expected another file, got ")


def test_how_far_the_tip_may_leave_the_line(problem: Write, capsys: pytest.CaptureFixture[str]) -> None:
    file, counts = Path(problem("path.yaml")), []
    file.write_text(ROBOT + "path: [{position: [1, 0, 2]}, {position: [0, 1, 2]}]\n")
    for deviation in ("1", "0.01"):
        assert main(["track", str(file), "--json", "--deviation", deviation]) == 0
        counts.append(len(strict(capsys.readouterr().out)["knots"]))
    assert counts[0] == 2 < counts[1]
    assert main(["track", str(file), "--deviation", "0"]) == 2
    assert capsys.readouterr().err.startswith("--deviation: expected a number greater than 0, got 0.0")


@pytest.mark.parametrize("name", ["path.yaml", "half.yaml", "easy.yaml", "far.yaml"])
def test_pictures_of_motions_solved_or_not(problem: Write, tmp_path: Path, name: str) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "motion.png"
    assert main(["track", problem(name), "--plot", str(file)]) == (name in ("half.yaml", "far.yaml"))
    assert file.stat().st_size > 10_000


def test_a_path_moves(problem: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    from PIL import Image

    from sinuous.view.pictures import report

    monkeypatch.setattr(report, "animate", partial(sn.animate, seconds=0.4))
    file = tmp_path / "motion.gif"
    assert main(["track", problem("path.yaml"), "--plot", str(file)]) == 0
    with Image.open(file) as image:
        assert image.n_frames == 6  # type: ignore[attr-defined]


def test_a_film_needs_ffmpeg(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("shutil.which", lambda _: None)
    assert main(["track", problem("path.yaml"), "--plot", str(tmp_path / "motion.mp4")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("--plot: expected ffmpeg installed, or a name that ends in .gif, got ")
    assert said.count("\n") == 1
