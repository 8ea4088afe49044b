"""`python -m benchmarks NAME`: what may be typed."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks import __main__ as command
from benchmarks.__main__ import ABOUT, BENCHMARKS, OF_LINES, OF_METHODS, OF_PARTS, Chosen, main
from benchmarks.harness import conduct as harness
from benchmarks.harness.conduct import Output
from sinuous.base.errors import warn_of
from tests.cases import with_each

Given = list[tuple[Chosen, Output]]

LINES = "speed, clutter, wild, many, motion, derivatives, design, real"


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Given:
    """What would be measured, and what would become of it; the exit code is 130."""
    seen: Given = []

    def conduct(experiment: Any, output: Output) -> int:
        seen.append((experiment, output))
        return 130

    monkeypatch.setattr(harness, "conduct", conduct)
    monkeypatch.setattr(Chosen, "experiment", lambda self: self)
    return seen


def test_options_reach_the_measurement(given: Given, tmp_path: Path) -> None:
    out, before, after = tmp_path / "speed", tmp_path / "before.json", tmp_path / "after.json"
    line = ["speed", "--json", "--quick", "--seed", "3", "--rounds", "2", "--out", str(out), "--anew"]
    assert main([*line, "--against", str(before), "--save-baseline", str(after)]) == 130
    assert given == [(Chosen("speed", 3, True, 2), Output(out, True, True, before, after))]


@pytest.mark.parametrize("name", BENCHMARKS)
def test_nothing_needs_to_be_said_but_the_name(given: Given, name: str) -> None:
    assert main([name]) == 130
    assert given == [(Chosen(name), Output())]


def test_odd_problems_are_not_complained_of(monkeypatch: pytest.MonkeyPatch) -> None:
    def conduct(experiment: Any, output: Output) -> int:
        warn_of(["odd"])  # an error, in a test
        return 0

    monkeypatch.setattr(harness, "conduct", conduct)
    monkeypatch.setattr(Chosen, "experiment", lambda self: self)
    assert main(["speed"]) == 0


@pytest.mark.parametrize("name", OF_PARTS)
def test_parts_can_be_chosen(given: Given, name: str) -> None:
    assert main([name, "--piece", "p3", "--piece", "drum*"]) == 130
    assert given == [(Chosen(name, parts=("p3", "drum*")), Output(whole=False))]


@with_each(
    ("name", "pattern", "first"),
    [
        ("speed", "paper", "paper"),
        ("clutter", "pipe 1.6", "pipe 1.6, 1 of 12, round 0"),
        ("motion", "P5, 3*", "P5, 3 segments, round 0"),
        ("many", "*", "files, round 0"),
        ("view", "d*", "drags, round 0"),
        ("wild", "? segments", "3 segments"),
    ],
)
def test_parts_are_those_that_a_pattern_fits(name: str, pattern: str, first: str) -> None:
    everything = [piece for piece, _ in Chosen(name).experiment().pieces()]
    some = [piece for piece, _ in Chosen(name, parts=(pattern,)).experiment().pieces()]
    assert some[0].startswith(first)
    assert some == [piece for piece in everything if piece in some]
    assert len(some) < len(everything) or pattern == "*"


@pytest.mark.parametrize("name", OF_PARTS)
def test_no_part_is_made_up(name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main([name, "--piece", "labyrinth", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("--piece: expected a pattern like 'P5*', or one of ")
    assert said.endswith("; got 'labyrinth'\n") or said.endswith(", got 'labyrinth'\n")
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["table1", "tracking", "segments", "methods"])
def test_options_reach_the_experiments(given: Given, tmp_path: Path, name: str) -> None:
    line = [name, "--quick", "--anew", "--out", str(tmp_path), "--method", "dls", "--method", "newton"]
    assert main(line) == 130
    assert given == [(Chosen(name, quick=True, methods=("dls", "newton")), Output(tmp_path, anew=True))]


def test_help_says_what_each_name_measures(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(ABOUT) == list(BENCHMARKS)
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(f"  {name}: {about}\n" in out for name, about in ABOUT.items())
    for name, about in ABOUT.items():
        assert main([name, "--help"]) == 0
        words = " ".join(capsys.readouterr().out.split())
        assert f"Measure {name}: {about}." in words
        assert not any(other in words for key, other in ABOUT.items() if key != name)


@with_each("name", BENCHMARKS)
def test_every_name_has_an_experiment_of_that_name(name: str) -> None:
    made = Chosen(name, seed=5).experiment()
    assert (made.name, made.plan.seed) == (name, 5)
    assert made.divisible is (name in (*OF_LINES, "worlds", "view"))


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (
            ["nothing"],
            f"NAME: expected one of {', '.join(BENCHMARKS)}, got 'nothing'\n",
        ),
        (["speed", "--method", "dls"], "--method: expected nothing with speed, got ['dls'] (is for table1, tracking, "),
        (["clutter", "--method", "dls"], "--method: expected nothing with clutter, got ['dls'] (is for table1, "),
        (
            ["table1", "--piece", "p3"],
            "--piece: expected nothing with table1, got ['p3'] (is for " + LINES + ", view)",
        ),
        (
            ["table1", "--rounds", "2"],
            "--rounds: expected nothing with table1, got 2 (is for " + LINES + ")",
        ),
        (
            ["table1", "--against", "a.json"],
            "--against: expected nothing with table1, got 'a.json' (is for " + LINES + ")",
        ),
        (
            ["table1", "--save-baseline", "a.json"],
            "--save-baseline: expected nothing with table1, got 'a.json' (is for " + LINES + ")",
        ),
        (["speed", "--rounds", "0"], "--rounds"),
        (
            ["speed", "--against", "nowhere.json"],
            "--against: expected a file that --save-baseline wrote, got 'nowhere.json' (cannot be read: ",
        ),
        (
            ["speed", "--save-baseline", "/nowhere/speed.json"],
            "--save-baseline: expected a file that can be written, got '/nowhere/speed.json' (",
        ),
        (["table1", "--seed", "-1"], "--seed"),
        (["table1", "--method", "magic"], "method: expected one of newton, opti_path, dls, "),
        (["clutter", "--piece", "labyrinth"], "--piece: expected a pattern like 'P5*', or one of spheres 12; spheres "),
        (["speed", "--fast"], "python -m benchmarks: No such option: --fast"),
        ([], "python -m benchmarks: Missing argument 'NAME'"),
    ],
)
def test_what_cannot_be_meant_is_said(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(complaint)
    assert captured.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_that_is_a_file_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "speed.json").touch()
    assert main(["speed", "--out", str(tmp_path / "speed.json")]) == 2
    assert capsys.readouterr().err.startswith("--out: expected a folder, got '")


def test_problems_to_look_at_are_for_wild_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["speed", "--only", "3.1"]) == 2
    assert capsys.readouterr().err.startswith("--only: expected nothing with speed, got ['3.1'] (is for wild)")
    assert main(["wild", "--only", "3.1", "--seed", "0"]) == 0
    assert "3.1: " in capsys.readouterr().out
    assert main(["wild", "--only", "three"]) == 2
    assert "--only: expected WORLD.PROBLEM" in capsys.readouterr().err


def test_an_interrupt_before_anything_was_measured_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: Chosen) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Chosen, "experiment", interrupted)
    assert main(["speed"]) == command.INTERRUPTED
    assert "interrupted before anything was measured" in capsys.readouterr().err


def test_help_names_every_benchmark_and_threads_are_set_before_numpy_looks() -> None:
    code = """
import os, runpy, sys
from benchmarks.__main__ import Chosen, main
assert main(["--help"]) == 0
assert "numpy" not in sys.modules
Chosen.check = lambda self: print(os.environ["OMP_NUM_THREADS"], "numpy" in sys.modules) or sys.exit(7)
main(["speed"])
"""
    environment = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 7, done.stderr
    assert done.stdout.splitlines()[-1] == "1 False"
    assert all(name in done.stdout for name in (*OF_LINES, *OF_METHODS))
