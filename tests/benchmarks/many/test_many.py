"""Every section measures what it says, on a small run."""

import math

import pytest

from benchmarks.harness.plan import Plan
from benchmarks.many import files, workspace
from benchmarks.many.experiment import SECTIONS, Many

PLAN = Plan(quick=True)


def test_all_sections_are_there() -> None:
    assert [name for name, _ in Many(PLAN).parts()] == list(SECTIONS)


def test_rates_and_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    kind = "poses among 40 spheres, proved"
    monkeypatch.setattr(files, "KINDS", {kind: files.KINDS[kind]})
    rate, memory = files.measure(PLAN)
    assert rate.solved is not None
    assert rate.solved[0] > 0.8 * rate.solved[1]
    assert rate.reached > 0.0
    assert 0.0 < memory.reached < math.inf


def test_no_proof_of_a_map_is_refuted() -> None:
    lines = list(workspace.measure(PLAN))
    assert [line.reached for line in lines if line.correctness] == [0.0, 0.0]
