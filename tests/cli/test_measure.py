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

    monkeypatch.setattr("sinuous.bench.speed.run", run)
    out = tmp_path / "speed.json"
    assert main(["bench", "speed", "--json", "--quick", "--seed", "3", "--out", str(out)]) == 1
    assert given == {"json": True, "quick": True, "seed": 3, "out": out}


def test_families_reach_the_benchmark_of_places_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: dict[str, Any] = {}
    monkeypatch.setattr("sinuous.bench.clutter.run", lambda **options: given.update(options))
    assert main(["bench", "clutter", "--family", "p3", "--family", "drum scan"]) == 0
    assert given["families"] == ("p3", "drum scan")
    assert main(["bench", "speed", "--family", "p3"]) == 2
    assert "--family" in capsys.readouterr().err
