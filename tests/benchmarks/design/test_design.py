"""The contest of designs measures what it says, on a small run."""

import numpy as np
import pytest

from benchmarks.design import contest
from benchmarks.design.experiment import SECTIONS, OfDesigns
from benchmarks.design.problems import TASKS, problem
from benchmarks.harness.plan import Plan

PLAN = Plan(quick=True)


def test_all_sections_are_there() -> None:
    assert [name for name, _ in OfDesigns(PLAN).parts()] == list(SECTIONS)


def test_the_design_is_no_worse_than_the_template(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = problem(0, np.random.default_rng(0))
    assert len(asked.tasks) == TASKS
    monkeypatch.setattr(contest, "problem", lambda *_: asked)
    lines = list(contest.measure(PLAN))
    assert next(line.reached for line in lines if line.what == "better than the template") == 1.0
