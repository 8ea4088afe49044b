"""An experiment that is interrupted goes on where it was, and what it writes is what it would have written."""

import json
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from benchmarks.experiments import frame
from benchmarks.experiments.figures import new_figure, tidy
from benchmarks.experiments.frame import INTERRUPTED, Findings, Piece, conduct
from benchmarks.plan import Plan
from sinuous.errors import InputError


class Squares:
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
        return Findings(text, {"squares": list(pieces.values())}, {"squares_plot": figure}, self.wrong)


def test_results_are_written_and_say_where_they_come_from(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conduct(Squares(Plan(7)), tmp_path, json=False, anew=False) == 0
    written = json.loads((tmp_path / "squares.json").read_text())
    assert written["squares"] == [0.0, 1.0, 4.0]
    assert written["seed"] == 7
    assert {"processor", "python", "numba", "sinuous"} <= set(written["machine"])
    text = (tmp_path / "squares.md").read_text()
    assert "- processor: " in text
    assert "- seed: 7" in text
    assert "[0.0, 1.0, 4.0]" in text
    assert (tmp_path / "squares_plot.png").read_bytes().startswith(b"\x89PNG")
    shown = capsys.readouterr()
    assert shown.out == text
    assert "results are in" in shown.err


def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = Squares(Plan(), interrupted_at=1)
    assert conduct(first, tmp_path, json=True, anew=False) == INTERRUPTED
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "interrupted after 1 of 3 pieces" in shown.err
    assert not (tmp_path / "squares.json").exists()
    second = Squares(Plan())
    assert conduct(second, tmp_path, json=True, anew=False) == 0
    assert (first.measured, second.measured) == ([0], [1, 2])
    assert json.loads(capsys.readouterr().out)["squares"] == [0.0, 1.0, 4.0]
    third = Squares(Plan())
    assert conduct(third, tmp_path, json=True, anew=False) == 0
    assert third.measured == []
    fourth = Squares(Plan())
    assert conduct(fourth, tmp_path, json=True, anew=True) == 0
    assert fourth.measured == [0, 1, 2]


@pytest.mark.parametrize("plan", [Plan(1), Plan(0, quick=True)])
def test_another_seed_or_size_is_another_experiment(tmp_path: Path, plan: Plan) -> None:
    conduct(Squares(Plan()), tmp_path, json=True, anew=False)
    with pytest.raises(InputError, match="other settings"):
        conduct(Squares(plan), tmp_path, json=True, anew=False)


def test_a_wrong_claim_is_an_exit_code(tmp_path: Path) -> None:
    assert conduct(Squares(Plan(), wrong=2), tmp_path, json=True, anew=False) == 1
    assert "WRONG: 2 claims" in (tmp_path / "squares.md").read_text()


def test_without_a_folder_its_name_is_that_of_the_experiment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert conduct(Squares(Plan()), None, json=True, anew=False) == 0
    assert (tmp_path / "bench-squares" / "squares.md").exists()


def test_missing_packages_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frame, "NEEDED", {"no_such_module_here": "no-such-package"})
    with pytest.raises(InputError, match="no-such-package"):
        conduct(Squares(Plan()), tmp_path, json=True, anew=False)
