"""Answers count when a judge confirms them."""

import pytest

from benchmarks.harness.plan import Plan
from benchmarks.problems import paper_poses
from benchmarks.solvers.answers import solve_all
from sinuous.answer.solution import Solution
from sinuous.solver.solver import Solver
from tests.benchmarks.tampering import moved


def test_an_answer_off_its_target_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Solver.solve

    def careless(self: Solver, target: object) -> Solution:
        solution = honest(self, target)  # type: ignore[arg-type]
        return moved(solution, (0, 0), 1e-3)

    monkeypatch.setattr(Solver, "solve", careless)
    answers = solve_all(Plan(), paper_poses(), "careless")
    assert answers.claimed.all()
    assert not answers.confirmed.any()
    assert "FALSE: 0, 1, 2, 3" in answers.complaint
