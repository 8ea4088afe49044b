"""The command solve."""

from pathlib import Path
from typing import Any

import pytest

from sinuous.cli import work
from sinuous.motion.job import read_problem
from sinuous.solver.solver import Solver
from tests.cli.conftest import Run

KEYS = [
    *("file", "status", "q", "base", "position_error", "angle_error", "clearance", "self_clearance"),
    *("demanded_clearance", "demanded_self_clearance", "uncertainty", "actuators", "tensions", "worst", "reason"),
    *("binding", "iterations", "starts", "start", "route_class", "seconds", "prepare_seconds", "method", "seed"),
]
OWN = [key for key in KEYS if key not in ("file", "prepare_seconds")]
"""Those of a waypoint, or of one solution of several."""


def test_json_is_one_object_a_line_in_the_order_of_the_files(run: Run) -> None:
    Path("results.jsonl").write_text("old\n")
    said = run("solve --json --seed 7 scene.yaml far.yaml easy.yaml --out results.jsonl", 1)
    assert Path("results.jsonl").read_text() == said.out
    assert [result["file"] for result in said.results] == ["scene.yaml", "far.yaml", "easy.yaml"]
    assert [result["status"] for result in said.results] == ["solved", "out_of_reach", "solved"]
    assert all(list(result) == KEYS for result in said.results)
    near, far, free = said.results
    assert near["clearance"] >= 0.0
    assert (near["worst"], near["angle_error"], near["seed"]) == (None, None, 7)
    assert far["clearance"] is None
    assert set(far["worst"]) == {"constraint", "segment", "obstacle", "amount", "other_segment", "place"}
    assert free["clearance"] is None
    assert len(free["q"]) == 3


def test_the_text_is_short_and_a_result_can_be_the_next_start(run: Run) -> None:
    said = run("solve easy.yaml --out result.json").out
    assert said.startswith("easy.yaml: solved (")
    assert len(said.splitlines()) < 12
    Path("again.yaml").write_text(Path("easy.yaml").read_text() + "start: result.json\n")
    assert run("solve again.yaml --json").results[0]["start"] == "given"


def test_methods_and_their_options(run: Run) -> None:
    (found,) = run("solve scene.yaml --json --method opti_path --option samples=5").results
    assert (found["method"], found["status"]) == ("opti_path", "solved")
    stopped = "--option iterations=0 --option restarts=false --option other_guess=false"
    (found,) = run(f"solve scene.yaml --json --method opti_path {stopped}", 1).results
    assert found["iterations"] == 0


