"""The command plan."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main
from tests.cli.conftest import ROBOT
from tests.cli.test_solve import strict

Write = Callable[[str], str]

START = "start: [[0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]]\n"
GOAL = "goal: [[-0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]]\n"
SCENE = "scene: [{sphere: {center: [0.1, 0, 2], radius: 0.2, name: ball}}]\n"
TARGET = "target: {position: [-1, 0, 2]}\n"


@pytest.fixture
def asked(tmp_path: Path) -> Callable[[str], str]:
    """Write a problem into a folder of the test and return its name."""

    def write(text: str) -> str:
        file = tmp_path / f"{len(list(tmp_path.iterdir()))}.yaml"
        file.write_text(ROBOT + text)
        return str(file)

    return write


def test_it_plans_to_a_target_and_to_a_goal(capsys: pytest.CaptureFixture[str], asked: Write) -> None:
    files = [asked(START + SCENE + TARGET), asked(START + SCENE + GOAL)]
    assert main(["plan", "--json", *files]) == 0
    to_target, to_goal = (strict(line) for line in capsys.readouterr().out.splitlines())
    assert [found["status"] for found in (to_target, to_goal)] == ["solved", "solved"]
    assert [len(found["waypoints"]) for found in (to_target, to_goal)] == [1, 0]
    assert to_target["waypoint_knots"] == [len(to_target["knots"]) - 1]
    for found in (to_target, to_goal):
        assert found["between"] == "proved"
        assert (found["times"][0], found["times"][-1]) == (0.0, 1.0)
        np.testing.assert_array_equal(found["knots"][0], [[0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]])


def test_results_are_read_again_and_go_on_from(asked: Write, tmp_path: Path) -> None:
    for text in (TARGET, GOAL):
        file, out = asked(START + SCENE + text), tmp_path / "plan.jsonl"
        assert main(["plan", file, "--out", str(out), "--csv", str(tmp_path / "plan.csv")]) == 0
        motion = sn.load(file, sn.Job).result(out)
        assert isinstance(motion, sn.Motion)
        assert motion.solved
        assert len((tmp_path / "plan.csv").read_text().splitlines()) == len(motion.q) + 1
        back = sn.load(asked(f"start: {out.name}\ngoal: {motion.q[0].tolist()}\n" + SCENE), sn.Job)
        np.testing.assert_array_equal(back.start, motion.q[-1])
        assert back.plan().solved


def test_a_start_that_is_blocked_is_an_answer(capsys: pytest.CaptureFixture[str], asked: Write) -> None:
    file = asked("start: [[0, 0, 1], [0, 0, 1], [0, 0, 1]]\n" + SCENE + GOAL)
    assert main(["plan", file]) == 1
    said = capsys.readouterr().out
    assert said.startswith(f"{file}: start_blocked (")
    assert "ball" in said


def test_shortcuts_and_time_are_options(capsys: pytest.CaptureFixture[str], asked: Write) -> None:
    file = asked(START + SCENE + GOAL)
    assert main(["plan", file, "--shortcuts", "5", "--time", "2", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "solved"
    assert main(["plan", file, "--shortcuts", "-1"]) == 2
    assert capsys.readouterr().err.startswith("--shortcuts: expected ")


@pytest.mark.parametrize(
    ("command", "text", "message"),
    [
        ("plan", TARGET, "start: expected where the motion begins, got None (missing)"),
        (
            "plan",
            START + "path: [{position: [1, 0, 2]}]\n",
            "path: expected target or targets, got 1 (is for track)",
        ),
        ("solve", START + GOAL, "goal: expected target or targets, got [[-0.5, "),
        ("track", START + GOAL, "goal: expected target or targets, got [[-0.5, "),
        (
            "plan",
            START + "goal: [[0, 0, 9], [0, 0, 1], [0, 0, 1]]\n",
            "goal: expected a configuration within all limits, ",
        ),
    ],
)
def test_what_is_for_another_command_is_refused(
    capsys: pytest.CaptureFixture[str], asked: Write, command: str, text: str, message: str
) -> None:
    file = asked(text)
    assert main([command, file]) == 2
    assert capsys.readouterr().err.startswith(f"{file}: {message}")


def test_check_says_whether_the_start_is_clear(capsys: pytest.CaptureFixture[str], asked: Write) -> None:
    assert main(["check", asked(START + SCENE + GOAL)]) == 0
    assert "start is clear: outside its limits by" in capsys.readouterr().out
    assert main(["check", asked("start: [[0, 0, 1], [0, 0, 1], [0, 0, 1]]\n" + SCENE + GOAL)]) == 1
    assert "start is blocked" in capsys.readouterr().out


RATES = "rates: {bend: 0.1, length: 0.05}\n"
PATH = "path: [{position: [1, 0, 2]}, {position: [1, 0.1, 2]}, {position: [1, 0.2, 2]}]\n"


@pytest.mark.parametrize(("command", "text"), [("plan", START + SCENE + GOAL), ("track", START + PATH)])
def test_tables_keep_the_rates_of_the_file(
    command: str, text: str, asked: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A plan with `rates: {bend: 0.1}` bent by 0.91 rad in a second."""
    table, out = tmp_path / "rows.csv", tmp_path / "found.jsonl"
    accelerated = "rates: {bend: 0.1, length: 0.05, acceleration: {bend: 0.2, length: 0.1}}\n"
    for rates, options in ((RATES, []), (RATES, ["--rate", "20"]), (accelerated, ["--timed"])):
        assert main([command, asked(text + rates), *options, "--csv", str(table), "--out", str(out)]) == 0
        rows = np.genfromtxt(table, delimiter=",", skip_header=1)
        dt, moves = np.diff(rows[:, 0])[:, None], np.diff(rows[:, 1:10], axis=0).reshape(-1, 3, 3)
        assert (np.hypot(moves[..., 0], moves[..., 1]) / dt).max() <= 0.1 * (1.0 + 1e-6)
        assert (np.abs(moves[..., 2]) / dt).max() <= 0.05 * (1.0 + 1e-6)
        assert (
            main([command, asked(text + rates), "--duration", "0.5"] if "--timed" not in options else ["--version"]) < 2
        )
    said = capsys.readouterr().out
    assert "too short for the rates" in said


def test_times_that_cannot_be_meant_are_refused(asked: Write, capsys: pytest.CaptureFixture[str]) -> None:
    plan = START + SCENE + GOAL
    for text, options, word in (
        (plan, ["--timed"], "rates: "),
        (plan + RATES, ["--blend", "1"], "--timed, too"),
        (plan + RATES, ["--timed", "--duration", "3"], "--duration"),
        (plan + RATES, ["--duration", "0"], "--duration"),
    ):
        assert main(["plan", asked(text), *options]) == 2
        assert word in capsys.readouterr().err


def test_a_table_for_motors_without_rates_says_so_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05, tendons=sn.Tendons(3, radius=0.04))
    start = np.array([[0.0, 0.0, 1.0]] * 3)
    file, table = tmp_path / "motors.yaml", str(tmp_path / "rows.csv")
    for rates in (None, sn.Rates(bend=0.5)):
        sn.Job(robot, sn.Target((1.0, 0.0, 2.0)), start=start, rates=rates).save(file)
        assert main(["plan", str(file), "--csv", table]) == 0
        assert capsys.readouterr().err.count("times of --csv are nominal") == int(rates is None)
