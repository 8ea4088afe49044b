"""`python -m benchmarks NAME`: what may be typed."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks.__main__ import KNOWN, OF_LINES, OF_METHODS, TOOLS, Asked, main
from benchmarks.harness import conduct as harness
from benchmarks.harness.conduct import Output
from benchmarks.trace import files_of, scenarios
from tests.cases import with_each

Given = list[tuple[Asked, Output]]


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Given:
    """What would be measured, and what would become of it; the exit code is 130."""
    seen: Given = []

    def conduct(experiment: Any, output: Output) -> int:
        seen.append((experiment, output))
        return 130

    monkeypatch.setattr(harness, "conduct", conduct)
    monkeypatch.setattr(Asked, "experiment", lambda self: self)
    return seen


def test_options_reach_the_measurement(given: Given, tmp_path: Path) -> None:
    out, before, after = tmp_path / "speed", tmp_path / "before.json", tmp_path / "after.json"
    line = ["speed", "--json", "--quick", "--seed", "3", "--rounds", "2", "--out", str(out), "--anew", "--piece", "p*"]
    assert main([*line, "--against", str(before), "--save-baseline", str(after), "--record", str(tmp_path)]) == 130
    wanted = Output(out, True, True, before, after, whole=False, record=tmp_path)
    assert given == [(Asked("speed", 3, True, 2, ("p*",)), wanted)]


@with_each("name", KNOWN)
def test_every_name_has_an_experiment_of_that_name(name: str) -> None:
    made = Asked(name, seed=5).experiment()
    assert (made.name, made.plan.seed) == (name, 5)
    assert made.divisible is (name in OF_LINES)
    names = [piece for piece, _ in made.pieces()]
    assert len(names) == len(set(names)) > 0


@with_each(
    ("name", "pattern", "first"),
    [
        ("speed", "paper", "paper, round 0"),
        ("clutter", "pipe 1.6", "pipe 1.6, round 0"),
        ("motion", "P5, 3*", "P5, 3 segments, round 0"),
        ("wild", "? segments", "3 segments, round 0"),
    ],
)
def test_parts_are_those_that_a_pattern_fits(name: str, pattern: str, first: str) -> None:
    everything = [piece for piece, _ in Asked(name).experiment().pieces()]
    some = [piece for piece, _ in Asked(name, parts=(pattern,)).experiment().pieces()]
    assert some[0] == first
    assert some == [piece for piece in everything if piece in some]
    assert len(some) < len(everything)


def test_help_says_what_each_name_measures(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(f"  {name}: {known.about}\n" in out for name, known in KNOWN.items())
    assert all(f"  {name}: {about}\n" in out for name, (_, about) in TOOLS.items())
    assert main(["worlds", "--help"]) == 0
    assert f"Measure worlds: {KNOWN['worlds'].about}." in " ".join(capsys.readouterr().out.split())


@with_each(
    ("arguments", "named"),
    [
        (["nothing"], "NAME"),
        (["speed", "--method", "dls"], "--method"),
        (["table1", "--piece", "p3"], "--piece"),
        (["table1", "--rounds", "2"], "--rounds"),
        (["table1", "--against", "a.json"], "--against"),
        (["table1", "--save-baseline", "a.json"], "--save-baseline"),
        (["wild", "--without", "gates"], "--without"),
        (["clutter", "--quick", "--without", "hops"], "without"),
        (["speed", "--only", "3.1"], "--only"),
        (["wild", "--only", "three"], "--only"),
        (["wild", "--only", "3.48"], "--only"),
        (["speed", "--rounds", "0"], "--rounds"),
        (["speed", "--against", "nowhere.json"], "--against"),
        (["speed", "--save-baseline", "/nowhere/speed.json"], "--save-baseline"),
        (["table1", "--seed", "-1"], "--seed"),
        (["table1", "--method", "magic"], "method"),
        (["clutter", "--piece", "labyrinth"], "--piece"),
        (["speed", "--fast"], "No such option: --fast"),
        ([], "Missing argument 'NAME'"),
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


@with_each(
    ("arguments", "named"),
    [
        (["ways", "magic"], "NAME"),
        (["ways", "ablation", "--count", "0"], "--count"),
        (["ways", "ablation", "--piece", "hop"], "--piece"),
        (["places", "labyrinth", "0"], "FAMILY"),
        (["places", "shelf", "--", "-1"], "NUMBER"),
        (["places", "shelf", "0", "--picture", "/nowhere/a.png"], "--picture"),
        (["places", "--picture", "a.xyz"], "--picture"),
    ],
)
def test_other_commands_say_it_as_well(arguments: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert named in said
    assert said.count("\n") == 1


def test_problems_of_wild_are_looked_at_again(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["wild", "--only", "3.1"]) == 0
    assert "  3.1: " in capsys.readouterr().out


def test_threads_are_set_before_numpy_looks() -> None:
    code = """
import os, sys
from benchmarks.__main__ import Asked, main
assert main(["--help"]) == 0
assert "numpy" not in sys.modules
Asked.check = lambda *_: print(os.environ["OMP_NUM_THREADS"], "numpy" in sys.modules) or sys.exit(7)
main(["speed"])
"""
    environment = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 7, done.stderr
    assert done.stdout.splitlines()[-1] == "1 False"
    assert all(name in done.stdout for name in (*OF_LINES, *OF_METHODS))


def test_files_that_run_are_those_that_are_entered_not_only_imported(tmp_path: Path) -> None:
    files = files_of(scenarios(tmp_path)["an easy solve"])
    assert any(name.endswith("solver.py") for name in files)
    assert "cli/app.py" in files
    assert not any("viewer" in name or "plan.py" in name for name in files)
