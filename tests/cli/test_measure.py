"""The command bench."""

from pathlib import Path
from typing import Any

import pytest

from sinuous.cli.app import main


def test_options_reach_the_measurement(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    given: dict[str, Any] = {}

    def run(**options: Any) -> int:
        given.update(options)
        return 1

    monkeypatch.setattr("benchmarks.speed.run", run)
    out = tmp_path / "speed.json"
    assert main(["bench", "speed", "--json", "--quick", "--seed", "3", "--out", str(out)]) == 1
    assert given == {"json": True, "quick": True, "seed": 3, "out": out}


def test_families_reach_the_benchmark_of_places_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: dict[str, Any] = {}
    monkeypatch.setattr("benchmarks.clutter.run", lambda **options: given.update(options))
    assert main(["bench", "clutter", "--family", "p3", "--family", "drum scan"]) == 0
    assert given["families"] == ("p3", "drum scan")
    assert main(["bench", "speed", "--family", "p3"]) == 2
    assert "--family" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["table1", "tracking", "segments", "methods"])
def test_options_reach_the_experiments(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str) -> None:
    given: dict[str, Any] = {}

    def run(**options: Any) -> int:
        given.update(options)
        return 130

    monkeypatch.setattr(f"benchmarks.experiments.{name}.run", run)
    line = ["bench", name, "--quick", "--anew", "--out", str(tmp_path), "--method", "dls", "--method", "newton"]
    assert main(line) == 130
    assert given == {
        "json": False, "quick": True, "seed": 0, "out": tmp_path, "anew": True, "methods": ("dls", "newton"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["nothing"], "NAME: expected one of speed, clutter, table1"),
        (["speed", "--anew"], "(is not for speed)"),
        (["speed", "--method", "dls"], "(is not for speed)"),
        (["table1", "--seed", "-1"], "--seed"),
        (["table1", "--method", "magic"], "method: expected one of newton"),
    ],
)
def test_what_cannot_be_meant_is_said(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["bench", *arguments, "--out", str(tmp_path / "out")]) == 2
    assert complaint in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
