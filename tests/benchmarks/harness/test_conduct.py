"""An experiment that is interrupted goes on where it was, and what it writes is what it would have written."""

import dataclasses
import json
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from benchmarks.harness import conduct as harness
from benchmarks.harness import reference
from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.experiment import Findings, Indivisible, Measurement, OfLines, Piece
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.reference import Look
from benchmarks.pictures.style import new_figure, tidy
from sinuous.base.errors import InputError


@pytest.fixture(autouse=True)
def steady(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that is always equally fast."""
    monkeypatch.setattr(reference, "look", lambda: Look(5e-4, 0.0))


class Squares(Indivisible):
    """Three pieces of work; one of them may be interrupted."""

    name = "squares"

    def __init__(self, plan: Plan, *, interrupted_at: int = -1, wrong: int = 0) -> None:
        self.plan = plan
        self.interrupted_at = interrupted_at
        self.wrong = wrong
        self.measured: list[int] = []

    def settings(self) -> dict[str, Any]:
        return {"count": 3}

    def pieces(self) -> Iterable[Piece]:
        for i in range(3):
            yield f"piece {i}", partial(self.measure, i)

    def measure(self, i: int) -> float:
        if i == self.interrupted_at:
            raise KeyboardInterrupt
        self.measured.append(i)
        return float(i * i)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        figure = new_figure(3.0, 2.0)
        axes = figure.add_subplot()
        tidy(axes, "squares")
        axes.plot(list(pieces.values()))
        text = "![squares](squares_plot.png) " + str(list(pieces.values()))
        data = {"squares": list(pieces.values())}
        return Findings(text=text, data=data, pictures={"squares_plot": figure}, wrong=self.wrong)


class Steps(OfLines):
    """Two parts of one line each, the second of which takes as long as is said, or breaks."""

    def __init__(self, plan: Plan, ends: Iterable[float | BaseException] = (2e-3,)) -> None:
        super().__init__("steps", plan)
        self.ends = iter(ends)
        self.measured: list[str] = []

    def parts(self) -> Iterable[tuple[str, Measurement]]:
        yield "first", self.first
        yield "second", self.second

    def first(self) -> Iterable[Line]:
        self.measured.append("first")
        yield Line("steps", "first", 1e-3, "ms", Goal(1.0), solved=(9, 10))

    def second(self) -> Iterable[Line]:
        end = next(self.ends)
        if isinstance(end, BaseException):
            raise end
        self.measured.append("second")
        yield Line("steps", "second", end, "ms")


def test_results_are_written_and_say_where_they_come_from(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conduct(Squares(Plan(7)), Output(tmp_path, record=tmp_path)) == 0
    written = json.loads((tmp_path / "squares.json").read_text())
    assert written["squares"] == [0.0, 1.0, 4.0]
    assert written["seed"] == 7
    assert written["settings"] == {"count": 3}
    assert {"processor", "python", "numba", "sinuous"} <= set(written["machine"])
    text = (tmp_path / "squares.md").read_text()
    assert (tmp_path / "squares.txt").read_text() == f"# squares\n\n{text}"
    assert "- processor: " in text
    assert "- seed: 7" in text
    assert "[0.0, 1.0, 4.0]" in text
    assert (tmp_path / "squares_plot.png").read_bytes().startswith(b"\x89PNG")
    shown = capsys.readouterr()
    assert shown.out == text
    assert "results are in" in shown.err


def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = Output(tmp_path, json=True)
    first = Squares(Plan(), interrupted_at=1)
    assert conduct(first, output) == INTERRUPTED
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "interrupted after 1 of 3 pieces" in shown.err
    assert not (tmp_path / "squares.json").exists()
    second = Squares(Plan())
    assert conduct(second, output) == 0
    assert (first.measured, second.measured) == ([0], [1, 2])
    assert json.loads(capsys.readouterr().out)["squares"] == [0.0, 1.0, 4.0]
    third = Squares(Plan())
    assert conduct(third, output) == 0
    assert third.measured == []
    assert "all of this was measured before; --anew measures it again" in capsys.readouterr().err
    fourth = Squares(Plan())
    assert conduct(fourth, dataclasses.replace(output, anew=True)) == 0
    assert fourth.measured == [0, 1, 2]


@pytest.mark.parametrize("end", [KeyboardInterrupt(), ZeroDivisionError()], ids=["interrupted", "broken"])
def test_lines_that_were_measured_are_given_whatever_ends_a_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], end: BaseException
) -> None:
    output = Output(tmp_path, save_baseline=tmp_path / "baseline.json")
    if isinstance(end, KeyboardInterrupt):
        assert conduct(Steps(Plan(), [end]), output) == INTERRUPTED
    else:
        with pytest.raises(ZeroDivisionError):
            conduct(Steps(Plan(), [end]), output)
    written = json.loads((tmp_path / "steps.json").read_text())
    assert written["interrupted"]
    assert [line["what"] for line in written["lines"]] == ["first"]
    assert "Interrupted" in capsys.readouterr().out
    assert not (tmp_path / "baseline.json").exists()
    again = Steps(Plan())
    assert conduct(again, output) == 0
    assert again.measured == ["second"]
    written = json.loads((tmp_path / "steps.json").read_text())
    assert not written["interrupted"]
    assert [line["what"] for line in written["lines"]] == ["first", "second"]


def test_rounds_are_measured_one_after_the_other_and_may_be_added(tmp_path: Path) -> None:
    conduct(Steps(Plan()), Output(tmp_path))
    more = Steps(Plan(rounds=3), [5e-3, 3e-3])
    assert conduct(more, Output(tmp_path)) == 0
    assert more.measured == ["first", "second"] * 2
    first, second = json.loads((tmp_path / "steps.json").read_text())["lines"]
    assert second["rounds"] == [2e-3, 5e-3, 3e-3]
    assert second["reached"] == 3e-3
    assert second["spread"] == pytest.approx(1.0)
    assert first["spread"] == 0.0
    assert second["reference"] == 5e-4
    assert " spread |" in (tmp_path / "steps.md").read_text()


def test_a_busy_machine_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looks = iter([Look(5e-4, 0.0), Look(5e-4, 0.3), Look(5e-4, 0.05), Look(5e-4, 0.0)])
    monkeypatch.setattr(reference, "look", lambda: next(looks))
    assert conduct(Steps(Plan()), Output(tmp_path)) == 0
    assert "BUSY: other processes had up to 30 % of the processor" in (tmp_path / "steps.md").read_text()
    assert json.loads((tmp_path / "steps.json").read_text())["busy"] == 0.3


def test_a_baseline_is_kept_and_compared_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    baseline = tmp_path / "baseline.json"
    assert conduct(Steps(Plan()), Output(tmp_path / "a", save_baseline=baseline)) == 0
    same = Output(tmp_path / "a", against=baseline)
    assert conduct(Steps(Plan()), same) == 0
    assert "2 figures compared: 0 worse, 0 better" in capsys.readouterr().out
    slower = Output(tmp_path / "b", against=baseline, json=True)
    steps = Steps(Plan(), [2e-2, 2.2e-2, 2.1e-2])
    assert conduct(steps, slower) == 1
    assert steps.measured == ["first", "second", "second", "second"]
    (change,) = json.loads(capsys.readouterr().out)["against"]["changes"]
    assert (change["what"], change["before"], change["now"], change["worse"]) == ("second", "2 ms", "21 ms", True)
    assert change["change"] == "x10"
    noisy = Steps(Plan(), [2e-2, 2.1e-3])
    assert conduct(noisy, Output(tmp_path / "d", against=baseline)) == 0
    assert noisy.measured == ["first", "second", "second"]
    assert "second, round 1: measured again, for something seems worse" in capsys.readouterr().err
    with pytest.raises(InputError, match="--against: expected a baseline measured with seed 1, got 0"):
        conduct(Steps(Plan(1)), Output(tmp_path / "c", against=baseline))
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize("plan", [Plan(1), Plan(0, quick=True)])
def test_another_seed_or_size_is_another_experiment(tmp_path: Path, plan: Plan) -> None:
    conduct(Squares(Plan()), Output(tmp_path, json=True))
    with pytest.raises(InputError, match=r"^--out: .*--anew, got .* \((seed was 0, is 1|quick was False, is True)\)$"):
        conduct(Squares(plan), Output(tmp_path, json=True))


def test_a_wrong_claim_is_an_exit_code(tmp_path: Path) -> None:
    assert conduct(Squares(Plan(), wrong=2), Output(tmp_path, json=True)) == 1
    assert "WRONG: 2 claims" in (tmp_path / "squares.md").read_text()


def test_without_a_folder_its_name_is_that_of_the_experiment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert conduct(Squares(Plan()), Output(json=True)) == 0
    assert (tmp_path / "bench-squares" / "squares.md").exists()


def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    harness.require()
    monkeypatch.setattr(harness, "NEEDED", {"no_such_module_here": "no-such-package"})
    with pytest.raises(InputError, match="no-such-package"):
        harness.require()
