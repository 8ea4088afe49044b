"""What a demanded clearance costs: a short run ends well, and what is demanded is kept."""

import pytest

from benchmarks.clutter.demanded import WAYS, examined, main


def test_a_place_is_solved_in_all_ways() -> None:
    rows = examined(("spheres 12", 0))
    assert [row.way for row in rows] == list(WAYS)
    assert all(row.solved for row in rows)
    assert rows[1].demanded > 0.0 == rows[0].demanded


def test_the_command_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--piece", "spheres 12", "--count", "1", "--alone"]) == 0
    assert "| all | demanded | 1/1 |" in capsys.readouterr().out
    assert main(["--count", "0"]) == 2
