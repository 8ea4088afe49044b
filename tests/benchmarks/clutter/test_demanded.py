"""What a demanded clearance costs: a short run ends well, and what is demanded is kept."""

import pytest

from benchmarks.clutter.demanded import AGAINST, examined, main


def test_a_place_is_solved_in_all_ways() -> None:
    rows = examined(("spheres 12", 0))
    assert [row.way for row in rows] == list(AGAINST)
    assert all(row.solved for row in rows)
    asked = {row.way: row.demanded for row in rows}
    assert asked["demanded"] == asked["thicker"] > asked["a trace demanded"] > 0.0 == asked["as ever"]


def test_the_command_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--piece", "spheres 12", "--count", "1", "--alone"]) == 0
    assert "| all | demanded | 1/1 |" in capsys.readouterr().out
    assert main(["--count", "0"]) == 2
