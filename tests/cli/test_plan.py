"""The command plan."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from tests.cli.conftest import GOAL, IN_THE_WAY, PATH, ROBOT, START, Run

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
    said = run("plan blocked.yaml", 1).out
    assert said.startswith("blocked.yaml: start_blocked (")
    assert "ball" in said
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
