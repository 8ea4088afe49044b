"""What exploring brings to plans: a short run is planned, judged and printed."""

import pytest

from benchmarks.clutter.explored import main


def test_a_place_is_explored_and_planned_in(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--piece", "door out", "--count", "2", "--rounds", "1", "--alone"]) == 0
    told = capsys.readouterr().out
    assert "| door out | " in told
    assert "of 3 | 0 | " in told  # nothing wrong


@pytest.mark.parametrize("typed", [["--count", "1"], ["--piece", "hop"], ["--seed", "-1"], ["--rounds", "0"]])
def test_what_cannot_be_meant_is_refused_in_one_line(typed: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(typed) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
