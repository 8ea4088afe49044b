"""Every section measures what it says, on a small run."""

import pytest

from benchmarks.derivatives import agreement, calibration, costs
from benchmarks.derivatives.experiment import SECTIONS, OfDerivatives
from benchmarks.harness.plan import Plan

PLAN = Plan(quick=True)


def test_all_sections_are_there() -> None:
    names = [name for name, _ in OfDerivatives(PLAN).parts()]
    assert list(dict.fromkeys(name.partition(" ")[0] for name in names)) == list(SECTIONS)
    assert [name for name in names if name.startswith("agreement")] == [
        f"agreement {family}" for family in agreement.COMPARED
    ]


@pytest.mark.parametrize("family", ["free", "clearances", "preferred", "under load"])
def test_differences_of_each_family_agree(family: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agreement, "BESIDE", 1)
    regular, wrong, worst = agreement.measure(PLAN, family)
    assert regular.reached > 50.0
    assert wrong.reached == 0.0
    assert worst.reached < agreement.WRONG


def test_a_calibration_ends_at_the_hidden_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration, "by_differences", calibration.by_derivatives)
    lines = list(calibration.measure(PLAN))
    assert [line.reached < 1e-6 for line in lines if "error" in line.what] == [True, True]


def test_costs_have_a_line_each(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(costs, "REPEATS", 1)
    assert len(list(costs.measure(PLAN))) == 4
