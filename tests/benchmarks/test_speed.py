"""The bench as a whole: it runs, prints what it should, and says it when something is wrong."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from benchmarks import speed
from benchmarks.answers import solve_all
from benchmarks.inner import inner_times
from benchmarks.peers import Ipopt, LeastSquares, start_of
from benchmarks.plan import Plan
from benchmarks.problems import arm, paper_poses, reachable, relative_tolerance
from benchmarks.report import Goal, Line, Report
from benchmarks.sections import cold, endurance, honesty
from benchmarks.timing import Times, exponent
from sinuous.errors import InputError
from sinuous.solution.solution import Solution
from sinuous.solving.solver import Solver


def test_times_are_summarised() -> None:
    times = Times.of(np.arange(1, 101))
    assert (times.count, times.median, times.worst) == (100, 50.5, 100.0)
    assert times.p95 == pytest.approx(95.05)
    assert times.p99 == pytest.approx(99.01)


def test_exponent_is_the_slope() -> None:
    sizes = (5, 10, 20, 40)
    assert exponent(sizes, [3e-6 * n**1.3 for n in sizes]) == pytest.approx(1.3)


def test_goals_can_be_missed() -> None:
    assert Goal(1.0).held(1.0)
    assert not Goal(1.0).held(1.1)
    assert not Goal(50.0, at_most=False).held(49.0)
    assert not Goal(50.0).held(math.nan)


def test_only_correctness_makes_a_report_wrong() -> None:
    slow = Line("s", "slow", 2.0, "s", Goal(1.0))
    wrong = Line("s", "wrong", 1, "", Goal(0, correctness=True), note="seed 7")
    assert Report({}, 0, False, [slow]).correct
    report = Report({}, 0, False, [slow, wrong])
    assert not report.correct
    assert "missed" in report.to_text()
    assert "WRONG" in report.to_text()
    assert "seed 7" in report.to_text()


def test_what_is_not_finite_is_null_in_json() -> None:
    line = Line("s", "broken", math.inf, "s", Goal(1.0), Times(0, *[math.nan] * 4))
    (written,) = json.loads(Report({}, 0, False, [line]).to_json())["lines"]
    assert written["reached"] is None
    assert written["times"]["median"] is None
    assert written["held"] is False


@pytest.mark.parametrize("section", ["paper", "reachable", "poses", "growth", "fields"])
def test_sections_run_and_hold(section: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert speed.run(quick=True, json=True, sections=[section]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["correct"]
    assert report["quick"]
    assert all(line["reached"] > 0.0 for line in report["lines"])


def test_cold_starts_are_all_confirmed() -> None:
    lines = list(cold.measure(Plan(quick=True)))
    assert len(lines) == 8
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


def test_an_answer_off_its_target_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Solver.solve

    def careless(self: Solver, target: object) -> Solution:
        solution = honest(self, target)  # type: ignore[arg-type]
        solution.q[0, 0] += 1e-3
        return solution

    monkeypatch.setattr(Solver, "solve", careless)
    answers = solve_all(Plan(), paper_poses(), "careless")
    assert answers.claimed.all()
    assert not answers.confirmed.any()
    assert "FALSE: 0, 1, 2, 3" in answers.complaint


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


def test_the_compiled_loop_solves_the_same_problem() -> None:
    asked = paper_poses()
    run = inner_times(asked, 3)
    solver = Solver(asked.robot, tolerance=asked.tolerance)
    assert run.solved.all()
    assert (run.seconds > 0.0).all()
    np.testing.assert_array_equal(run.q, [solver.solve(target).q for target in asked.targets])


def test_peers_solve_an_easy_problem_from_the_same_start() -> None:
    drawn = reachable(arm(3, 1.0), 3, np.random.default_rng(0))
    asked = drawn.with_tolerance(relative_tolerance(drawn.robot, 1e-6))
    assert start_of(asked.robot, asked.targets[0]).shape == (9,)
    for peer in (LeastSquares(asked), LeastSquares(asked, dogbox=True), Ipopt(asked), Ipopt(asked, equalities=True)):
        solved = 0
        for target in asked.targets:
            q, seconds = peer.solve(target)
            assert seconds > 0.0
            assert target.position is not None
            solved += bool(np.linalg.norm(asked.robot.tip(q)[:3, 3] - target.position) < 1e-3)
        assert solved >= 2


def test_the_jacobian_given_to_scipy_is_right() -> None:
    asked = reachable(arm(3, 1.0), 1, np.random.default_rng(0))
    peer, (target,) = LeastSquares(asked), asked.targets
    goal = np.array(target.position) + 100.0, np.array(target.direction)
    x = start_of(asked.robot, target) + 0.1
    numeric = np.empty((6, 9))
    for i in range(9):
        step = 1e-6 * np.eye(9)[i]
        numeric[:, i] = (peer._residual(x + step, *goal) - peer._residual(x - step, *goal)) / 2e-6
    np.testing.assert_allclose(peer._jacobian(x, *goal), numeric, atol=1e-7)


def test_an_interrupted_run_writes_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: Plan, __: object) -> Iterator[Line]:
        yield Line("s", "first", 1e-6)
        raise KeyboardInterrupt

    monkeypatch.setattr(speed, "_lines", interrupted)
    file = tmp_path / "report.json"
    assert speed.run(quick=True, out=file) == 1
    written = json.loads(file.read_text())
    assert written["interrupted"]
    assert [line["what"] for line in written["lines"]] == ["first"]
    assert "Interrupted" in capsys.readouterr().out


def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "NEEDED", {"no_such_module_here": "no-such-package"})
    with pytest.raises(InputError, match="no-such-package"):
        speed.run(quick=True)
