"""`python -m benchmarks NAME`: what may be typed."""

from pathlib import Path
from typing import Any

import pytest

from benchmarks import harness
from benchmarks.__main__ import KNOWN, experiment, main
from benchmarks.harness import Plan
from tests.helpers import with_each


def test_options_reach_the_measurement(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    given: list[Any] = []

    def conduct(*both: Any) -> int:
        given.extend(both)
        return 130

    monkeypatch.setattr(harness, "conduct", conduct)
    line = ["speed", "--quick", "--seed", "3", "--out", str(tmp_path / "speed"), "--piece", "po*"]
    assert main([*line, "--record", str(tmp_path)]) == 130
    made, *folders = given
    assert (made.name, made.plan, list(made.parts)) == ("speed", Plan(3, True), ["poses"])
    assert folders == [tmp_path / "speed", tmp_path]


@with_each("name", KNOWN)
def test_every_name_has_an_experiment_of_that_name(name: str) -> None:
    made = experiment(name, Plan(5))
    assert (made.name, made.plan.seed) == (name, 5)
    names = [piece for piece, _ in made.pieces()]
    assert len(names) == len(set(names)) > 0


@with_each(
    ("name", "pattern", "first"),
    [
        ("speed", "poses", "poses"),
        ("clutter", "pipe 1.6", "pipe 1.6"),
        ("motion", "P5, 3*", "P5, 3 segments"),
        ("wild", "arms with*", "arms with joints"),
    ],
)
def test_parts_are_those_that_a_pattern_fits(name: str, pattern: str, first: str) -> None:
    everything = [piece for piece, _ in experiment(name, Plan()).pieces()]
    some = [piece for piece, _ in experiment(name, Plan(), (pattern,)).pieces()]
    assert some[0] == first
    assert some == [piece for piece in everything if piece in some]
    assert len(some) < len(everything)


@with_each(
    ("arguments", "named"),
    [
        (["nothing"], "NAME"),
        (["table1", "--piece", "p3"], "--piece"),
        (["table1", "--seed", "-1"], "--seed"),
        (["clutter", "--piece", "labyrinth"], "--piece"),
        (["speed", "--fast"], "--fast: unknown option"),
        ([], "NAME: missing"),
    ],
)
def test_what_cannot_be_meant_is_said_in_one_line(
    arguments: list[str], named: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert named in captured.err
    assert captured.err.count("\n") == 1
    assert not (tmp_path / "out").exists()