def test_an_interrupt_keeps_the_results_so_far(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    solve = work._solve

    def interrupted(solver: Any, asked: Any, *rest: Any) -> Any:
        if asked.file == "far.yaml":
            raise KeyboardInterrupt
        return solve(solver, asked, *rest)

    monkeypatch.setattr(work, "_solve", interrupted)
    said = run("solve easy.yaml far.yaml scene.yaml --json --out results.jsonl", 130)
    assert said.out == Path("results.jsonl").read_text()
    assert [result["file"] for result in said.results] == ["easy.yaml"]
    done = "sinuous: interrupted after 1 of 3 files; the results so far are written"
    assert said.err.splitlines()[-1] == f"{done}, the same command goes on"
    assert run("solve easy.yaml far.yaml scene.yaml --json", 130).err.splitlines()[-1] == done


def test_distinct_solutions_are_a_table(run: Run) -> None:
    head, names, *rows = run("solve scene.yaml --all 3 --by shape --csv q.csv").out.splitlines()
    assert head == "scene.yaml: solved (3 distinct solutions, best first)"
    assert names.split() == ["class", "bend", "length", "clearance", "position", "angle", "start"]
    table, words = rows[:3], rows[3:]
    assert [row.split()[0] for row in table] == ["1", "2", "3"]
    assert all(float(row.split()[4]) >= 0.0 and row.split()[6] == "-" for row in table)
    assert [line.split(":")[0] for line in words] == [f"  class {i}" for i in range(1, len(words) + 1)]
    assert {row.split()[1] for row in table} == {line.split(":")[0].split()[1] for line in words}
    header, *written = (line.split(",") for line in Path("q.csv").read_text(encoding="utf-8").splitlines())
    assert header[:3] == ["solution", "status", "s1.bend_x"]
    assert [row[:2] for row in written] == [["1", "solved"], ["2", "solved"], ["3", "solved"]]
    run("solve far.yaml --all 3 --csv q.csv", 1)
    assert ",out_of_reach," in Path("q.csv").read_text(encoding="utf-8")


def test_distinct_solutions_are_results(run: Run) -> None:
    """Each has the keys of a result, and all are what the library finds; where there is none, it is said why."""
    found, none = run("solve scene.yaml far.yaml --all 4 --by shape --json", 1).results
    common = ["file", "status", "base", "worst", "reason", "seconds", "prepare_seconds", "method", "seed", "solutions"]
    assert list(found) == list(none) == common
    assert all(list(each) == OWN and each["status"] == "solved" for each in found["solutions"])
    asked = read_problem("scene.yaml")
    solver = Solver(asked.robot, asked.scene, tolerance=asked.tolerance)
    again = solver.solve_all(asked.waypoints[0], count=4, by="shape")
    assert [each["q"] for each in found["solutions"]] == [solution.q.tolist() for solution in again]
    assert len(again) == 4
    assert (none["status"], none["solutions"]) == ("out_of_reach", [])
    assert none["reason"]["bound"] == "length"


def test_why_says_what_would_help(run: Run) -> None:
    assert "--why-time 1, gives it more" in run("solve far.yaml --why --why-time 0", 1).out
    lines = run("solve far.yaml --why", 1).out.splitlines()
    assert lines[:4] == [
        "far.yaml: out_of_reach: proved: no configuration within the limits gets there",
        "  because    the target is 5.4 farther from the base than the robot is long "
        "(9 away, the robot at most 3.6 long)",
        "  best found 5.4 from the position",
        "  held by    greatest length of all segments: at its limit of 1.2",
    ]
    assert lines[4].startswith("  would help length of all segments: [0.8, 1.2] -> [0.8, 3")
    assert lines[5].startswith("             target position: [0, 0, 9] -> [")
    assert len(lines) == 6


def test_remedies_are_in_the_result_only_when_asked_for(run: Run) -> None:
    said = run("solve far.yaml easy.yaml --why --json --out out.jsonl", 1)
    assert Path("out.jsonl").read_text() == said.out
    far, easy = said.results
    at = KEYS.index("binding") + 1
    assert list(far) == list(easy) == [*KEYS[:at], "remedies", *KEYS[at:]]
    assert [remedy["change"] for remedy in far["remedies"]] == ["length of all segments", "target position"]
    assert (easy["remedies"], easy["binding"]) == ([], [])
    assert set(far["binding"][0]) >= {"constraint", "segment", "obstacle", "value", "limit"}


def test_shapes_are_remembered_from_one_command_to_the_next(run: Run) -> None:
    starts = [run("solve scene.yaml --json --memory arm.npz").results[0]["start"] for _ in range(2)]
    assert starts == [starts[0], "remembered"]
    assert starts[0] != "remembered"
    run("plan scene.yaml --memory arm.npz", 2)  # it has no start
    run("track path.yaml --memory arm.npz")
    assert not list(Path().glob(".*"))


def test_shapes_of_another_robot_and_what_is_no_memory_are_refused(run: Run) -> None:
    other = "robot: {segments: {count: 2, length: 1, max_bend: 2}}\ntarget: {position: [1, 0, 1]}\n"
    Path("other.yaml").write_text(other)
    run("solve easy.yaml --memory arm.npz")
    assert run("solve other.yaml --memory arm.npz", 2).err.startswith("--memory: of another robot; ")
    Path("arm.npz").write_text("no shapes")
    (line,) = run("solve easy.yaml --memory arm.npz", 2).err.splitlines()
    assert line.startswith("--memory: ")
    assert Path("arm.npz").read_text() == "no shapes"
