"""Problem files in Python: loaded, solved, saved, joined with their results."""

import json
import math
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main
from tests.helpers import refused, refused_each

ARM = "segments: {count: 3, length: [0.8, 1.2], max_bend: 2}\nradius: 0.05\n"
ROOM = "- sphere: {center: [1, 0, 1], radius: 0.3, name: lamp}\n"
JOB = "robot: arm.yaml\nscene: room/room.yaml\ntarget: {position: [0, 1, 2], direction: [0, 1, 1]}\n"
ROBOT = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05)
LAMP = sn.Sphere((1, 0, 1), 0.3, name="lamp")
TARGET = sn.Target((0, 1, 2), direction=(0, 1, 1))


@pytest.fixture
def job_file(tmp_path: Path) -> Path:
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "room.yaml").write_text(ROOM)
    (tmp_path / "arm.yaml").write_text(ARM)
    (tmp_path / "job.yaml").write_text(JOB)
    return tmp_path / "job.yaml"


def load_job(file: Path) -> sn.Job:
    return sn.load(file, sn.Job)


def test_a_job_is_the_same_from_its_file_and_from_python(job_file: Path) -> None:
    job = load_job(job_file)
    made = sn.Job(ROBOT, TARGET, [LAMP])
    assert job.equals(made)
    assert job.file == str(job_file)
    solution = job.solve(seed=3)
    assert solution.solved
    assert solution.seed == 3
    np.testing.assert_array_equal(made.solve().q, sn.solve(ROBOT, TARGET, [LAMP]).q)
    assert job.track().solved
    assert not job.equals(sn.Job(ROBOT, TARGET))


def test_a_saved_job_stands_alone(job_file: Path) -> None:
    job = load_job(job_file)
    job.save(job_file.with_name("alone.yaml"))
    (job_file.with_name("arm.yaml")).unlink()
    again = load_job(job_file.with_name("alone.yaml"))
    assert again.equals(job)
    np.testing.assert_array_equal(again.solve().q, job.solve().q)


