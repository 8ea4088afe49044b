"""The experiment as a whole: it runs, prints what it should, and says it when something is wrong."""

import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.problems import full_poses, paper_poses
from benchmarks.speed import budgets, cold, endurance, honesty, paper
from benchmarks.speed.experiment import SECTIONS, Speed
from sinuous.answer.solution import Solution
from sinuous.solver.solver import Solver


def test_every_section_is_a_file() -> None:
    folder = Path(str(cold.__file__)).parent
    assert {file.stem for file in folder.glob("*.py")} == {*SECTIONS, "experiment", "__init__"}
    assert all(callable(import_module(f"benchmarks.speed.{name}").measure) for name in SECTIONS)


@pytest.mark.parametrize("section", ["paper", "reachable", "poses", "growth", "fields"])
def test_sections_run_and_hold(section: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert conduct(Speed(Plan(quick=True), [section]), Output(tmp_path, json=True)) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["correct"]
    assert report["quick"]
    reached = [line["reached"] for line in report["lines"]]
    assert min(reached) >= 0.0
    assert sum(value == 0.0 for value in reached) <= 1  # what a mesh adds to a solve is a difference


def test_cold_starts_are_all_confirmed() -> None:
    lines = list(cold.measure(Plan(quick=True)))
    assert len(lines) == 10
    assert [line.unit for line in lines[8:]] == ["%", "%"]
    assert all(0.0 < line.reached < 100.0 for line in lines[8:])
    assert all(line.solved is not None and line.solved[0] == line.solved[1] for line in lines)


def test_claims_are_examined() -> None:
    tally = honesty.examine(1)
    assert tally.claimed > 0
    assert tally.false == []
    assert tally.outside == []


def test_a_solver_that_lies_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Claims of a solver that calls everything solved are rejected, and counted as false."""
    monkeypatch.setattr(Solution, "solved", property(lambda _: True))
    monkeypatch.setattr(honesty, "TARGETS", 20)
    assert any(honesty.examine(seed).false for seed in range(5))


def test_budgets_are_asked_of_every_family(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = [family for family in budgets.FAMILIES if family[0] in ("free", "along a wall")]
    monkeypatch.setattr(budgets, "FAMILIES", chosen)
    lines = list(budgets.measure(Plan(quick=True)))
    assert [line.what.split(",")[0] for line in lines[::2]] == ["free", "along a wall", "all", "all"]
    assert "used up their budgets" in lines[2].note
    assert any(line.reached > 0.0 for line in lines)


def test_what_arrays_bring_is_measured() -> None:
    plan = Plan(quick=True)
    for problems in (full_poses(0, 10), paper_poses()):
        lines = list(endurance._arrays(plan, "poses", problems, None))
        assert [line.unit for line in lines] == ["/s", "/s", "x"]
        assert lines[2].reached == pytest.approx(lines[1].reached / lines[0].reached)
    seconds, memory = endurance._million(plan, paper_poses())
    assert 0.0 < seconds.reached < 60.0
    assert 8 * (15 + 11 + 6) < memory.reached < 1000


def test_a_leak_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Solver.solve
    kept: list[object] = []

    def forgetful(self: Solver, target: object) -> Solution:
        solution = honest(self, target)  # type: ignore[arg-type]
        kept.append((solution, bytearray(b"x") * 4000))
        return solution

    assert all(line.held for line in endurance._memory(Plan(quick=True), paper_poses()))
    monkeypatch.setattr(Solver, "solve", forgetful)
    monkeypatch.setattr(Plan, "count", lambda _self, full, _quick: full // 20)
    # What earlier tests have given back may take it all in, so that the process does not grow; Python's count does.
    _, traced = endurance._memory(Plan(), paper_poses())
    assert traced.held is False


def test_an_interrupted_run_writes_what_it_has_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ends: list[BaseException | None] = [KeyboardInterrupt(), None]

    def first(_: Plan) -> Iterator[Line]:
        yield Line("s", "first", 1e-6)

    def second(_: Plan) -> Iterator[Line]:
        yield Line("s", "second", 1e-6)
        end = ends.pop(0)
        if end is not None:
            raise end

    monkeypatch.setattr(cold, "measure", first)
    monkeypatch.setattr(paper, "measure", second)
    assert conduct(Speed(Plan(quick=True), ["cold", "paper"]), Output(tmp_path)) == INTERRUPTED
    written = json.loads((tmp_path / "speed.json").read_text())
    assert written["interrupted"]
    assert [line["what"] for line in written["lines"]] == ["first"]
    assert "Interrupted" in capsys.readouterr().out
    monkeypatch.setattr(cold, "measure", lambda _: pytest.fail("measured again"))
    assert conduct(Speed(Plan(quick=True), ["cold", "paper"]), Output(tmp_path)) == 0
    assert [line["what"] for line in json.loads((tmp_path / "speed.json").read_text())["lines"]] == ["first", "second"]
