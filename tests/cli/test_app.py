"""What the shell is told: exit codes, one line on standard error, and quickly."""

import contextlib
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

import sinuous
from sinuous.cli import app
from sinuous.cli.app import main

Write = Callable[[str], str]


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(out.count(f"\n  {command} ") == 2 for command in ("solve", "track", "check", "view", "new", "warm"))
    assert "bench" not in out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"sinuous {sinuous.__version__}\n"


def test_the_entry_point_is_main() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    assert project["scripts"]["sinuous"] == f"{app.__name__}:{main.__name__}"


def test_the_module_is_the_command_and_help_imports_nothing_heavy() -> None:
    listed = "import sys, runpy; sys.argv = ['sinuous', '--help']\n"
    listed += "heavy = {'numpy', 'numba', 'scipy', 'rich', 'yaml'}\n"
    listed += "try: runpy.run_module('sinuous', run_name='__main__')\n"
    listed += "except SystemExit as end: print(end.code, sorted(heavy & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", listed], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("Usage: sinuous")
    assert done.stdout.endswith("0 []\n")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["solve"], "sinuous: Missing argument"),
        (["slove", "a.yaml"], "sinuous: No such command 'slove'."),
        (["solve", "--fast", "a.yaml"], "sinuous: No such option: --fast"),
        (["solve", "--time", "long", "a.yaml"], "sinuous: Invalid value for '--time'"),
        (["solve", "--time"], "sinuous: "),
        (["solve", "missing.yaml"], "missing.yaml: file: expected the name of a file that can be read"),
    ],
)
def test_a_wrong_call_is_one_line(capsys: pytest.CaptureFixture[str], arguments: list[str], said: str) -> None:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(said)
    assert captured.err.count("\n") == 1


def test_a_value_of_another_type_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "--seed", "1.5", "a.yaml"]) == 2
    assert re.fullmatch("sinuous: Invalid value for '--seed': .*'1.5'.*\n", capsys.readouterr().err)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--method", "magic"], "--method: expected one of newton"),
        (["--time", "nan"], "--time: expected a number of at least 0, got nan"),
        (["--time", "-1"], "--time: expected a number of at least 0, got -1"),
        (["--seed", "-1"], "--seed: expected a whole number from 0"),
        (["--out", "/nowhere/results.jsonl"], "--out: expected a file that can be written"),
        (["--plot", "/nowhere/picture.png"], "--plot: expected a file that can be written"),
        (["--plot", "picture.txt"], "--plot: expected a name that ends in"),
        (["--out", "easy.yaml"], "--out: expected another file"),
    ],
)
@pytest.mark.parametrize("command", ["solve", "track"])
def test_options_are_checked_before_anything_is_solved(
    capsys: pytest.CaptureFixture[str],
    problem: Write,
    command: str,
    options: list[str],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = problem("easy.yaml")
    monkeypatch.chdir(Path(file).parent)
    assert main([command, "easy.yaml", *options]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(said)
    assert captured.err.count("\n") == 1
    assert sorted(path.name for path in Path(file).parent.iterdir()) == ["easy.yaml"]


@pytest.mark.parametrize("json", [[], ["--json"]])
@pytest.mark.parametrize("command", ["solve", "track"])
def test_one_bad_file_stops_all(
    capsys: pytest.CaptureFixture[str], problem: Write, command: str, json: list[str]
) -> None:
    files = [problem("easy.yaml"), problem("bad.yaml")]
    assert main([command, *files, *json]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(f"{files[1]}: target.position: expected 3 finite numbers")
    assert captured.err.count("\n") == 1


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("sinuous wa", ["warm"]),
        ("sinuous solve --meth", ["--method"]),
        ("sinuous track --method fabrik_", ["fabrik_avoid"]),
        ("sinuous new p", ["pneumatic"]),
    ],
)
def test_the_shell_completes(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, typed: str, completed: list[str]
) -> None:
    monkeypatch.setenv("_SINUOUS_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    with contextlib.suppress(SystemExit):
        main([])
    assert capsys.readouterr().out.split() == completed


def test_a_disk_that_fills_up_is_no_traceback(
    capsys: pytest.CaptureFixture[str], problem: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sinuous.cli.answers.AnswerWriter.write", full)
    assert main(["solve", problem("easy.yaml")]) == 1
    assert capsys.readouterr().err.splitlines()[-1] == "sinuous: [Errno 28] No space left on device"
