"""Many small worlds: what is counted, what is named, and that an interrupted run goes on."""

import json
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from benchmarks.clutter import worlds
from benchmarks.clutter.trials import Attempt, Task, Trial
from benchmarks.clutter.worlds import Worlds, summed
from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.plan import Plan

RIGHT = Attempt(1e-5, 1e-5, "solved", "arc", True, True)
LIE = Attempt(1e-5, 1e-5, "solved", "arc", True, False)
EXCUSE = Attempt(1e-5, 1e-5, "no_route", "arc", False, False)
LATE = Attempt(1.5, 1.5, "solved", "route", True, True)


def trial(number: int, ours: Attempt) -> Trial:
    return Trial("small world", number, 1e-3, ours, None, {})


def test_what_is_wrong_is_counted_and_named() -> None:
    tried = [RIGHT, LIE, EXCUSE, LATE, RIGHT]
    piece = json.loads(json.dumps(summed([trial(i, ours) for i, ours in enumerate(tried)])))
    (first, _), (second, _) = islice(Worlds(Plan()).pieces(), 2)
    measured = {second: {"busy": 0.2, **summed([trial(107, RIGHT)])}, first: {"busy": 0.0, **piece}}
    found = Worlds(Plan()).findings(measured)
    assert found.busy == 0.2
    assert not found.correct
    solved, lies, excuses = found.lines
    assert solved.solved == (3, 6)
    assert "not solved: 1 (solved), 2 (no_route), 3 (solved)" in solved.note
    assert (lies.reached, excuses.reached) == (1, 1)
    assert "1 (solved)" in lies.note
    assert "2 (no_route)" in excuses.note


def test_every_world_has_a_number_of_its_own() -> None:
    for seed in (0, 3):
        names = [name for name, _ in Worlds(Plan(seed=seed)).pieces()]
        assert len(set(names)) == len(names) == worlds.COUNT // worlds.TOGETHER
        assert names[0].startswith(f"worlds {100_000 * seed} to ")


def test_an_interrupted_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done: list[int] = []

    def examined(task: Task) -> Trial:
        if task.seed == 130 and len(done) < 200:
            done.extend([-1] * 200)
            raise KeyboardInterrupt
        done.append(task.seed)
        return trial(task.seed, RIGHT)

    monkeypatch.setattr(worlds, "examine", examined)
    experiment: Any = Worlds(Plan(quick=True))
    assert conduct(experiment, Output(tmp_path)) == INTERRUPTED
    assert conduct(experiment, Output(tmp_path)) == 0
    assert done.count(5) == 1  # of the piece that was whole
    assert done.count(199) == 1
    assert json.loads((tmp_path / "worlds.json").read_text())["lines"][0]["solved"] == [200, 200]
    assert "Interrupted" in capsys.readouterr().out
