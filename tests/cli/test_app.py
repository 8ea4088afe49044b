"""What the shell is told: exit codes, one line on standard error, and quickly."""

import contextlib
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import sinuous
from sinuous.cli import app
from sinuous.cli.app import main
from tests.cli.conftest import Run


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


def test_a_disk_that_fills_up_is_no_traceback(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sinuous.cli.work.AnswerWriter.write", full)
    assert run("solve easy.yaml", 1).err.splitlines()[-1] == "sinuous: [Errno 28] No space left on device"
