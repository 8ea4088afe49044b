"""The command solve."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sinuous.cli.app import main
from sinuous.files.problem_file import read_problem
from sinuous.solver.solver import Solver

Write = Callable[[str], str]

KEYS = [
    "file",
    "status",
    "q",
    "base",
    "position_error",
    "angle_error",
    "clearance",
    "self_clearance",
    "demanded_clearance",
    "demanded_self_clearance",
    "uncertainty",
    "actuators",
    "tensions",
    "worst",
    "reason",
    "binding",
    "iterations",
    "starts",
    "start",
    "route_class",
    "seconds",
    "prepare_seconds",
    "method",
    "seed",
]


def strict(line: str) -> dict[str, Any]:
    """Read JSON without NaN and infinity."""

    def refuse(text: str) -> None:
        raise AssertionError(text)

    result: dict[str, Any] = json.loads(line, parse_constant=refuse)
    return result


def test_json_is_one_object_a_line_in_the_order_of_the_files(
    capsys: pytest.CaptureFixture[str], problem: Write
) -> None:
    files = [problem("scene.yaml"), problem("far.yaml"), problem("easy.yaml")]
    assert main(["solve", "--json", "--seed", "7", *files]) == 1
    results = [strict(line) for line in capsys.readouterr().out.splitlines()]
    assert [result["file"] for result in results] == files
    assert [result["status"] for result in results] == ["solved", "out_of_reach", "solved"]
    assert all(list(result) == KEYS for result in results)
    near, far, free = results
    assert near["clearance"] >= 0.0
    assert near["worst"] is None
    assert near["angle_error"] is None
    assert near["seed"] == 7
    assert far["clearance"] is None
    assert set(far["worst"]) == {"constraint", "segment", "obstacle", "amount", "other_segment"}
    assert free["clearance"] is None
    assert len(free["q"]) == 3


def test_solved_is_exit_code_0_and_out_gets_the_same_lines(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    out = tmp_path / "results.jsonl"
    out.write_text("old\n")
    assert main(["solve", problem("easy.yaml"), problem("scene.yaml"), "--json", "--out", str(out)]) == 0
    assert out.read_text() == capsys.readouterr().out


def test_the_text_is_short_and_readable(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("easy.yaml")
    assert main(["solve", file]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"{file}: solved (")
    assert len(out.splitlines()) < 12


def test_a_result_can_be_the_next_start(capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path) -> None:
    assert main(["solve", problem("easy.yaml"), "--out", str(tmp_path / "result.json")]) == 0
    file = tmp_path / "again.yaml"
    file.write_text(Path(problem("easy.yaml")).read_text() + "start: result.json\n")
    capsys.readouterr()
    assert main(["solve", str(file), "--json"]) == 0
    assert strict(capsys.readouterr().out)["start"] == "given"


def test_methods_and_their_options(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("scene.yaml")
    assert main(["solve", file, "--json", "--method", "opti_path", "--option", "samples=5"]) == 0
    found = strict(capsys.readouterr().out)
    assert (found["method"], found["status"]) == ("opti_path", "solved")
    stopped = ["--option", "iterations=0", "--option", "restarts=false", "--option", "other_guess=false"]
    assert main(["solve", file, "--json", "--method", "opti_path", *stopped]) == 1
    assert strict(capsys.readouterr().out)["iterations"] == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--method", "magic"], "--method: expected one of newton, opti_path"),
        (["--option", "beta=1"], "--option beta: expected none"),
        (["--method", "opti_path", "--option", "beta=1"], "--option beta: expected one of"),
        (["--method", "opti_path", "--option", "samples=x"], "--option samples: expected a whole number"),
        (["--method", "opti_path", "--option", "samples"], "--option: expected KEY=VALUE"),
        (["--method", "opti_path", "--option", "cooling=2"], "--option cooling: expected a number"),
    ],
)
def test_wrong_options_are_one_line(
    capsys: pytest.CaptureFixture[str], problem: Write, arguments: list[str], said: str
) -> None:
    assert main(["solve", problem("easy.yaml"), *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith(said)
    assert error.count("\n") == 1


def test_a_path_is_for_track(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("path.yaml")
    assert main(["solve", file]) == 2
    assert capsys.readouterr().err.startswith(f"{file}: path: expected target or targets, got ")


def test_pictures_of_several_files_are_numbered(problem: Write, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    assert main(["solve", problem("easy.yaml"), problem("scene.yaml"), "--plot", str(tmp_path / "shape.png")]) == 0
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["shape-1.png", "shape-2.png"]


def test_an_interrupt_keeps_the_results_so_far(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sinuous.cli import work

    solve = work._solve

    def interrupted(solver: Any, asked: Any, *rest: Any) -> Any:
        if asked.file.endswith("far.yaml"):
            raise KeyboardInterrupt
        return solve(solver, asked, *rest)

    monkeypatch.setattr(work, "_solve", interrupted)
    out = tmp_path / "results.jsonl"
    files = [problem("easy.yaml"), problem("far.yaml"), problem("scene.yaml")]
    assert main(["solve", *files, "--json", "--out", str(out)]) == 130
    captured = capsys.readouterr()
    assert captured.out == out.read_text()
    assert strict(captured.out)["file"] == files[0]
    done = "sinuous: interrupted after 1 of 3 files; the results so far are written"
    assert captured.err.splitlines()[-1] == f"{done}, the same command goes on"
    assert main(["solve", *files, "--json"]) == 130
    assert capsys.readouterr().err.splitlines()[-1] == done


def test_distinct_solutions_are_a_table(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("scene.yaml")
    assert main(["solve", file, "--all", "3", "--by", "shape"]) == 0
    head, names, *rows = capsys.readouterr().out.splitlines()
    assert head == f"{file}: solved (3 distinct solutions, best first)"
    assert names.split() == ["class", "bend", "length", "clearance", "position", "angle", "start"]
    table, words = rows[:3], rows[3:]
    assert [row.split()[0] for row in table] == ["1", "2", "3"]
    assert all(float(row.split()[4]) >= 0.0 and row.split()[6] == "-" for row in table)
    assert [line.split(":")[0] for line in words] == [f"  class {i}" for i in range(1, len(words) + 1)]
    assert {row.split()[1] for row in table} == {line.split(":")[0].split()[1] for line in words}


def test_one_solution_a_class_is_a_table_and_words(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    assert main(["solve", problem("scene.yaml"), "--all", "2"]) == 0
    _, _, one, two, *words = capsys.readouterr().out.splitlines()
    assert [row.split()[:2] for row in (one, two)] == [["1", "1"], ["2", "2"]]
    assert all(f"class {i}: past ball on its " in line for i, line in enumerate(words, 1))
    assert main(["solve", problem("easy.yaml"), "--all", "2"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[0] == "bend"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--all", "2", "--by", "door"], "--by: expected route or shape, got 'door'\n"),
        (["--by", "route"], "--by: expected --all COUNT, too, got 'route' (is for --all)\n"),
    ],
)
def test_what_they_are_told_apart_by(
    capsys: pytest.CaptureFixture[str], problem: Write, options: list[str], message: str
) -> None:
    assert main(["solve", problem("scene.yaml"), *options]) == 2
    assert capsys.readouterr().err == message


def test_distinct_solutions_are_results(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    """Each has the keys of a result, and all are what the library finds; where there is none, it is said why."""
    file = problem("scene.yaml")
    assert main(["solve", file, problem("far.yaml"), "--all", "4", "--by", "shape", "--json"]) == 1
    found, none = (strict(line) for line in capsys.readouterr().out.splitlines())
    common = ["file", "status", "base", "worst", "reason", "seconds", "prepare_seconds", "method", "seed", "solutions"]
    assert list(found) == list(none) == common
    own = [key for key in KEYS if key not in ("file", "prepare_seconds")]
    assert all(list(each) == own and each["status"] == "solved" for each in found["solutions"])
    asked = read_problem(file)
    again = Solver(asked.robot, asked.scene, tolerance=asked.tolerance).solve_all(
        asked.waypoints[0], count=4, by="shape"
    )
    assert [each["q"] for each in found["solutions"]] == [solution.q.tolist() for solution in again]
    assert len(again) == 4
    assert (none["status"], none["solutions"]) == ("out_of_reach", [])
    assert none["reason"]["bound"] == "length"


@pytest.mark.parametrize("count", ["0", "-1", "10001"])
def test_how_many_must_be_some(capsys: pytest.CaptureFixture[str], problem: Write, count: str) -> None:
    assert main(["solve", problem("easy.yaml"), "--all", count]) == 2
    assert capsys.readouterr().err.startswith("--all: expected a whole number from 1 to 10000, got")


def test_distinct_solutions_are_not_explained(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    assert main(["solve", problem("easy.yaml"), "--all", "3", "--why"]) == 2
    assert capsys.readouterr().err == "--all: expected one of --all, --why, got 3 (cannot be combined with --why)\n"


def test_distinct_solutions_are_a_table_in_a_file(problem: Write, tmp_path: Path) -> None:
    file = tmp_path / "q.csv"
    assert main(["solve", problem("scene.yaml"), "--all", "3", "--by", "shape", "--csv", str(file)]) == 0
    header, *rows = (line.split(",") for line in file.read_text(encoding="utf-8").splitlines())
    assert header[:3] == ["solution", "status", "s1.bend_x"]
    assert [row[:2] for row in rows] == [[str(i), "solved"] for i in range(1, len(rows) + 1)]
    assert len(rows) > 1
    assert main(["solve", problem("far.yaml"), "--all", "3", "--csv", str(file)]) == 1
    assert ",out_of_reach," in file.read_text(encoding="utf-8")


def test_of_distinct_solutions_the_best_is_drawn(problem: Write, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    assert main(["solve", problem("easy.yaml"), "--all", "2", "--plot", str(tmp_path / "best.png")]) == 0
    assert (tmp_path / "best.png").stat().st_size > 1000


def test_what_several_files_need_is_compiled_before_the_first_is_answered(
    problem: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second has obstacles: the search for routes must not be compiled between two results."""
    from sinuous.cli.answers import AnswerWriter
    from sinuous.solver.routing.searches import Searches

    events: list[str] = []

    def noted(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            events.append(name)
            return function(*arguments, **named)

        return call

    monkeypatch.setattr(Searches, "load", noted("load", Searches.load))
    monkeypatch.setattr(AnswerWriter, "write", noted("write", AnswerWriter.write))
    assert main(["solve", problem("easy.yaml"), problem("scene.yaml"), "--json"]) == 0
    assert events == ["load", "write", "load", "write"]
    events.clear()
    assert main(["solve", problem("scene.yaml"), "--json"]) == 0
    assert events == ["write"]  # one alone compiles what it turns out to need


def test_why_says_what_would_help(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("far.yaml")
    assert main(["solve", file, "--why"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[:5] == [
        f"{file}: out_of_reach: proved: no configuration within the limits gets there",
        "  because    the target is 5.4 farther from the base than the robot is long "
        "(9 away, the robot at most 3.6 long)",
        "  best found 5.4 from the position",
        "  held by    greatest length of all segments: at its limit of 1.2",
        lines[4],
    ]
    assert lines[4].startswith("  would help length of all segments: [0.8, 1.2] -> [0.8, 3")
    assert lines[5].startswith("             target position: [0, 0, 9] -> [")
    assert len(lines) == 6


def test_remedies_are_in_the_result_only_when_asked_for(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    files = [problem("far.yaml"), problem("easy.yaml")]
    assert main(["solve", *files, "--why", "--json", "--out", str(tmp_path / "out.jsonl")]) == 1
    out = capsys.readouterr().out
    assert (tmp_path / "out.jsonl").read_text() == out
    far, easy = map(strict, out.splitlines())
    at = KEYS.index("binding") + 1
    assert list(far) == list(easy) == [*KEYS[:at], "remedies", *KEYS[at:]]
    assert [remedy["change"] for remedy in far["remedies"]] == ["length of all segments", "target position"]
    assert (easy["remedies"], easy["binding"]) == ([], [])
    assert set(far["binding"][0]) >= {"constraint", "segment", "obstacle", "value", "limit"}


def test_an_interrupt_of_the_explanation_leaves_the_answer(
    capsys: pytest.CaptureFixture[str], problem: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sinuous.answer.solution import Solution

    def interrupted(self: Any, time: float = 2.0) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Solution, "explain", interrupted)
    assert main(["solve", problem("far.yaml"), "--why", "--json"]) == 130
    assert strict(capsys.readouterr().out)["status"] == "out_of_reach"


def test_shapes_are_remembered_from_one_command_to_the_next(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    file, memory = problem("scene.yaml"), str(tmp_path / "arm.npz")
    found = []
    for _ in range(2):
        assert main(["solve", file, "--json", "--memory", memory]) == 0
        found.append(strict(capsys.readouterr().out))
    assert [each["start"] for each in found] == [found[0]["start"], "remembered"]
    assert found[0]["start"] != "remembered"
    assert main(["plan", file, "--memory", memory]) == 2  # it has no start
    assert main(["track", problem("path.yaml"), "--memory", memory]) == 0
    assert not list(tmp_path.glob(".*"))


def test_shapes_of_another_robot_and_what_is_no_memory_are_refused(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    other, memory = tmp_path / "other.yaml", tmp_path / "arm.npz"
    other.write_text("robot: {segments: {count: 2, length: 1, max_bend: 2}}\ntarget: {position: [1, 0, 1]}\n")
    assert main(["solve", problem("easy.yaml"), "--memory", str(memory)]) == 0
    capsys.readouterr()
    assert main(["solve", str(other), "--memory", str(memory)]) == 2
    assert "--memory: " in (said := capsys.readouterr().err)
    assert "of another robot" in said
    memory.write_text("no shapes")
    assert main(["solve", problem("easy.yaml"), "--memory", str(memory)]) == 2
    assert "--memory: " in (said := capsys.readouterr().err)
    assert len(said.splitlines()) == 1
    assert memory.read_text() == "no shapes"