CASES: dict[str, Any] = {
    "solved": TARGET,
    "direction alone": sn.Target(direction=(0, 1, 1)),
    "out_of_reach": sn.Target((0, 0, 9)),
    "target_blocked": sn.Target((1, 0, 1)),
    "two": [TARGET, sn.Target((0, 0, 9), segment=1)],
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("time", [0.2, 0.0])
def test_a_solution_comes_back_from_its_result(tmp_path: Path, name: str, time: float) -> None:
    job = sn.Job(ROBOT, CASES[name], [LAMP])
    solution = job.solve(time=time, max_starts=3)
    values = json.loads(json.dumps(solution.to_dict(), allow_nan=False))
    again = sn.Solution.from_dict(values, solution.problem)
    assert again.to_dict() == solution.to_dict()
    assert str(again) == str(solution)
    assert not again.q.flags.writeable
    assert again.verify() == solution.verify()
    (tmp_path / "result.json").write_text(json.dumps(values))
    found = job.result(tmp_path / "result.json")
    assert isinstance(found, sn.Solution)
    assert found.to_dict() == solution.to_dict()


def test_a_track_comes_back_from_the_command_line(job_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "".join(f"  - {{position: [0, {y}, 2]}}\n" for y in (0.5, 0.6, 0.7))
    path = job_file.with_name("path.yaml")
    path.write_text(JOB.split("target", maxsplit=1)[0] + "path:\n" + rows)
    out = job_file.with_name("out.jsonl")
    assert main(["track", str(path), str(job_file), "--out", str(out)]) == 0
    capsys.readouterr()
    track, single = load_job(path).result(out), load_job(job_file).result(out)
    assert isinstance(track, sn.Motion)
    written = json.loads(out.read_text().splitlines()[0])
    assert track.to_dict() == {key: value for key, value in written.items() if key not in ("file", "prepare_seconds")}
    assert track.solved
    assert len(track.solutions) == 3
    assert isinstance(single, sn.Motion)
    assert all(verification.ok for verification in track.verify())
    words = "there are others; expected a result of this problem, got ['"
    refused("file", lambda: sn.Job(ROBOT, TARGET).result(out), words, file=out)


def test_results_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    solution = sn.solve(ROBOT, TARGET)
    good = solution.to_dict()
    problem = solution.problem

    def read(**changes: Any) -> Any:
        return sn.Solution.from_dict({**good, **changes}, problem)

    refused("", lambda: sn.Solution.from_dict([1], problem), "a result")  # type: ignore[arg-type]
    for key in ("status", "q", "seconds", "seed", "method", "start", "clearance"):
        without = {other: value for other, value in good.items() if other != key}
        refused(key, partial(sn.Solution.from_dict, without, problem), "missing")
    refused_each("status", ("great", None, 3), lambda value: read(status=value), "solved, out_of_reach")
    refused_each("q", ([], good["q"][:2], "abc", [[math.nan] * 3] * 3), lambda value: read(q=value))
    refused_each("seconds", ("1", None, math.inf), lambda value: read(seconds=value))
    refused_each("seed", (-1, 1.5), lambda value: read(seed=value))
    refused("start", lambda: read(start="luck"), "given, arc")
    whole = sn.track(ROBOT, [TARGET]).to_dict()
    refused_each(
        "waypoints", ([], None, 3), lambda value: sn.Motion.from_dict({**whole, "waypoints": value}, [problem])
    )
    refused("waypoints", lambda: sn.Motion.from_dict(whole, [problem] * 2), "2")
    refused("waypoints[0].q", lambda: sn.Motion.from_dict({**whole, "waypoints": [{**good, "q": []}]}, [problem]))
    wrong = {"times": [1, 2], "knots": [[1]], "waypoint_knots": [7, 0], "unproved_steps": 3, "status": "great"}
    for key, value in wrong.items():
        refused(key, partial(sn.Motion.from_dict, {**whole, key: value}, [problem]))
        refused(key, partial(sn.Motion.from_dict, {k: v for k, v in whole.items() if k != key}, [problem]), "missing")
    job = sn.Job(ROBOT, TARGET)
    lines = {"": "is empty", "[1]": "line 1: expected a result", "{": "line 1", "{}": "line 1.status"}
    for text, words in lines.items():
        (tmp_path / "out.jsonl").write_text(text)
        with pytest.raises(sn.InputError, match=words) as caught:
            job.result(tmp_path / "out.jsonl")
        assert str(caught.value).startswith(str(tmp_path / "out.jsonl"))


BAD = {
    "3": "file: expected a problem, a robot, a list of obstacles, or a motion, got 3",
    "": "file: missing; expected a problem, a robot, a list of obstacles, or a motion",
    "a: 1": "a: unknown key; expected one of robot, scene",
    "segments: {length: 1, lenght: 2}": "segments.lenght: unknown key; did you mean 'length'?",
    "[{spere: {}}]": "[0].spere: unknown key; did you mean 'sphere'?",
    "robot: job.yaml\ntarget: {position: [0, 0, 1]}": "unknown key; expected one of segments, ",
    "robot: name.yaml\ntarget: {position: [0, 0, 1]}": "expected what stands under robot, not the name of another",
    "robot: missing.yaml": "robot: cannot be read: No such file",
    "robot: {segments: {length: 1}}\nscene: name.yaml": "expected what stands under scene, not the name of another",
    "robot: {segments: {length: 1}}\nscene: job.yaml": "expected a list of obstacles",
    "robot: {segments: {length: 1}}\nscene: empty.yaml": "file: missing; expected what stands under scene",
    "robot: [arm.yaml]": "robot: expected a mapping with segments",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_files_are_refused_in_a_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "job.yaml").write_text(text)
    (tmp_path / "name.yaml").write_text("name.yaml")
    (tmp_path / "empty.yaml").write_text("")
    with pytest.raises(sn.InputError) as caught:
        sn.load(tmp_path / "job.yaml")
    message = str(caught.value)
    assert message.startswith(str(tmp_path))
    assert BAD[text] in message
    assert "\n" not in message


def test_the_kind_of_a_file_may_be_demanded(job_file: Path) -> None:
    arm = job_file.with_name("arm.yaml")
    assert sn.load(arm, sn.Robot).equals(sn.load(arm))
    assert len(sn.load(job_file.parent / "room" / "room.yaml", sn.Scene)) == 1
    refused("file", lambda: sn.load(arm, sn.Scene), "expected a Scene, got Robot(3 segments", file=arm)


def test_a_robot_in_a_scene_is_loaded_and_asks_nothing(tmp_path: Path) -> None:
    file = tmp_path / "place.yaml"
    job = sn.Job(ROBOT, scene=[sn.Sphere((9, 9, 9), 1)], tolerance=sn.Tolerance(1e-3))
    job.save(file)
    again = sn.load(file, sn.Job)
    assert again.equals(job)
    assert "0 targets" in repr(again)
    assert again.solver().solve(TARGET).solved
    for verb in (again.solve, again.track, again.plan):
        refused("target", verb, "missing; expected one of target, targets, path", file=file)


def test_arguments_are_checked() -> None:
    refused("robot", lambda: sn.Job(3, TARGET))  # type: ignore[arg-type]
    refused("target", lambda: sn.Job(ROBOT, TARGET, path=[TARGET]), "cannot be combined with path")
    refused("target[1]", lambda: sn.Job(ROBOT, [TARGET, 3]))  # type: ignore[arg-type]
    refused("path[1]", lambda: sn.Job(ROBOT, path=[TARGET, 3]))  # type: ignore[list-item]
    refused("path", lambda: sn.Job(ROBOT, path=[]))
    refused("path", lambda: sn.Job(ROBOT, path=TARGET))  # type: ignore[arg-type]
    refused("path[0].segment", lambda: sn.Job(ROBOT, path=[sn.Target((0, 0, 1), segment=4)]))
    refused("start", lambda: sn.Job(ROBOT, TARGET, start=[[0, 0, 1]]))
    bad: Any = {"bends": 1}
    refused("prefer", lambda: sn.Job(ROBOT, TARGET, prefer=bad))
    refused("tolerance", lambda: sn.Job(ROBOT, TARGET, tolerance=bad))
