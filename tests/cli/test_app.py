"""What the shell is told: exit codes, one line on standard error, and quickly.

What is read is noted once, and a mesh that is wrong is refused before anything is solved.

Obstacles that move, on the command line.

The command calibrate.

The command new.

The command plan.
"""

import contextlib
import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import sinuous
import sinuous as sn
from sinuous.answer.verification import verify
from sinuous.cli import app
from sinuous.cli.app import main
from sinuous.motion.job import read_problem
from tests.cli.conftest import GOAL, IN_THE_WAY, PATH, ROBOT, START, Run
from tests.cli.test_check import DEFECT
from tests.scene.shapes import cube, obj


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(out.count(f"\n  {command} ") == 2 for command in ("solve", "track", "check", "view", "new", "warm"))
    assert "bench" not in out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"sinuous {sinuous.__version__}\n"


def test_the_entry_point_is_main() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    assert project["scripts"]["sinuous"] == f"{app.__name__}:{main.__name__}"


def test_the_module_is_the_command_and_help_imports_nothing_heavy() -> None:
    listed = "import sys, runpy; sys.argv = ['sinuous', '--help']\n"
    listed += "heavy = {'numpy', 'numba', 'scipy', 'rich', 'yaml'}\n"
    listed += "try: runpy.run_module('sinuous', run_name='__main__')\n"
    listed += "except SystemExit as end: print(end.code, sorted(heavy & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", listed], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("Usage: sinuous")
    assert done.stdout.endswith("0 []\n")


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("sinuous wa", ["warm"]),
        ("sinuous solve --meth", ["--method"]),
        ("sinuous track --method fabrik_", ["fabrik_avoid"]),
        ("sinuous new p", ["pneumatic"]),
    ],
)
def test_the_shell_completes(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, typed: str, completed: list[str]
) -> None:
    monkeypatch.setenv("_SINUOUS_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    with contextlib.suppress(SystemExit):
        main([])
    assert capsys.readouterr().out.split() == completed


def test_a_disk_that_fills_up_is_no_traceback(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sinuous.cli.work.AnswerWriter.write", full)
    assert run("solve easy.yaml", 1).err.splitlines()[-1] == "sinuous: [Errno 28] No space left on device"


def test_defects_are_noted_once_beside_the_results(run: Run) -> None:
    run("solve shell.yaml")  # may have to compile, which is said too
    said = run("solve --json shell.yaml easy.yaml shell.yaml")
    assert [result["status"] for result in said.results] == ["solved"] * 3
    assert said.err.splitlines() == [f"note: shell.yaml: {DEFECT}"]


def test_a_mesh_that_cuts_through_itself_is_a_shell_and_that_is_said(run: Run) -> None:
    """Pulled through its opposite face, one corner of a cube turns a part of it inside out."""
    vertices, faces = cube(5.0)
    vertices[7] = (-6.0, -6.0, 1.0)
    Path("sheet.obj").write_text(obj((vertices, faces)))
    said = run("solve easy.yaml shell.yaml").err
    assert (
        "note: shell.yaml: sheet: its surface cuts through itself, so it is used as a shell and not as a solid" in said
    )


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


def test_it_fits_a_payload_and_bounds_a_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rod = sn.Stiffness(2e3, 1.5e3)
    tendons = sn.Tendons(3, 4.0)
    drawn = sn.Robot.uniform(1, 60.0, tendons=tendons, stiffness=rod, mass=1e-4, gravity=(0, 0, -9.81), arcs=2)
    real = drawn.changed(base=sn.pose(direction=(1, 0, 0)), payload=sn.Payload(0.01))
    values = real.to_actuators([[[0.02 * i, 0.3 - 0.01 * i, 60.0]] for i in range(20)])
    tips = np.array([real.equilibrium(each).tip[:3, 3] for each in values])
    names = [each.name for each in drawn.actuators]
    rows, motion, out = (tmp_path / name for name in ("rows.csv", "motion.csv", "out.json"))
    for file, off in ((rows, 0.0), (motion, 1.0)):
        table = np.concatenate([values, tips + np.array([0.0, off, 0.0])], axis=1)
        np.savetxt(file, table, delimiter=",", header=",".join([*names, "x", "y", "z"]), comments="")
    robot = tmp_path / "robot.yaml"
    drawn.save(robot)
    asked = ["calibrate", str(robot), str(rows), "--fit", "payload", "--motion", str(motion), "--out", str(out)]
    assert main(asked) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"bound of the robot, from {motion}: 1"
    written = json.loads(out.read_text())
    assert written["payload"][0]["mass"] == pytest.approx(0.01, rel=1e-6)
    assert written["uncertainty"]["bound"] == pytest.approx(1.0, rel=1e-6)
    assert main([*asked[:-2], "--frame", "camera"]) == 2
    assert "--frame: expected base or device" in capsys.readouterr().err


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
        assert verify(sn.Problem(asked.robot, waypoint, asked.scene, asked.tolerance), np.array(found["q"])).ok


STRAIGHT = "start: [[0, 0, 1], [0, 0, 1], [0, 0, 1]]\n"
RATES = "rates: {bend: 0.1, length: 0.05}\n"
ACCELERATED = "rates: {bend: 0.1, length: 0.05, acceleration: {bend: 0.2, length: 0.1}}\n"


def test_it_plans_to_a_target_and_to_a_goal_and_goes_on_from_there(run: Run) -> None:
    files = ["plan_to_target.yaml", "plan.yaml"]
    found = run(f"plan --json --shortcuts 5 --time 2 {' '.join(files)}").results
    assert [each["status"] for each in found] == ["solved", "solved"]
    assert [len(each["waypoints"]) for each in found] == [1, 0]
    assert found[0]["waypoint_knots"] == [len(found[0]["knots"]) - 1]
    for each in found:
        assert each["between"] == "proved"
        assert (each["times"][0], each["times"][-1]) == (0.0, 1.0)
        np.testing.assert_array_equal(each["knots"][0], [[0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]])
    for file in files:
        run(f"plan {file} --out plan.jsonl --csv plan.csv")
        motion = sn.load(file, sn.Job).result("plan.jsonl")
        assert isinstance(motion, sn.Motion)
        assert motion.solved
        assert len(Path("plan.csv").read_text().splitlines()) == len(motion.q) + 1
        Path("back.yaml").write_text(f"{ROBOT}start: plan.jsonl\ngoal: {motion.q[0].tolist()}\n" + IN_THE_WAY)
        back = sn.load("back.yaml", sn.Job)
        np.testing.assert_array_equal(back.start, motion.q[-1])
        assert back.plan().solved


def test_whether_a_start_is_clear_is_an_answer(run: Run) -> None:
    assert "start is clear: outside its limits by" in run("check plan.yaml").out
    Path("blocked.yaml").write_text(ROBOT + STRAIGHT + IN_THE_WAY + GOAL)
    said = run("plan blocked.yaml --csv rows.csv", 1)
    assert said.out.startswith("blocked.yaml: start_blocked (")
    assert "ball" in said.out
    assert "steps" not in said.out
    assert "rows.csv: not written: no motion was found" in said.err
    assert not Path("rows.csv").exists()
    assert "start is blocked" in run("check blocked.yaml", 1).out


@pytest.mark.parametrize(("command", "text"), [("plan", START + IN_THE_WAY + GOAL), ("track", START + PATH)])
def test_tables_keep_the_rates_of_the_file(command: str, text: str, run: Run) -> None:
    """A plan with `rates: {bend: 0.1}` bent by 0.91 rad in a second."""
    for rates, options in ((RATES, ""), (RATES, "--rate 20"), (ACCELERATED, "--timed")):
        Path("a.yaml").write_text(ROBOT + text + rates)
        run(f"{command} a.yaml {options} --csv rows.csv --out found.jsonl")
        rows = np.genfromtxt("rows.csv", delimiter=",", skip_header=1)
        dt, moves = np.diff(rows[:, 0])[:, None], np.diff(rows[:, 1:10], axis=0).reshape(-1, 3, 3)
        assert (np.hypot(moves[..., 0], moves[..., 1]) / dt).max() <= 0.1 * (1.0 + 1e-6)
        assert (np.abs(moves[..., 2]) / dt).max() <= 0.05 * (1.0 + 1e-6)
    assert "too short for the rates" in run(f"{command} a.yaml --duration 0.5", 1).out


def test_a_table_for_motors_without_rates_says_so_once(run: Run) -> None:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05, tendons=sn.Tendons(3, radius=0.04))
    start = np.array([[0.0, 0.0, 1.0]] * 3)
    for rates in (None, sn.Rates(bend=0.5)):
        sn.Job(robot, sn.Target((1.0, 0.0, 2.0)), start=start, rates=rates).save("motors.yaml")
        assert run("plan motors.yaml --csv rows.csv").err.count("times of --csv are nominal") == int(rates is None)
