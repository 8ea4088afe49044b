"""What the README shows works."""

import re
from pathlib import Path

import pytest

from sinuous.cli.app import main

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = blocks("python")
    exec(compile(example, "README.md", "exec"), {})
    assert "Solution: solved" in capsys.readouterr().out
    assert (tmp_path / "shape.png").stat().st_size > 0


def test_the_file_that_a_command_writes_is_solved(tmp_path: Path) -> None:
    file = str(tmp_path / "arm.yaml")
    assert "sinuous new tendon arm.yaml" in README
    assert main(["new", "tendon", file]) == 0
    assert main(["solve", file]) == 0


def test_every_file_that_it_names_is_there() -> None:
    named = re.findall(r"\]\(((?:docs|examples)[^)]*)\)|(examples/[\w.]+\.yaml)", README)
    assert len(named) > 5
    for pair in named:
        assert (ROOT / (pair[0] or pair[1])).exists()
